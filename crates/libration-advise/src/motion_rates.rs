//! Rates of a motion.

use std::f64::consts::TAU;

use libration_work::Work;

use super::AdviseError;
use super::free_motion::FreeMotion;
use super::system_programs::Slopes;

/// What becomes of the energy of a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum EnergyKind {
    /// It is conserved: steps of order four change it the less the shorter they are.
    Kept,
    /// It is not conserved.
    Lost,
}

/// Rates of a motion in rad/s.
#[derive(Clone, Copy, Debug)]
pub(super) struct MotionRates {
    /// The mean one: the largest velocity over the amplitude.
    pub(super) mean: f64,
    /// The largest one.
    pub(super) fastest: f64,
    /// That of the stiffest place on the way; zero without forces that depend on the state.
    pub(super) stiffest: f64,
}

/// Derivatives that a run computes, about; of one or two degrees of freedom they are computed at each step.
const LOOKED_AT: u64 = 1 << 14;

impl FreeMotion<'_> {
    /// The rates of the true motion. Steps of order four are halved until they are resolved.
    pub(super) fn rates(&self, work: &Work<'_>) -> Result<MotionRates, AdviseError> {
        const SETTLED: f64 = 0.1;
        const TURN: f64 = 0.5;
        const MOTIONS: f64 = 200.0;
        let degrees = self.system.degrees();
        let mut slopes = self.system.slopes();
        let [by_positions, by_velocities] = self.stiffness(&mut slopes, &self.start);
        if !self.system.depends_on_time() && self.is_at_rest() {
            return Err(self.tolerance_error("nothing moves from this start; choose another start"));
        }
        // The rates of one oscillation are known.
        if let (Some(damped), 1) = (self.system.exact_rate(), degrees) {
            let mean = match by_positions > 0.0 {
                true => by_positions,
                false => damped.max(self.horizon.recip()),
            };
            let fastest = mean.max(damped);
            return Ok(MotionRates { mean, fastest, stiffest: fastest });
        }
        let begins = by_positions.max(by_velocities);
        // A periodic motion is known before the horizon; what depends on time may begin late.
        let is_periodic = begins > 0.0 && !self.system.depends_on_time();
        let long = if is_periodic { MOTIONS * TAU / begins } else { self.horizon };
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
            let stride = match degrees {
                0..=2 => 1,
                _ => (steps * 2 * degrees as u64 / LOOKED_AT).max(1),
            };
            for step in 0..steps {
                let state = trajectory.next();
                if step.is_multiple_of(stride) {
                    let here = self.stiffness(&mut slopes, state);
                    stiffest = here.into_iter().fold(stiffest, f64::max);
                }
                for &i in self.system.states() {
                    (low[i], high[i]) = (low[i].min(state[i]), high[i].max(state[i]));
                    if i >= degrees {
                        speed = speed.max(state[i].abs());
                    }
                }
            }
            let states = self.system.states().iter();
            if states.clone().all(|&i| low[i] == high[i]) && speed == 0.0 {
                let why = "nothing moves from this start within the horizon; choose another start";
                return Err(self.tolerance_error(why));
            }
            let positions = states.filter(|&&i| i < degrees);
            let far = positions.map(|&i| 0.5 * (high[i] - low[i])).fold(0.0, f64::max);
            let found = Some(speed / far).filter(|found| found.is_finite());
            let mean = found.unwrap_or(stiffest).max(self.horizon.recip());
            if (mean / before - 1.0).abs() < SETTLED && stiffest * dt < TURN {
                return Ok(MotionRates { mean, fastest: stiffest.max(mean), stiffest });
            }
            (before, steps) = (mean, 2 * steps);
        }
        Err(self.tolerance_error(&format!(
            "its motion is not resolved by {most:.0e} steps in {long:.3e} s: it is too fast or unbounded"
        )))
    }

    /// The energy that errors are relative to: the mean kinetic energy of the motion, where the kinetic energy is the energy less that without
    /// velocities. It does not depend on the constant of the potential, as the energy at the start does, and is `|E|` for a closed orbit under
    /// gravity (virial theorem). None if it is zero or no number.
    pub(super) fn energy_scale(&self, work: &Work<'_>) -> Result<Option<f64>, AdviseError> {
        const ANGLE: f64 = 0.05;
        const TURNS: f64 = 200.0;
        let Some(mut energy) = self.system.energy() else { return Ok(None) };
        let degrees = self.system.degrees();
        let mut kinetic = |state: &[f64]| {
            let mut still = state.to_vec();
            still[degrees..].fill(0.0);
            energy(state) - energy(&still)
        };
        let long = self.horizon.min(TURNS * TAU / self.rates.mean);
        let [_, most] = self.system.most_steps();
        let steps = (long * self.rates.fastest / ANGLE).ceil().clamp(64.0, most);
        let method = self.system.reference_method();
        let mut trajectory = self.system.steps(false, method, long / steps, &self.start);
        let mut sum = 0.5 * kinetic(&self.start);
        let mut last = 0.0;
        for _ in 0..steps as u64 {
            last = kinetic(trajectory.next());
            sum += last;
        }
        work.check()?;
        let mean = ((sum - 0.5 * last) / steps).abs();
        Ok(Some(mean).filter(|scale| scale.is_finite() && *scale > 0.0))
    }

    fn is_at_rest(&self) -> bool {
        let degrees = self.system.degrees();
        let mut at = vec![0.0; degrees];
        self.system.accelerations()(&self.start, &mut at);
        let moves = |&i: &usize| match i.checked_sub(degrees) {
            Some(i) => at[i] != 0.0,
            None => self.start[degrees + i] != 0.0,
        };
        !self.system.states().iter().any(moves)
    }

    /// What becomes of the energy.
    pub(super) fn energy_kind(&self, rates: &MotionRates) -> EnergyKind {
        // An error of about 10⁻¹¹ in a turn.
        const ANGLE: f64 = 0.01;
        const MOST: f64 = 65_536.0;
        // Rounding alone is less than a thousandth of this part of the energy of the velocities.
        const NOTHING: f64 = 1e-10;
        let Some(mut energy) = self.system.energy() else { return EnergyKind::Lost };
        let (first, long) = (energy(&self.start), self.horizon.min(TAU / rates.mean));
        let steps = (long * rates.fastest / ANGLE).ceil().clamp(16.0, MOST);
        let method = self.system.reference_method();
        let degrees = self.system.degrees();
        let mut change = |steps: f64| {
            let dt = long / steps;
            let mut trajectory = self.system.steps(false, method, dt, &self.start);
            let (mut change, mut moved) = (0.0_f64, first.abs());
            for _ in 0..steps as u64 {
                let state = trajectory.next();
                let here = energy(state);
                let mut still = state.to_vec();
                still[degrees..].fill(0.0);
                change = change.max((here - first).abs());
                moved = moved.max((here - energy(&still)).abs());
            }
            [change, moved]
        };
        let [[coarse, _], [fine, moved]] = [steps, 2.0 * steps].map(&mut change);
        if fine >= 0.3 * coarse && fine >= NOTHING * moved {
            EnergyKind::Lost
        } else {
            EnergyKind::Kept
        }
    }

    fn tolerance_error(&self, why: &str) -> AdviseError {
        AdviseError::Tolerance { of: self.of, why: why.to_owned() }
    }

    /// The square root of the norm of the derivatives of accelerations by positions, and the norm of those by velocities, in rad/s.
    fn stiffness(&self, slopes: &mut Slopes<'_>, state: &[f64]) -> [f64; 2] {
        let degrees = self.system.degrees();
        let mut slope = vec![0.0; degrees];
        let mut squares = [0.0; 2];
        for &i in self.system.states() {
            slopes(state, i, &mut slope);
            squares[usize::from(i >= degrees)] += slope.iter().map(|x| x * x).sum::<f64>();
        }
        [squares[0].sqrt().sqrt(), squares[1].sqrt()]
    }
}
