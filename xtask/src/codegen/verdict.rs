//! Kernels that are not fully vectorised.

use super::census::Census;
use super::kernel::{Instructions, Kernel};

/// With AVX-512, vector operations for each register that is spilled, at the least.
///
/// Stores and loads run beside arithmetic: so few cost less than narrower blocks without them. The
/// pendulum under velocity Verlet in `f64` spills 15 beside 224, and is 1.6 times as fast as in blocks half
/// as wide.
const OPERATIONS_PER_SPILL: usize = 14;

/// Returns a message for each kernel that is not fully vectorised.
pub(super) fn complaints(censuses: &[(Kernel, Census)]) -> Vec<String> {
    let sentence = |(kernel, census): &(Kernel, Census)| {
        let Kernel { instructions, float, system, method, .. } = kernel;
        let kind = kernel.kind();
        let complaint = complaint(kernel, census)?;
        Some(format!("{instructions} {float} {system} {method} ({kind}): {complaint}"))
    };
    censuses.iter().filter_map(sentence).collect()
}

/// Returns the defects of a kernel.
fn complaint(kernel: &Kernel, census: &Census) -> Option<String> {
    let Census { vector, scalar, narrow, calls, spills } = *census;
    let room = vector / OPERATIONS_PER_SPILL;
    let mut wrong = Vec::new();
    if vector == 0 {
        wrong.push("no vectors".to_owned());
    }
    if scalar > 0 {
        wrong.push(format!("scalar {scalar}"));
    }
    if narrow > 0 {
        wrong.push(format!("narrow {narrow}"));
    }
    if calls > 0 {
        wrong.push(format!("calls {calls}"));
    }
    // A pass goes through the memory whatever it does.
    if kernel.instructions == Instructions::Avx512 && !kernel.pass && spills > room {
        wrong.push(format!("spills {spills}, at most {room} among {vector}"));
    }
    (!wrong.is_empty()).then(|| wrong.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::codegen::censuses;
    use crate::codegen::kernel::tests::SYMBOL;

    /// Complaints about the kernel of [`SYMBOL`] with this in its loop.
    fn complaints_about(body: &str) -> Vec<String> {
        let assembly = format!("{SYMBOL}:\n.L1:\n{body}\tdecq\t%rax\n\tjne\t.L1\n\tretq\n");
        complaints(&censuses(&assembly))
    }

    const VECTOR: &str = "\tvmulpd\t%zmm1, %zmm2, %zmm3\n";

    #[test]
    fn a_loop_of_vectors_passes() {
        assert_eq!(complaints_about(VECTOR), Vec::<String>::new());
    }

    #[test]
    fn lost_vectors_narrow_vectors_and_calls_do_not() {
        let (scalar, narrow) =
            ("\tvaddsd\t%xmm1, %xmm2, %xmm3\n", "\tvaddpd\t%ymm1, %ymm2, %ymm3\n");
        let cases = [
            ("\tmovq\t%rax, %rbx\n".to_owned(), "no vectors"),
            (format!("{VECTOR}{scalar}"), "scalar 1"),
            (format!("{VECTOR}{narrow}"), "narrow 1"),
            (format!("{VECTOR}\tcallq\tsin@PLT\n"), "calls 1"),
        ];
        for (body, complaint) in cases {
            let expected = format!("avx512 f64 oscillator yoshida4 (advance): {complaint}");
            assert_eq!(complaints_about(&body), [expected]);
        }
    }

    #[test]
    fn spills_pass_only_among_many_operations() {
        let spill = "\tvmovapd\t%zmm3, (%rsp)\n\tvaddpd\t(%rsp), %zmm3, %zmm4\n";
        let among = |operations: usize| {
            complaints_about(&format!("{}{spill}", VECTOR.repeat(operations - 1)))
        };
        assert_eq!(among(OPERATIONS_PER_SPILL), Vec::<String>::new());
        assert_eq!(
            among(OPERATIONS_PER_SPILL - 1),
            ["avx512 f64 oscillator yoshida4 (advance): spills 1, at most 0 among 13"]
        );
    }
}
