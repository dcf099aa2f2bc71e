//! A restored state continues with the same bits.

#![allow(clippy::unwrap_used)]

mod environments;
mod programs;
mod trajectories;

use libration::checkpoint::{Checkpoint, ensure_same_traits};
use libration::ensemble::{Execution, InstructionSet};

/// What is said of a state that is of something else.
fn refused(state: &impl Checkpoint, wanted: &impl Checkpoint) -> String {
    let found = state.traits();
    let found: Vec<_> = found.iter().map(|(name, value)| (*name, value.as_str())).collect();
    ensure_same_traits(found, &wanted.traits()).unwrap_err().to_string()
}

/// On every instruction set, alone and with more threads than a small machine has cores.
fn executions() -> Vec<Execution> {
    let sets = InstructionSet::available().flat_map(|set| [1, 3].map(|threads| (set, threads)));
    sets.map(|(set, threads)| {
        let execution = Execution::serial().threads(threads).unwrap().worth(1);
        execution.instructions(set).unwrap()
    })
    .collect()
}
