//! The parts of control loops.

use libration_core::Float;
use libration_core::control::clock::Fixed;
use libration_core::control::controller::OpenLoop;
use libration_core::control::{Clock, Controller, Delay, Memory, NoDisturbance, Schedule};

/// A plant with its integrator, and what drives and disturbs it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setup<A, M, K = OpenLoop, C = Fixed, L = Schedule, N = NoDisturbance> {
    /// The plant of every trajectory: [`All`](super::super::All) or [`PerTrajectory`](super::super::PerTrajectory).
    pub systems: A,
    /// The integrator.
    pub method: M,
    /// The controller.
    pub controller: K,
    /// The clock.
    pub clock: C,
    /// When commands arrive.
    pub delay: L,
    /// The disturbance.
    pub disturbance: N,
}

impl<A, M> Setup<A, M> {
    /// A plant that nothing drives or disturbs.
    pub fn new(systems: A, method: M) -> Self {
        let (controller, clock, delay) = (OpenLoop, Fixed, Schedule::EVERY_STEP);
        Setup { systems, method, controller, clock, delay, disturbance: NoDisturbance }
    }
}

impl<A, M, K, C, L, N> Setup<A, M, K, C, L, N> {
    /// Sets the controller.
    pub fn controller<Other>(self, controller: Other) -> Setup<A, M, Other, C, L, N> {
        let Setup { systems, method, clock, delay, disturbance, .. } = self;
        Setup { systems, method, controller, clock, delay, disturbance }
    }

    /// Sets the clock.
    pub fn clock<Other>(self, clock: Other) -> Setup<A, M, K, Other, L, N> {
        let Setup { systems, method, controller, delay, disturbance, .. } = self;
        Setup { systems, method, controller, clock, delay, disturbance }
    }

    /// Sets the delay.
    pub fn delay<Other>(self, delay: Other) -> Setup<A, M, K, C, Other, N> {
        let Setup { systems, method, controller, clock, disturbance, .. } = self;
        Setup { systems, method, controller, clock, delay, disturbance }
    }

    /// Sets the disturbance.
    pub fn disturbance<Other>(self, disturbance: Other) -> Setup<A, M, K, C, L, Other> {
        let Setup { systems, method, controller, clock, delay, .. } = self;
        Setup { systems, method, controller, clock, delay, disturbance }
    }
}

/// The first row of each part of the memory of loops.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Layout {
    pub(super) clock: usize,
    pub(super) delay: usize,
    pub(super) controller: usize,
    /// The command that acts.
    pub(super) held: usize,
    /// The commands that were computed, `D` rows each.
    pub(super) ring: usize,
    /// How many of them there are.
    pub(super) places: usize,
    /// All rows.
    pub(super) rows: usize,
}

impl Layout {
    pub(super) fn of<T, A, M, K, C, L, N, const D: usize>(setup: &Setup<A, M, K, C, L, N>) -> Self
    where
        T: Float,
        K: Controller<T, D>,
        C: Clock<T>,
        L: Delay<T>,
    {
        let places = if K::ACTS { setup.delay.longest() + 1 } else { 0 };
        let clock = 0;
        let delay = clock + C::Memory::LEN;
        let controller = delay + L::Memory::LEN;
        let held = controller + K::Memory::LEN;
        let ring = held + if K::ACTS { D } else { 0 };
        let rows = ring + places * D;
        Layout { clock, delay, controller, held, ring, places, rows }
    }
}
