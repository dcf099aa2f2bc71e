//! Physical systems `q̈ = a(q, v)`, each written once for every number type.

mod baseline_only;
mod commanded_system;
mod damped_oscillator;
mod driven_oscillator;
mod duffing;
mod dyn_system;
mod henon_heiles;
mod implicit_system;
mod kepler;
mod mixed_precision;
mod oscillator;
mod pendulum;

use crate::{Elementary, Scalar, State};

pub use baseline_only::BaselineOnly;
pub use commanded_system::CommandedSystem;
pub use damped_oscillator::DampedOscillator;
pub use driven_oscillator::DrivenOscillator;
pub use duffing::Duffing;
pub use dyn_system::DynSystem;
pub use henon_heiles::HenonHeiles;
pub use implicit_system::{
    Differentiated, ImplicitSystem, StageCoefficients, solve_motion, solve_stage_motion,
};
pub use kepler::Kepler;
pub use mixed_precision::MixedPrecision;
pub use oscillator::Oscillator;
pub use pendulum::Pendulum;

/// A mechanical system with `D` degrees of freedom and equation of motion `q̈ = a(q, v)`.
///
/// Time, where a system needs it, is a coordinate with velocity 1 and acceleration 0.
pub trait System<S: Scalar, const D: usize> {
    /// Whether the acceleration depends on the positions alone.
    ///
    /// An `Ensemble` then hands it from the end of a Verlet step to the next.
    const POSITIONAL: bool = false;

    /// Vector registers that an evaluation of the force fills besides the state, with its constants and
    /// with what lies between.
    ///
    /// An `Ensemble` makes its blocks narrower by them, and is fastest where this is
    /// about right; its results do not depend on it.
    const REGISTERS: usize = 16;

    /// Whether batches are compiled for the baseline of the architecture alone, in place of once for each instruction set:
    /// the same bits. See [`BaselineOnly`].
    const BASELINE_ONLY: bool = false;

    /// The acceleration `a(q, v)`.
    fn acceleration(&self, state: &State<S, D>) -> [S; D];

    /// The rate of change of the state, `(q̇, v̇) = (v, a(q, v))`.
    #[inline(always)]
    fn rate(&self, state: State<S, D>) -> State<S, D> {
        State { q: state.v, v: self.acceleration(&state) }
    }
}

/// A system with an energy, conserved or not.
pub trait Hamiltonian<S: Scalar, const D: usize>: System<S, D> {
    /// Kinetic plus potential energy per unit mass.
    fn energy(&self, state: &State<S, D>) -> S;
}

/// A system given by `f64` parameters that can be put on any number type.
///
/// It is what a laboratory holds: one description, from which it makes the system of floats that
/// it simulates, the system of dual numbers that it differentiates, and so on.
pub trait Model<const D: usize>: Copy + Send + Sync {
    /// The system on numbers of type `S`.
    type On<S: Elementary>: Hamiltonian<S, D> + Copy;

    /// Whether the acceleration is linear in `(q, v)`, so that one step is a constant matrix.
    const LINEAR: bool;

    /// The system on numbers of type `S`, its parameters rounded to `S`.
    fn on<S: Elementary>(&self) -> Self::On<S>;
}

/// `½ |v|²`, the kinetic energy per unit mass.
#[inline(always)]
pub fn kinetic<S: Scalar>(v: &[S]) -> S {
    v.iter().fold(S::zero(), |sum, &v| sum + v * v).ratio(1, 2)
}
