//! Velocity Verlet as textbooks print it.

use super::Integrator;
use crate::array::each;
use crate::{Scalar, State, System};

/// Velocity Verlet as `q' = q + Δt·v + ½Δt²·a`, `v' = v + ½Δt·(a + a')`.
///
/// In exact arithmetic it is [`VelocityVerlet`](super::VelocityVerlet) wherever the acceleration
/// does not depend on the velocity. In floats it rounds differently, with a bias that makes the
/// energy drift linearly.
///
/// Where the acceleration depends on the velocity it is another method: `a'` is that of the new position and of the *old*
/// velocity, where velocity Verlet takes the velocity half way. Both have order 1 there, and their limits of stability differ: on a
/// critically damped oscillator it is stable up to `ωΔt = 1`, velocity Verlet up to 2.
#[derive(Clone, Copy, Debug, Default)]
pub struct TextbookVerlet;

impl Integrator for TextbookVerlet {
    const CARRIES: bool = true;

    #[inline(always)]
    fn step<S: Scalar, const D: usize>(
        self,
        system: &impl System<S, D>,
        state: State<S, D>,
        dt: S,
    ) -> State<S, D> {
        self.carried(system, state, system.acceleration(&state), dt).0
    }

    #[inline(always)]
    fn carried<S: Scalar, const D: usize>(
        self,
        system: &impl System<S, D>,
        State { q, v }: State<S, D>,
        a: [S; D],
        dt: S,
    ) -> (State<S, D>, [S; D]) {
        let half = dt.ratio(1, 2);
        let q = each(|i| q[i] + dt * v[i] + half * dt * a[i]);
        let next = system.acceleration(&State { q, v });
        (State { q, v: each(|i| v[i] + half * (a[i] + next[i])) }, next)
    }
}
