//! Cycles of orbits in floats.

use libration_core::{Float, State};

/// The cycle in which an orbit of floats ends: there are finitely many states, so one comes back, and then all do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cycle {
    /// Steps before the first state that comes back.
    pub pre_period: u64,
    /// Steps after which it comes back.
    pub period: u64,
}

impl Cycle {
    /// The cycle of the orbit of `step` from `start`, to the bit; none if the first repetition is later than
    /// `limit` steps, or if the orbit leaves the range of the float.
    ///
    /// Brent's algorithm (BIT 20, 176, 1980): two states of memory, and at most five times as many steps as
    /// `pre_period + period`.
    pub fn find<F: Float, const D: usize>(
        start: State<F, D>,
        limit: u64,
        step: impl Fn(State<F, D>) -> State<F, D>,
    ) -> Option<Self> {
        // The period: a state waits at each power of two until it is met again or for as many steps more.
        let (mut waiting, mut moving, mut power, mut period) = (start, step(start), 1_u64, 1_u64);
        let mut taken = 1;
        while !same(&waiting, &moving) {
            if period == power {
                (waiting, power, period) = (moving, power.saturating_mul(2), 0);
            }
            moving = step(moving);
            period += 1;
            taken += 1;
            if taken > limit.saturating_mul(3) || !moving.coordinates().all(Float::is_finite) {
                return None;
            }
        }
        // The pre-period: two states that far apart meet where the cycle begins.
        let (mut behind, mut ahead, mut pre_period) = (start, start, 0);
        for _ in 0..period {
            ahead = step(ahead);
        }
        while !same(&behind, &ahead) {
            (behind, ahead) = (step(behind), step(ahead));
            pre_period += 1;
        }
        (pre_period + period <= limit).then_some(Cycle { pre_period, period })
    }

    /// The step at which the orbit was first where it is after `n` steps.
    pub fn first_visit(&self, n: u64) -> u64 {
        match n.checked_sub(self.pre_period) {
            Some(within) => self.pre_period + within % self.period,
            None => n,
        }
    }
}

/// Equality to the bit: `−0` is not `0`.
fn same<F: Float, const D: usize>(a: &State<F, D>, b: &State<F, D>) -> bool {
    let signs = |(a, b): (F, F)| a.to_f64().is_sign_negative() == b.to_f64().is_sign_negative();
    a == b && a.coordinates().zip(b.coordinates()).all(signs)
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use half::f16;
    use libration_core::Integrator;
    use libration_core::integrator::{TextbookVerlet, VelocityVerlet};
    use libration_core::system::Oscillator;

    use super::*;

    #[test]
    fn the_sources_verlet_in_single_precision_comes_back_after_377896_steps() {
        let system = Oscillator { omega2: 10.0_f32 };
        let start = State { q: [1.0], v: [0.0] };
        let cycle = Cycle::find(start, 1_000_000, |s| TextbookVerlet.step(&system, s, 0.01));
        assert_eq!(cycle, Some(Cycle { pre_period: 177_350, period: 377_896 }));
        let short = Cycle::find(start, 555_245, |s| TextbookVerlet.step(&system, s, 0.01));
        assert_eq!(short, None);
    }

    #[test]
    fn a_cycle_is_the_one_that_a_table_of_all_states_finds() {
        let short = f16::from_f64;
        for omega2 in [10.0, 3.0, 0.7, 0.001] {
            let system = Oscillator { omega2: short(omega2) };
            let step = |s| VelocityVerlet.step(&system, s, short(0.01));
            let start = State { q: [short(1.0)], v: [short(0.3)] };
            let (mut seen, mut state, mut n) = (HashMap::new(), start, 0);
            let first = loop {
                let bits = (state.q[0].to_bits(), state.v[0].to_bits());
                if let Some(first) = seen.insert(bits, n) {
                    break first;
                }
                (state, n) = (step(state), n + 1);
            };
            let table = Cycle { pre_period: first, period: n - first };
            assert_eq!(Cycle::find(start, n, step), Some(table), "{omega2}");
            assert_eq!(Cycle::find(start, n - 1, step), None, "{omega2}");
        }
    }

    #[test]
    fn an_orbit_that_overflows_has_no_cycle() {
        let start = State { q: [f16::from_f64(1.0)], v: [f16::from_f64(0.0)] };
        assert_eq!(Cycle::find(start, 1 << 20, |s| s.doubled()), None);
    }

    #[test]
    fn the_first_visit_lies_before_the_end_of_the_first_turn_of_the_cycle() {
        let cycle = Cycle { pre_period: 10, period: 7 };
        assert_eq!([3, 10, 16, 17, 31, 32].map(|n| cycle.first_visit(n)), [3, 10, 16, 10, 10, 11]);
    }
}
