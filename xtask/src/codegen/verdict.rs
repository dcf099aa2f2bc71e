//! Which kernels are not as they should be.

use super::census::Census;
use super::kernel::{Instructions, Kernel};
use super::tolerated::{TOLERATED, Tolerated};

/// With AVX-512, vector operations for each register that is spilled, at the least.
///
/// A store and a load beside twenty operations wait for nobody: they take other ports.
const OPERATIONS_PER_SPILL: usize = 20;

/// A sentence for each kernel that has lost its vectors and is not known to, and the other way round.
pub(super) fn complaints(censuses: &[(Kernel, Census)]) -> Vec<String> {
    judged(censuses, &TOLERATED)
}

fn judged(censuses: &[(Kernel, Census)], tolerated: &[Tolerated]) -> Vec<String> {
    let mut complaints = Vec::new();
    for (kernel, census) in censuses {
        let known = tolerated.iter().any(|tolerated| tolerated.covers(kernel));
        let complaint = match complaint(kernel, census) {
            Some(complaint) if !known => complaint,
            None if known => "all vectors: take it off the list in tolerated.rs".to_owned(),
            _ => continue,
        };
        let Kernel { instructions, float, system, method, .. } = kernel;
        complaints.push(format!("{instructions} {float} {system} {method}: {complaint}"));
    }
    complaints
}

/// What is wrong with a kernel.
fn complaint(kernel: &Kernel, census: &Census) -> Option<String> {
    let Census { vector, scalar, narrow, calls, spills } = *census;
    let room = vector / OPERATIONS_PER_SPILL;
    let mut wrong = Vec::new();
    if vector == 0 {
        wrong.push("no vector operation in any loop".to_owned());
    }
    if scalar > 0 {
        wrong.push(format!("{scalar} operations on single numbers"));
    }
    if narrow > 0 {
        wrong.push(format!("{narrow} operations on vectors that are too narrow"));
    }
    if calls > 0 {
        wrong.push(format!("{calls} calls"));
    }
    if kernel.instructions == Instructions::Avx512 && spills > room {
        wrong.push(format!("{spills} spilled registers, where {room} go unnoticed"));
    }
    (!wrong.is_empty()).then(|| wrong.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::codegen::censuses;
    use crate::codegen::kernel::tests::SYMBOL;

    /// Complaints about the kernel of [`SYMBOL`] with this in its loop.
    fn complaints_about(body: &str, tolerated: &[Tolerated]) -> Vec<String> {
        let assembly = format!("{SYMBOL}:\n.L1:\n{body}\tdecq\t%rax\n\tjne\t.L1\n\tretq\n");
        judged(&censuses(&assembly), tolerated)
    }

    const VECTOR: &str = "\tvmulpd\t%zmm1, %zmm2, %zmm3\n";

    #[test]
    fn a_loop_of_vectors_passes() {
        assert_eq!(complaints_about(VECTOR, &[]), Vec::<String>::new());
    }

    #[test]
    fn lost_vectors_narrow_vectors_and_calls_do_not() {
        let (scalar, narrow) =
            ("\tvaddsd\t%xmm1, %xmm2, %xmm3\n", "\tvaddpd\t%ymm1, %ymm2, %ymm3\n");
        let cases = [
            ("\tmovq\t%rax, %rbx\n".to_owned(), "no vector operation in any loop"),
            (format!("{VECTOR}{scalar}"), "1 operations on single numbers"),
            (format!("{VECTOR}{narrow}"), "1 operations on vectors that are too narrow"),
            (format!("{VECTOR}\tcallq\tsin@PLT\n"), "1 calls"),
        ];
        for (body, complaint) in cases {
            let expected = format!("avx512 f64 oscillator yoshida4: {complaint}");
            assert_eq!(complaints_about(&body, &[]), [expected]);
        }
    }

    #[test]
    fn spills_pass_only_among_many_operations() {
        let spill = "\tvmovapd\t%zmm3, (%rsp)\n\tvaddpd\t(%rsp), %zmm3, %zmm4\n";
        let among = |operations: usize| {
            complaints_about(&format!("{}{spill}", VECTOR.repeat(operations - 1)), &[])
        };
        assert_eq!(among(OPERATIONS_PER_SPILL), Vec::<String>::new());
        assert_eq!(
            among(OPERATIONS_PER_SPILL - 1),
            ["avx512 f64 oscillator yoshida4: 1 spilled registers, where 0 go unnoticed"]
        );
    }

    #[test]
    fn what_is_tolerated_must_need_it() {
        let tolerated = || [Tolerated::new("oscillator", "yoshida4")];
        let scalar = "\tvaddsd\t%xmm1, %xmm2, %xmm3\n";
        assert_eq!(complaints_about(scalar, &tolerated()), Vec::<String>::new());
        assert_eq!(
            complaints_about(VECTOR, &tolerated()),
            ["avx512 f64 oscillator yoshida4: all vectors: take it off the list in tolerated.rs"]
        );
    }
}
