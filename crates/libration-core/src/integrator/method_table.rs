//! Tables of coefficients as integrators of one type.

use super::{Integrator, RungeKuttaTable, SplittingTable};
use crate::{Scalar, State, System};

/// A table of any kind: kernels are compiled for all of them at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MethodTable {
    /// A splitting method.
    Splitting(&'static SplittingTable),
    /// A Runge–Kutta method.
    RungeKutta(&'static RungeKuttaTable),
}

impl Integrator for MethodTable {
    const REGISTERS: usize = 10;

    const BASELINE_ONLY: bool = true;

    fn evaluations(&self) -> usize {
        match self {
            MethodTable::Splitting(table) => table.evaluations(),
            MethodTable::RungeKutta(table) => table.evaluations(),
        }
    }

    #[inline]
    fn step<S: Scalar, const D: usize>(
        self,
        system: &impl System<S, D>,
        state: State<S, D>,
        dt: S,
    ) -> State<S, D> {
        match self {
            MethodTable::Splitting(table) => table.step(system, state, dt),
            MethodTable::RungeKutta(table) => table.step(system, state, dt),
        }
    }
}
