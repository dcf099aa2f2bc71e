//! A restored state continues with the same bits.

#![allow(clippy::unwrap_used)]

mod environments;
mod programs;
mod trajectories;

use libration::checkpoint::{Checkpoint, ensure_same_traits};
use libration::ensemble::Execution;

/// What is said of a state that is of something else.
fn refused(state: &impl Checkpoint, wanted: &impl Checkpoint) -> String {
    let found = state.traits();
    let found: Vec<_> = found.iter().map(|(name, value)| (*name, value.as_str())).collect();
    ensure_same_traits(found, &wanted.traits()).unwrap_err().to_string()
}

/// Alone and with more threads than a small machine has cores, on one instruction set: other tests compare these, and a kernel is compiled for each.
fn executions() -> [Execution; 2] {
    [1, 3].map(|threads| Execution::serial().threads(threads).unwrap().worth(1))
}
