//! Fixed-step integrators, each defined exactly once.
//!
//! A splitting method is a word in two letters, *kick* (`v += h·a`) and *drift* (`q += h·v`); a
//! Runge–Kutta method is a sum of rates. Nothing here knows whether a number is one particle, a
//! derivative or a polynomial.

mod composition;
mod dispatch;
mod euler;
mod exact;
mod implicit;
mod leapfrog;
mod method_table;
mod runge_kutta;
mod runge_kutta_table;
mod runge_kutta_tables;
mod splitting;
mod splitting_table;
mod splitting_tables;
mod substeps;
mod table_comparison;
mod textbook_verlet;
mod velocity_verlet;

use crate::{Scalar, State, System};

pub use composition::{Composition, SUZUKI4, Suzuki4, YOSHIDA4, Yoshida4};
pub use euler::{ExplicitEuler, SymplecticEuler, SymplecticEulerDriftFirst};
pub use exact::Exact;
pub use implicit::{
    BackwardEuler, DampingImplicit, DampingStiffnessImplicit, GaussLegendre4, GaussLegendre6,
    ImplicitIntegrator, ImplicitMidpoint, Iterated, NEWTON_STEPS, StablePd, Trapezoid,
};
pub use leapfrog::Leapfrog;
pub use method_table::MethodTable;
pub use runge_kutta::Rk4;
pub use runge_kutta_table::{RungeKuttaCoefficients, RungeKuttaTable};
pub use splitting::Splitting;
pub use splitting_table::{SplittingCoefficients, SplittingScope, SplittingTable};
pub use substeps::Substeps;
pub use textbook_verlet::TextbookVerlet;
pub use velocity_verlet::VelocityVerlet;

/// A one-step method `(q, v) ↦ (q', v')`.
///
/// A step never fails, allocates, branches on data or reads a clock.
pub trait Integrator: Copy + Send + Sync {
    /// Whether a step ends with the force evaluation with which the next begins, so that
    /// [`Integrator::carried`] saves one.
    const CARRIES: bool = false;

    /// Vector registers that a step fills besides those of the state and of a force: an
    /// `Ensemble` makes its blocks narrower by them, and gives the same results.
    const REGISTERS: usize = 4;

    /// Whether the integrator dispatches over several methods at run time.
    const DISPATCHES: bool = false;

    /// Whether batches are compiled for the baseline instruction set alone.
    const BASELINE_ONLY: bool = false;

    /// Force evaluations of a step, of which one that [carries](Integrator::CARRIES) takes the first from the step before.
    fn evaluations(&self) -> usize {
        1
    }

    /// Calls `with` with the concrete integrator, so that a loop is compiled for it alone.
    #[inline(always)]
    fn dispatch<W: WithIntegrator>(self, with: W) -> W::Output {
        with.integrator(self)
    }

    /// Advances `state` by one step of length `dt`.
    fn step<S: Scalar, const D: usize>(
        self,
        system: &impl System<S, D>,
        state: State<S, D>,
        dt: S,
    ) -> State<S, D>;

    /// [`Integrator::step`] in less code: the same bits, and a little more time.
    #[inline(always)]
    fn compact_step<S: Scalar, const D: usize>(
        self,
        system: &impl System<S, D>,
        state: State<S, D>,
        dt: S,
    ) -> State<S, D> {
        self.step(system, state, dt)
    }

    /// [`Integrator::step`] from a state whose acceleration is known, to a state and its
    /// acceleration: the same bits.
    ///
    /// Where the method [carries](Integrator::CARRIES), the system must be
    /// [positional](System::POSITIONAL): the acceleration that is handed on was evaluated before
    /// the last kick.
    #[inline(always)]
    fn carried<S: Scalar, const D: usize>(
        self,
        system: &impl System<S, D>,
        state: State<S, D>,
        _acceleration: [S; D],
        dt: S,
    ) -> (State<S, D>, [S; D]) {
        let state = self.step(system, state, dt);
        (state, system.acceleration(&state))
    }
}

/// A function of an integrator of any type.
pub trait WithIntegrator {
    /// The result.
    type Output;

    /// Calls the function.
    fn integrator<M: Integrator>(self, integrator: M) -> Self::Output;
}
