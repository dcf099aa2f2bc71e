//! Steps of trajectories that threads divide among themselves.

use core::marker::PhantomData;
use core::ops::Range;

use libration_core::{Float, Integrator, System};

use super::planes::Share;
use super::run::Run;
use super::{Assign, Execution, GRAIN, MOVED, NoObserver, shares};

/// Takes the steps of a range with all trajectories of a share, divided among threads.
pub(super) fn advance_share<
    T: Float,
    M: Integrator,
    Sys: System<T, D> + Copy + Send + Sync,
    const D: usize,
>(
    share: Share<'_, T, D>,
    execution: &Execution,
    method: M,
    systems: impl Assign<Sys>,
    dt: impl Assign<T>,
    range: &Range<u64>,
) {
    let count = threads_for::<T, M, Sys, D>(execution, share.len(), range.end - range.start);
    execution.each(shares(share, count, GRAIN), |share| {
        let steps = range.clone();
        let system = PhantomData::<(T, Sys)>;
        let watch = None::<(u64, &mut NoObserver)>;
        let run = Run { share, method, systems, dt, steps, watch, system };
        execution.instruction_set().run(run);
    });
}

/// The number of threads for so many steps of `M` on `Sys` with `len` trajectories.
pub(super) fn threads_for<T: Float, M: Integrator, Sys: System<T, D>, const D: usize>(
    execution: &Execution,
    len: usize,
    steps: u64,
) -> usize {
    // What holds more values does more with them: symplectic Euler on an oscillator counts as one,
    // RK4 on a pendulum as 32 (it takes 60 times as long).
    let weight = const { (M::REGISTERS.div_ceil(4) * Sys::REGISTERS.div_ceil(2)) as u64 };
    let each = steps.saturating_mul(weight.max(1)).saturating_add(MOVED * D as u64);
    execution.threads_for((len as u64).saturating_mul(each))
}
