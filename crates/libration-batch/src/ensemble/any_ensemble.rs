//! Ensembles of systems that are chosen at run time.

use core::fmt::Debug;

use libration_core::{ImplicitMethod, Method};

use super::{EnsembleError, Execution};

/// An ensemble of a system in some number of dimensions.
///
/// Behind it are the kernels of the oscillator, compiled once, and the block machine for all other systems.
pub trait AnyEnsemble<T>: Debug + Send {
    /// Number of trajectories.
    fn len(&self) -> usize;

    /// Whether there are none.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Degrees of freedom.
    fn dimension(&self) -> usize;

    /// Number of steps taken.
    fn step(&self) -> u64;

    /// Takes `steps` steps of `dt` seconds with every trajectory.
    fn advance(&mut self, method: Method, dt: T, steps: u64);

    /// The same of an implicit method, whose program is made when it is used first.
    ///
    /// # Errors
    /// [`EnsembleError::Implicit`] if the ensemble has compiled kernels: that of [`program_ensemble`](super::BatchFloat::program_ensemble) has
    /// none.
    fn advance_implicit(
        &mut self,
        method: ImplicitMethod,
        dt: T,
        steps: u64,
    ) -> Result<(), EnsembleError>;

    /// Runs the next steps on other threads or with other instructions, which changes no result.
    fn execute(&mut self, execution: Execution);

    /// Position `i` of every trajectory, if there is one.
    fn q(&self, i: usize) -> Option<&[T]>;

    /// Velocity `i` of every trajectory, if there is one.
    fn v(&self, i: usize) -> Option<&[T]>;

    /// The energy of every trajectory, of a system of the catalogue per unit mass, in J/kg; none if the system has none.
    fn energies(&self) -> Option<Vec<T>>;

    /// The trajectories with a coordinate that is infinite or not a number, in order.
    fn not_finite(&self) -> Vec<usize>;
}
