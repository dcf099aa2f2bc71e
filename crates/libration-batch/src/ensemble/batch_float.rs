//! Float types of ensembles, which make them of systems that are chosen at run time.

use bytemuck::Pod;
use libration_core::{AnyMethod, AnySystem, ImplicitMethod, Method, with_system};
use libration_equations::{Dynamics, Program};

use super::any_ensemble::AnyEnsemble;
use super::isotropic::Isotropic;
use super::{EnsembleError, Execution, InstructionSet, ProgramEnsemble, iterated_program};
use crate::machine::MachineFloat;

/// A float type of ensembles: `f32` and `f64`.
pub trait BatchFloat: MachineFloat + Pod {
    /// Bytes that `len` trajectories in `dimension` degrees of freedom take.
    fn ensemble_bytes(dimension: usize, len: usize) -> u128 {
        ProgramEnsemble::<Self>::bytes(dimension, len)
    }

    /// `len` trajectories of `system`; the start of trajectory `n` is what `start(n, i)` says of its
    /// coordinates `q₀ … q_{D−1}, v₀ … v_{D−1}`.
    ///
    /// # Errors
    /// [`EnsembleError::System`] if the system does not exist in that dimension;
    /// [`EnsembleError::Memory`].
    fn ensemble(
        system: AnySystem,
        dimension: usize,
        len: usize,
        execution: Execution,
        start: &(dyn Fn(usize, usize) -> Self + Sync),
    ) -> Result<Box<dyn AnyEnsemble<Self>>, EnsembleError>;

    /// `len` trajectories of a system by its program, whose inputs are zero.
    ///
    /// # Errors
    /// [`EnsembleError::Memory`].
    fn program_ensemble(
        dynamics: &Dynamics,
        len: usize,
        execution: Execution,
        start: &(dyn Fn(usize, usize) -> Self + Sync),
    ) -> Result<Box<dyn AnyEnsemble<Self>>, EnsembleError>;

    /// The same in steps of `method`, by compiled kernels of `twin` where they are faster: `twin` has the same bits.
    ///
    /// # Errors
    /// [`EnsembleError::System`] if the twin does not exist in that dimension; [`EnsembleError::Memory`].
    fn ensemble_for(
        method: AnyMethod,
        dynamics: &Dynamics,
        twin: Option<AnySystem>,
        len: usize,
        execution: Execution,
        start: &(dyn Fn(usize, usize) -> Self + Sync),
    ) -> Result<Box<dyn AnyEnsemble<Self>>, EnsembleError> {
        // Kernels of tables loop over coefficients, which takes 20 times as long as a program.
        let is_table = |method| matches!(method, Method::Splitting(_) | Method::RungeKutta(_));
        match (twin, method) {
            (Some(system @ AnySystem::Oscillator(_)), AnyMethod::Explicit(method))
                if !is_table(method) =>
            {
                Self::ensemble(system, dynamics.degrees(), len, execution, start)
            }
            _ => Self::program_ensemble(dynamics, len, execution, start),
        }
    }

    /// Runs a program `times` times on its own results, in each lane alike: row `i` has input `i` of every lane, and output `i`
    /// in the end. Rows have equal lengths, and the program has an output for each of them.
    fn iterate(program: &Program, rows: &mut [Vec<Self>], times: u64, set: InstructionSet);
}

// Functions of this crate, which compiles the machine once: provided methods would be compiled by each that calls them.
macro_rules! batch_float {
    ($float:ident) => {
        impl BatchFloat for $float {
            fn ensemble(
                system: AnySystem,
                dimension: usize,
                len: usize,
                execution: Execution,
                start: &(dyn Fn(usize, usize) -> Self + Sync),
            ) -> Result<Box<dyn AnyEnsemble<Self>>, EnsembleError> {
                if !system.entry().dimensions.contains(&dimension) {
                    return Err(EnsembleError::System(system.entry().wrong_dimension(dimension)));
                }
                if let AnySystem::Oscillator(model) = system {
                    return Ok(Box::new(Isotropic::<$float>::new(
                        model, dimension, len, execution, start,
                    )?));
                }
                let Some(dynamics) = dynamics_of(system, dimension) else {
                    return Err(EnsembleError::System(system.entry().wrong_dimension(dimension)));
                };
                Self::program_ensemble(&dynamics, len, execution, start)
            }

            fn program_ensemble(
                dynamics: &Dynamics,
                len: usize,
                execution: Execution,
                start: &(dyn Fn(usize, usize) -> Self + Sync),
            ) -> Result<Box<dyn AnyEnsemble<Self>>, EnsembleError> {
                let dynamics = dynamics.clone();
                Ok(Box::new(ProgramEnsemble::<$float>::new(dynamics, len, execution, start)?))
            }

            fn iterate(program: &Program, rows: &mut [Vec<Self>], times: u64, set: InstructionSet) {
                iterated_program::iterate(program, rows, times, set);
            }
        }
    };
}

batch_float!(f32);
batch_float!(f64);

/// The programs of a system of the catalogue; none if it does not exist in that dimension.
pub fn dynamics_of(system: AnySystem, dimension: usize) -> Option<Dynamics> {
    with_system!(system, dimension, |model, D| Some(Dynamics::of::<D>(&model, None)), None)
}

impl<T: BatchFloat> AnyEnsemble<T> for ProgramEnsemble<T> {
    fn len(&self) -> usize {
        self.len()
    }

    fn dimension(&self) -> usize {
        self.degrees()
    }

    fn step(&self) -> u64 {
        self.step()
    }

    fn advance(&mut self, method: Method, dt: T, steps: u64) {
        self.advance(method.into(), dt, steps);
    }

    fn advance_implicit(
        &mut self,
        method: ImplicitMethod,
        dt: T,
        steps: u64,
    ) -> Result<(), EnsembleError> {
        self.advance(method.into(), dt, steps);
        Ok(())
    }

    fn execute(&mut self, execution: Execution) {
        self.execute(execution);
    }

    fn q(&self, i: usize) -> Option<&[T]> {
        (i < self.degrees()).then(|| self.coordinate(i)).flatten()
    }

    fn v(&self, i: usize) -> Option<&[T]> {
        self.coordinate(self.degrees().checked_add(i)?)
    }

    fn energies(&self) -> Option<Vec<T>> {
        self.energies()
    }

    fn not_finite(&self) -> Vec<usize> {
        self.not_finite().collect()
    }
}
