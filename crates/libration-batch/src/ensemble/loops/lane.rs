//! One step of one lane.

use libration_core::control::{Clock, Memory};
use libration_core::random::Streams;
use libration_core::{Float, Integrator, State, System};

use crate::ensemble::kernel::{Lines, at, put};

/// The length of a step of lane `l`, in units of `dt`.
#[inline(always)]
pub(super) fn ratio<T: Float, C: Clock<T>, const W: usize>(
    clock: &C,
    clocks: &mut <C::Memory as Memory<T>>::Lanes<W>,
    beat: C::Beat,
    times: &mut Streams<W>,
    l: usize,
) -> T {
    let mut memory = C::Memory::lane(clocks, l);
    let ratio = clock.ratio(&mut memory, beat, &mut || times.next(l));
    C::Memory::set_lane(clocks, l, memory);
    ratio
}

/// A step of lane `l`.
#[inline(always)]
pub(super) fn step_with_command<T: Float, Sys: System<T, D>, const D: usize, const W: usize>(
    method: impl Integrator,
    system: &Sys,
    q: &mut Lines<[[T; W]; D]>,
    v: &mut Lines<[[T; W]; D]>,
    l: usize,
    dt: T,
) {
    let state = method.step(system, State { q: at(&q.0, l), v: at(&v.0, l) }, dt);
    put(&mut q.0, l, state.q);
    put(&mut v.0, l, state.v);
}
