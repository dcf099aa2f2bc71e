//! How fast a motion is.

use std::f64::consts::TAU;

use libration::integrator::{Exact, SUZUKI4};
use libration::system::DynSystem;
use libration::{Integrator, Model, State, System};
use libration_work::Work;

use super::AdviseError;
use super::free::{Free, MOST_COMPARED};

impl<M: Model<D>, const D: usize> Free<M, D> {
    /// How fast the true motion is, in rad/s: in the mean, its largest velocity over its largest distance from its middle, and at most,
    /// as the stiffest place that it comes through says. Steps of order four are halved until both are resolved; what is linear is as
    /// stiff everywhere.
    pub(super) fn rates(&self, work: &Work<'_>) -> Result<[f64; 2], AdviseError> {
        const SETTLED: f64 = 0.1;
        const TURN: f64 = 0.5;
        const MOTIONS: f64 = 200.0;
        let begins = self.stiffness(&self.start);
        if self.rests() {
            return Err(self.refused("nothing moves from this start; give another `q` or `v`"));
        }
        if let Some(damped) = Exact::angle(self.model, 1.0) {
            let rate = if begins > 0.0 { begins } else { damped.max(self.horizon.recip()) };
            return Ok([rate, rate.max(damped)]);
        }
        let acceleration = |state: &State<f64, D>| self.model.on::<f64>().acceleration(state);
        let system = DynSystem(&acceleration);
        // A motion that repeats is known long before the horizon.
        let long = if begins > 0.0 { MOTIONS * TAU / begins } else { self.horizon };
        let long = self.horizon.min(long);
        let (mut before, mut steps) = (f64::NAN, 1_u64 << 10);
        while steps as f64 <= MOST_COMPARED {
            work.check()?;
            let dt = long / steps as f64;
            let mut state = self.start;
            let (mut low, mut high, mut speed) = (state.q, state.q, 0.0_f64);
            let mut stiffest = begins;
            for _ in 0..steps {
                state = SUZUKI4.step(&system, state, dt);
                stiffest = stiffest.max(self.stiffness(&state));
                for i in 0..D {
                    (low[i], high[i]) = (low[i].min(state.q[i]), high[i].max(state.q[i]));
                    speed = speed.max(state.v[i].abs());
                }
            }
            let far = (0..D).map(|i| 0.5 * (high[i] - low[i])).fold(0.0, f64::max);
            let found = Some(speed / far).filter(|found| found.is_finite());
            let found = found.unwrap_or(stiffest).max(self.horizon.recip());
            if (found / before - 1.0).abs() < SETTLED && stiffest * dt < TURN {
                return Ok([found, stiffest.max(found)]);
            }
            (before, steps) = (found, 2 * steps);
        }
        Err(self.refused(&format!(
            "its motion is not resolved by {MOST_COMPARED:.0e} steps in {long:.3e} s: it is too fast there, or leaves"
        )))
    }

    fn rests(&self) -> bool {
        let at = self.model.on::<f64>().acceleration(&self.start);
        self.start.v.iter().chain(&at).all(|x| *x == 0.0)
    }

    fn refused(&self, why: &str) -> AdviseError {
        AdviseError::Tolerance { of: self.of, why: why.to_owned() }
    }

    /// The root of how fast the acceleration changes with the position, in rad/s.
    fn stiffness(&self, state: &State<f64, D>) -> f64 {
        let model = self.model.on::<f64>();
        let here = model.acceleration(state);
        let size = state.q.iter().fold(0.0, |size: f64, x| size.hypot(*x));
        let far = 1e-6 * size.max(1e-3);
        let slope = |i: usize| {
            let mut beside = *state;
            beside.q[i] += far;
            let there = model.acceleration(&beside);
            here.iter().zip(there).map(|(a, b)| ((b - a) / far).powi(2)).sum::<f64>()
        };
        (0..D).map(slope).sum::<f64>().sqrt().sqrt()
    }
}
