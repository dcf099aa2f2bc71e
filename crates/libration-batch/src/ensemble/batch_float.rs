//! Float types of ensembles of systems that are chosen at run time.

use bytemuck::Pod;
use libration_core::AnyMethod;
use libration_equations::Program;

use super::any_ensemble::AnyEnsemble;
use super::{InstructionSet, iterated_program};
use crate::machine::MachineFloat;

/// A float type of ensembles: `f32` and `f64`.
pub trait BatchFloat: MachineFloat + Pod {
    /// [`AnyEnsemble::advance`].
    fn advance(all: &mut AnyEnsemble<Self>, method: AnyMethod, dt: Self, steps: u64);

    /// [`AnyEnsemble::energies`].
    fn energies(all: &AnyEnsemble<Self>) -> Option<Vec<Self>>;

    /// Runs a program `times` times on its own results, in each lane alike: row `i` has input `i` of every lane, and output `i`
    /// in the end. Rows have equal lengths, and the program has an output for each of them.
    fn iterate(program: &Program, rows: &mut [Vec<Self>], times: u64, set: InstructionSet);
}

// Functions of this crate, which compiles kernels and the machine once: generic ones would be compiled by each crate that calls them.
macro_rules! batch_float {
    ($float:ident) => {
        impl BatchFloat for $float {
            fn advance(all: &mut AnyEnsemble<Self>, method: AnyMethod, dt: Self, steps: u64) {
                all.take_steps(method, dt, steps);
            }

            fn energies(all: &AnyEnsemble<Self>) -> Option<Vec<Self>> {
                all.evaluate_energies()
            }

            fn iterate(program: &Program, rows: &mut [Vec<Self>], times: u64, set: InstructionSet) {
                iterated_program::iterate(program, rows, times, set);
            }
        }
    };
}

batch_float!(f32);
batch_float!(f64);
