//! Rates of a motion.

use std::f64::consts::TAU;

use libration_work::Work;

use super::AdviseError;
use super::free_motion::FreeMotion;
use super::simulated_system::Accelerations;

impl FreeMotion<'_> {
    /// The mean and the largest rate of the true motion, in rad/s: the largest velocity over the amplitude, and the rate of the
    /// stiffest place on its way. Steps of order four are halved until both are resolved.
    pub(super) fn rates(&self, work: &Work<'_>) -> Result<[f64; 2], AdviseError> {
        const SETTLED: f64 = 0.1;
        const TURN: f64 = 0.5;
        const MOTIONS: f64 = 200.0;
        let degrees = self.system.degrees();
        let mut accelerations = self.system.accelerations();
        let [by_positions, by_velocities] = self.stiffness(&mut accelerations, &self.start);
        if self.is_at_rest(&mut accelerations) {
            return Err(
                self.tolerance_error("nothing moves from this start; choose another `q` or `v`")
            );
        }
        if let Some(damped) = self.system.exact_rate() {
            let rate = match by_positions > 0.0 {
                true => by_positions,
                false => damped.max(self.horizon.recip()),
            };
            return Ok([rate, rate.max(damped)]);
        }
        let begins = by_positions.max(by_velocities);
        // A periodic motion is known before the horizon.
        let long = if begins > 0.0 { MOTIONS * TAU / begins } else { self.horizon };
        let long = self.horizon.min(long);
        let method = self.system.reference_method();
        let (mut before, mut steps) = (f64::NAN, 1_u64 << 10);
        let [_, most] = self.system.most_steps();
        while steps as f64 <= most {
            work.check()?;
            let dt = long / steps as f64;
            let mut trajectory = self.system.steps(false, method, dt, &self.start);
            let (mut low, mut high) = (self.start.clone(), self.start.clone());
            let (mut speed, mut stiffest) = (0.0_f64, begins);
            for _ in 0..steps {
                let state = trajectory.next();
                let here = self.stiffness(&mut accelerations, state);
                stiffest = here.into_iter().fold(stiffest, f64::max);
                for &i in self.system.states() {
                    (low[i], high[i]) = (low[i].min(state[i]), high[i].max(state[i]));
                    if i >= degrees {
                        speed = speed.max(state[i].abs());
                    }
                }
            }
            let positions = self.system.states().iter().filter(|&&i| i < degrees);
            let far = positions.map(|&i| 0.5 * (high[i] - low[i])).fold(0.0, f64::max);
            let found = Some(speed / far).filter(|found| found.is_finite());
            let found = found.unwrap_or(stiffest).max(self.horizon.recip());
            if (found / before - 1.0).abs() < SETTLED && stiffest * dt < TURN {
                return Ok([found, stiffest.max(found)]);
            }
            (before, steps) = (found, 2 * steps);
        }
        Err(self.tolerance_error(&format!(
            "its motion is not resolved by {most:.0e} steps in {long:.3e} s: it is too fast or unbounded"
        )))
    }

    fn is_at_rest(&self, accelerations: &mut Accelerations<'_>) -> bool {
        let degrees = self.system.degrees();
        let mut at = vec![0.0; degrees];
        accelerations(&self.start, &mut at);
        let moves = |&i: &usize| match i.checked_sub(degrees) {
            Some(i) => at[i] != 0.0,
            None => self.start[degrees + i] != 0.0,
        };
        !self.system.states().iter().any(moves)
    }

    /// Whether steps of order four change the energy the less the shorter they are.
    pub(super) fn conserves_energy(&self, [omega, fastest]: [f64; 2]) -> bool {
        // An error of about 10⁻¹¹ in a turn.
        const ANGLE: f64 = 0.01;
        const MOST: f64 = 65_536.0;
        let Some(mut energy) = self.system.energy() else { return false };
        let (first, long) = (energy(&self.start), self.horizon.min(TAU / omega));
        let steps = (long * fastest / ANGLE).ceil().clamp(16.0, MOST);
        let method = self.system.reference_method();
        let mut change = |steps: f64| {
            let dt = long / steps;
            let mut trajectory = self.system.steps(false, method, dt, &self.start);
            let each = (0..steps as u64).map(|_| (energy(trajectory.next()) - first).abs());
            each.fold(0.0, f64::max)
        };
        let [coarse, fine] = [steps, 2.0 * steps].map(&mut change);
        // Rounding alone is less than a thousandth of this.
        fine < 0.3 * coarse || fine < 1e-10 * first.abs()
    }

    fn tolerance_error(&self, why: &str) -> AdviseError {
        AdviseError::Tolerance { of: self.of, why: why.to_owned() }
    }

    /// The square root of the norm of the derivatives of accelerations by positions, and the norm of those by velocities, in rad/s.
    fn stiffness(&self, accelerations: &mut Accelerations<'_>, state: &[f64]) -> [f64; 2] {
        let degrees = self.system.degrees();
        let (positions, _) = state.split_at(degrees);
        let mut here = vec![0.0; degrees];
        accelerations(state, &mut here);
        let mut there = here.clone();
        let mut beside = state.to_vec();
        let size = |part: &[f64]| part.iter().fold(0.0, |size: f64, x| size.hypot(*x));
        let mut squares = [0.0; 2];
        for &i in self.system.states() {
            let of_velocity = i >= degrees;
            let part = if of_velocity { &state[degrees..] } else { positions };
            let far = 1e-6 * size(part).max(1e-3);
            beside[i] += far;
            accelerations(&beside, &mut there);
            beside[i] = state[i];
            let slope = here.iter().zip(&there).map(|(a, b)| ((b - a) / far).powi(2));
            squares[usize::from(of_velocity)] += slope.sum::<f64>();
        }
        [squares[0].sqrt().sqrt(), squares[1].sqrt()]
    }
}
