//! Instructions in hot loops, by kind.

use std::fmt::Write;

use super::instruction::{Arithmetic, Instruction};
use super::kernel::{Instructions, Kernel};

/// Instructions in the hot loops of a kernel, by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Census {
    /// Arithmetic on registers of full width.
    pub(super) vector: usize,
    /// Arithmetic on one number.
    pub(super) scalar: usize,
    /// Anything else on vectors that are narrower than they could be, as numbers are that are taken out
    /// of a wide one.
    pub(super) narrow: usize,
    /// Calls of other functions.
    pub(super) calls: usize,
    /// Registers that are stored and loaded again.
    pub(super) spills: usize,
}

impl Census {
    /// Counts, where `register` is the letter of the widest registers. Where the loops also `move` blocks
    /// in and out, only arithmetic can be narrow.
    pub(super) fn of(loops: &[&[Instruction<'_>]], register: char, moves: bool) -> Census {
        let mut census = Census::default();
        for body in loops {
            for instruction in *body {
                let full = instruction.register().is_none_or(|r| r == register);
                match instruction.arithmetic() {
                    Some(Arithmetic::Scalar) => census.scalar += 1,
                    Some(Arithmetic::Packed) if full => census.vector += 1,
                    arithmetic if !full && (arithmetic.is_some() || !moves) => census.narrow += 1,
                    _ => {}
                }
                census.calls += usize::from(instruction.is_call());
                let returns = |place| body.iter().any(|other| other.reloads() == Some(place));
                census.spills += usize::from(instruction.spills_to().is_some_and(returns));
            }
        }
        census
    }
}

/// A line for every kernel.
pub(super) fn table(censuses: &[(Kernel, Census)]) -> String {
    let mut table = format!(
        "{:<8}{:<6}{:<20}{:<30}{:<9}{:>5}{:>8}{:>8}{:>8}{:>7}{:>8}\n",
        "",
        "",
        "system",
        "method",
        "kernel",
        "width",
        "vector",
        "scalar",
        "narrow",
        "calls",
        "spills"
    );
    for (kernel, census) in censuses {
        let Kernel { instructions, float, system, method, width, .. } = kernel;
        let kind = kernel.kind();
        let Census { vector, scalar, narrow, calls, spills } = census;
        // With 16 registers blocks live in memory, which tells nothing.
        let spills = match instructions {
            Instructions::Avx512 => spills.to_string(),
            Instructions::Avx2 => "-".to_owned(),
        };
        // Writing to a string cannot fail.
        let _ = writeln!(
            table,
            "{instructions:<8}{float:<6}{system:<20}{method:<30}{kind:<9}{width:>5}{vector:>8}{scalar:>8}\
             {narrow:>8}{calls:>7}{spills:>8}"
        );
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::codegen::{function, hot};

    /// Of a loop with this body, with the registers of AVX-512.
    fn census(body: &str) -> Census {
        let assembly = format!("_RNvkernel:\n.L1:\n{body}\tdecq\t%rax\n\tjne\t.L1\n\tretq\n");
        Census::of(&hot::loops(&function::read(&assembly)[0]), 'z', false)
    }

    #[test]
    fn vectors_of_full_width_are_counted() {
        let body = "\tvmulpd\t%zmm1, %zmm2, %zmm3\n\tvaddpd\t%zmm3, %zmm2, %zmm3\n";
        assert_eq!(census(body), Census { vector: 2, ..Census::default() });
    }

    #[test]
    fn numbers_one_at_a_time_are_counted() {
        let body = "\tvmulsd\t%xmm1, %xmm2, %xmm3\n";
        assert_eq!(census(body), Census { scalar: 1, ..Census::default() });
    }

    #[test]
    fn narrow_vectors_are_counted() {
        let body = "\tvmulpd\t%ymm1, %ymm2, %ymm3\n\tvpextrq\t$1, %xmm3, %rcx\n";
        assert_eq!(census(body), Census { narrow: 2, ..Census::default() });
    }

    #[test]
    fn calls_are_counted() {
        let body = "\tvmulpd\t%zmm1, %zmm2, %zmm3\n\tcallq\t*sin@GOTPCREL(%rip)\n";
        assert_eq!(census(body), Census { vector: 1, calls: 1, ..Census::default() });
    }

    #[test]
    fn spills_are_counted_but_neither_planes_nor_constants() {
        let plane = "\tvmovapd\t%zmm3, 128(%rsp,%rcx,8)\n";
        let constant = "\tvmulpd\t64(%rsp){1to8}, %zmm2, %zmm3\n";
        let spilled = "\tvmovapd\t%zmm3, (%rsp)\n";
        let reloaded = "\tvaddpd\t(%rsp), %zmm3, %zmm4\n";
        let unspilled = census(&format!("{constant}{plane}"));
        assert_eq!(unspilled, Census { vector: 1, ..Census::default() });
        let both = census(&format!("{constant}{plane}{spilled}{reloaded}"));
        assert_eq!(both, Census { vector: 2, spills: 1, ..Census::default() });
    }

    #[test]
    fn the_table_has_a_line_for_every_kernel() {
        let kernel = Kernel::of(crate::codegen::kernel::tests::SYMBOL).unwrap();
        let table = table(&[(kernel, Census { vector: 168, ..Census::default() })]);
        let line = table.lines().nth(1).unwrap();
        let cells: Vec<&str> = line.split_whitespace().collect();
        assert_eq!(
            cells,
            ["avx512", "f64", "oscillator", "yoshida4", "advance", "64", "168", "0", "0", "0", "0"]
        );
    }
}
