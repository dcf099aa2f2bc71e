//! Steps of all lanes of a block with run-time dispatch: the dispatch is outside the loop, and each loop is compiled once for each
//! integrator.

use libration_core::integrator::WithIntegrator;
use libration_core::system::CommandedSystem;
use libration_core::{Float, Integrator, State, System};

use super::block_size::LANES;
use crate::ensemble::Loop;
use crate::ensemble::instructions::{Baseline, Target};
use crate::ensemble::kernel::{at, put};

/// The state, commands and lengths of a step.
pub(super) struct Lanes<'a, T, const D: usize> {
    pub(super) q: &'a mut [[T; LANES]; D],
    pub(super) v: &'a mut [[T; LANES]; D],
    pub(super) held: &'a [[T; LANES]; D],
    /// The length of the step.
    pub(super) dt: &'a [T; LANES],
}

/// Lanes during the dispatch of the integrator.
struct Dispatch<'a, T, I, Sys, const D: usize> {
    lanes: Lanes<'a, T, D>,
    target: I,
    system: Sys,
}

impl<T: Float, const D: usize> Lanes<'_, T, D> {
    /// Advances each lane by one step.
    pub(super) fn step<I: Target, Sys: System<T, D> + Copy, M: Integrator>(
        self,
        target: I,
        system: Sys,
        method: M,
    ) {
        method.dispatch(Dispatch { lanes: self, target, system });
    }
}

impl<T, I, Sys, const D: usize> WithIntegrator for Dispatch<'_, T, I, Sys, D>
where
    T: Float,
    I: Target,
    Sys: System<T, D> + Copy,
{
    type Output = ();

    #[inline(always)]
    fn integrator<M: Integrator>(self, method: M) {
        let Dispatch { lanes, target, system } = self;
        let known = Known { lanes, system, method };
        match const { M::BASELINE_ONLY } {
            true => Baseline.vectorize(known),
            false => target.vectorize(known),
        }
    }
}

/// Lanes with their system and integrator.
struct Known<'a, T, Sys, M, const D: usize> {
    lanes: Lanes<'a, T, D>,
    system: Sys,
    method: M,
}

impl<T: Float, Sys: System<T, D> + Copy, M: Integrator, const D: usize> Loop
    for Known<'_, T, Sys, M, D>
{
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Known { lanes: Lanes { q, v, held, dt }, system, method } = self;
        // Of their own, or every store could change what is read.
        let (mut new_q, mut new_v, held, dt) = (*q, *v, *held, *dt);
        for (l, &dt) in dt.iter().enumerate() {
            let system = CommandedSystem { system, command: at(&held, l) };
            let state = State { q: at(&new_q, l), v: at(&new_v, l) };
            let state = method.step(&system, state, dt);
            put(&mut new_q, l, state.q);
            put(&mut new_v, l, state.v);
        }
        (*q, *v) = (new_q, new_v);
    }
}
