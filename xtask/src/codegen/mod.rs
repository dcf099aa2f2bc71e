//! `cargo xtask codegen`: checks that the batch kernels are vectorised.
//!
//! The vectors of an ensemble are the compiler's doing, and nothing complains when it stops: the bits
//! stay the same and the speed falls by ten. So the engine is compiled to assembly, and the loops of
//! every kernel are read.

mod assembly;
mod catalogue;
mod census;
mod expected;
mod function;
mod hot;
mod instruction;
mod kernel;
mod seal;
mod verdict;

use std::fs;

use crate::Outcome;
use census::Census;
use kernel::Kernel;

/// Prints what is in the kernels, or what is wrong with them; keeps that this engine was read.
pub(crate) fn run() -> Outcome {
    print!("{}", read()?);
    seal::keep()
}

/// The same, unless this engine was read before.
pub(crate) fn unless_read() -> Outcome {
    if seal::is_whole() {
        println!(
            "the engine is the one that was read last: see crates/libration/benches/codegen.txt"
        );
        return Ok(());
    }
    print!("{}", read()?);
    println!(
        "`cargo xtask codegen` keeps that this engine was read, so that the next run need not"
    );
    Ok(())
}

/// Compiles the engine to assembly and fails if a kernel lost its vectors, or is not there; else a table.
fn read() -> Result<String, String> {
    if !cfg!(target_arch = "x86_64") {
        return Ok("skipped: the kernels for AVX2 and AVX-512 are compiled on x86-64 only\n".into());
    }
    let path = assembly::build()?;
    let text = fs::read_to_string(&path)
        .map_err(|error| format!("{} cannot be read: {error}", path.display()))?;
    let censuses = censuses(&text);
    let table = format!("{}{} kernels\n", census::table(&censuses), censuses.len());
    let mut complaints = expected::complaints(&censuses);
    complaints.extend(verdict::complaints(&censuses));
    if complaints.is_empty() {
        return Ok(table);
    }
    Err(format!("{table}{}\n{ADVICE}", complaints.join("\n")))
}

const ADVICE: &str = "\
These are instructions in the loops that take the steps: on single numbers (scalar), on registers that
are narrower than the widest (narrow), calls, and registers stored and loaded again (spills). A lane
loop becomes vectors only if the whole step is inlined into it and has no loop of its own: put
`#[inline(always)]` on what the step calls, call no function of the platform, branch on no data, and
write out what repeats, as crates/libration-core/src/integrator/composition.rs does. Where registers are
spilled, the block is too wide: see `width` in crates/libration-batch/src/ensemble/run.rs, and measure.";

/// Returns the instructions of the kernels of an assembly, by name.
fn censuses(assembly: &str) -> Vec<(Kernel, Census)> {
    let mut found: Vec<(Kernel, Census)> = function::read(assembly)
        .iter()
        .filter_map(|function| {
            let kernel = Kernel::of(function.symbol)?;
            // A lone leftover is stepped as the scalar that it is.
            (kernel.width > 1).then(|| {
                let vector = kernel.instructions.register();
                let moves = kernel.pass;
                (kernel, Census::of(&hot::loops(function), vector, moves))
            })
        })
        .collect();
    found.sort_by(|(a, _), (b, _)| a.cmp(b));
    found
}
