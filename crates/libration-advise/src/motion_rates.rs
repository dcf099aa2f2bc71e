//! Rates of a motion.

use std::f64::consts::TAU;

use libration::integrator::{Exact, SUZUKI4};
use libration::system::DynSystem;
use libration::{Integrator, Model, State, System};
use libration_work::Work;

use super::AdviseError;
use super::free_motion::{FreeMotion, MOST_COMPARED};

impl<M: Model<D>, const D: usize> FreeMotion<M, D> {
    /// The mean and the largest rate of the true motion, in rad/s: the largest velocity over the amplitude, and the rate of the
    /// stiffest place on its way. Steps of order four are halved until both are resolved.
    pub(super) fn rates(&self, work: &Work<'_>) -> Result<[f64; 2], AdviseError> {
        const SETTLED: f64 = 0.1;
        const TURN: f64 = 0.5;
        const MOTIONS: f64 = 200.0;
        let begins = self.stiffness(&self.start);
        if self.is_at_rest() {
            return Err(
                self.tolerance_error("nothing moves from this start; choose another `q` or `v`")
            );
        }
        if let Some(damped) = Exact::angle(self.model, 1.0) {
            let rate = if begins > 0.0 { begins } else { damped.max(self.horizon.recip()) };
            return Ok([rate, rate.max(damped)]);
        }
        let acceleration = |state: &State<f64, D>| self.model.on::<f64>().acceleration(state);
        let system = DynSystem(&acceleration);
        // A periodic motion is known before the horizon.
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
        Err(self.tolerance_error(&format!(
            "its motion is not resolved by {MOST_COMPARED:.0e} steps in {long:.3e} s: it is too fast or unbounded"
        )))
    }

    fn is_at_rest(&self) -> bool {
        let at = self.model.on::<f64>().acceleration(&self.start);
        self.start.v.iter().chain(&at).all(|x| *x == 0.0)
    }

    fn tolerance_error(&self, why: &str) -> AdviseError {
        AdviseError::Tolerance { of: self.of, why: why.to_owned() }
    }

    /// The square root of the norm of the stiffness matrix, in rad/s.
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
