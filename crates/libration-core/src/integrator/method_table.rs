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

/// Tables are equal if their names are, which are unique, and sorted by order.
macro_rules! compared_by_name {
    ($table:ident) => {
        impl core::fmt::Debug for $table {
            fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
                f.write_str(self.name)
            }
        }

        impl PartialEq for $table {
            fn eq(&self, other: &Self) -> bool {
                self.name == other.name
            }
        }

        impl Eq for $table {}

        impl core::hash::Hash for $table {
            fn hash<H: core::hash::Hasher>(&self, state: &mut H) {
                self.name.hash(state);
            }
        }

        impl PartialOrd for $table {
            fn partial_cmp(&self, other: &Self) -> Option<core::cmp::Ordering> {
                Some(self.cmp(other))
            }
        }

        impl Ord for $table {
            fn cmp(&self, other: &Self) -> core::cmp::Ordering {
                self.order.cmp(&other.order).then(self.name.cmp(other.name))
            }
        }
    };
}

pub(super) use compared_by_name;
