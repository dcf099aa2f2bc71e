//! A motion with its reference.

use libration::equations::{Dynamics, StepProgram};
use libration::number::TwoFloat;
use libration::{Method, Trajectory};
use libration_work::Work;

use super::dense_reference::DenseReference;
use super::{ComparisonError, ComparisonRequest};
use crate::reference_flow::Rates;
use crate::step::step_order;

/// Steps up to which errors are taken after each of them; of more, after as many that are evenly spread, and after those at the nodes of the
/// reference, which are dense where the motion is fast.
const MOST_SAMPLES: u64 = 4096;

/// The fewest pieces of the reference of a motion whose forces have kinks or jumps.
pub(super) const PIECES: f64 = 2048.0;

/// About the largest size of each state: RK4 in as many steps as there are samples.
fn sizes(request: &ComparisonRequest, start: &[f64]) -> Vec<f64> {
    let dt = request.horizon / MOST_SAMPLES as f64;
    let dynamics = request.system.equations.dynamics();
    let mut trajectory = Trajectory::new(Method::Rk4.into(), dynamics, start, dt);
    let mut sizes: Vec<f64> = start.iter().map(|x| x.abs()).collect();
    for _ in 0..MOST_SAMPLES {
        if !trajectory.advance(1) {
            // What is not known is no size.
            return vec![0.0; start.len()];
        }
        let state = trajectory.state();
        sizes.iter_mut().zip(state).for_each(|(size, x)| *size = size.max(x.abs()));
    }
    sizes
}

/// A motion with its exact states.
pub(super) struct Motion<'r> {
    work: Work<'r>,
    pub(super) request: &'r ComparisonRequest,
    /// Positions, then velocities.
    start: Vec<f64>,
    reference: DenseReference,
}

impl<'r> Motion<'r> {
    pub(super) fn new(
        work: &Work<'r>,
        request: &'r ComparisonRequest,
    ) -> Result<Self, ComparisonError> {
        let ComparisonRequest { horizon, tolerance, ref system } = *request;
        let (dynamics, start) = (system.equations.dynamics(), system.initial_state());
        let mut rates = Rates::<TwoFloat>::new(dynamics);
        let sizes = sizes(request, &start);
        let is_smooth = dynamics.accelerations().is_smooth();
        let mut follow = |longest: f64| {
            DenseReference::new(work, &mut rates, &start, &sizes, horizon, tolerance, longest)
        };
        let mut reference = follow(if is_smooth { horizon / 8.0 } else { horizon / PIECES })?;
        if !is_smooth {
            // A kink between two evaluations is seen by neither: the pieces of a second reference end elsewhere.
            let (off, time) = reference.largest_difference(&follow(0.7 * horizon / PIECES)?);
            if off > tolerance / 20.0 {
                return Err(ComparisonError::NotSmooth { time, horizon });
            }
            reference.error += off;
        }
        let reference_error = reference.error;
        if reference_error.is_nan() || reference_error > tolerance / 10.0 {
            return Err(ComparisonError::Reference { reference_error, horizon, tolerance });
        }
        if reference.rests_at(&start) {
            return Err(ComparisonError::AtRest);
        }
        Ok(Motion { work: *work, request, start, reference })
    }

    pub(super) fn reference_error(&self) -> f64 {
        self.reference.error
    }

    /// The order of a step on this system; 0 if it has none.
    pub(super) fn order(&self, step: &StepProgram) -> u32 {
        let ComparisonRequest { system, horizon, .. } = self.request;
        let places: Vec<usize> = (0..self.start.len()).collect();
        step_order(step, &system.start(), &places, horizon / 64.0).unwrap_or(0)
    }

    /// The system.
    pub(super) fn dynamics(&self) -> &'r Dynamics {
        self.request.system.equations.dynamics()
    }

    /// The largest error of a state in a motion in `steps` steps, relative to the largest size of that state; infinite if it ends.
    pub(super) fn error(&self, method: Method, steps: u64) -> f64 {
        let mut worst = 0.0_f64;
        let is_finite = self.compare(method, steps, |state, exact| {
            for ((x, exact), scale) in state.iter().zip(exact).zip(&self.reference.scales) {
                let off = (x - exact).abs() / scale;
                worst = if off > worst || off.is_nan() { off } else { worst };
            }
        });
        if is_finite && !worst.is_nan() { worst } else { f64::INFINITY }
    }

    /// The largest difference of the energy from that of the exact motion, relative to the mean kinetic energy of that motion, which does not
    /// depend on the constant of the potential. None without an energy or without such a size.
    pub(super) fn energy_error(&self, method: Method, steps: u64) -> Option<f64> {
        let mut energy = self.dynamics().energy()?.on::<f64>();
        let mut energy_of = |state: &[f64]| energy.run(state).next().unwrap_or(f64::NAN);
        let (mut state, mut hint) = (self.start.clone(), 0);
        let mut scale = 0.0_f64;
        for sample in 0..=MOST_SAMPLES {
            let time = self.request.horizon * (sample as f64 / MOST_SAMPLES as f64);
            self.reference.write(time, &mut hint, &mut state);
            let total = energy_of(&state);
            state[self.start.len() / 2..].fill(0.0);
            // The trapezoidal rule.
            let weight = if sample == 0 || sample == MOST_SAMPLES { 0.5 } else { 1.0 };
            scale += weight * (total - energy_of(&state));
        }
        let scale = (scale / MOST_SAMPLES as f64).abs();
        let mut worst = 0.0_f64;
        self.compare(method, steps, |state, exact| {
            let off = (energy_of(state) - energy_of(exact)).abs() / scale;
            worst = if off > worst || off.is_nan() { off } else { worst };
        });
        worst.is_finite().then_some(worst)
    }

    /// Shows states after steps, and the exact ones. Returns whether all were finite.
    fn compare(&self, method: Method, steps: u64, mut show: impl FnMut(&[f64], &[f64])) -> bool {
        let horizon = self.request.horizon;
        let (mut hint, mut exact) = (0, vec![0.0; self.start.len()]);
        let mut interval = (0, 0);
        self.follow(method, steps, |number, state| {
            // The samples before this step and up to it, in whole numbers.
            let sample = |number: u64| u128::from(number) * u128::from(MOST_SAMPLES);
            let is_even = steps <= MOST_SAMPLES
                || sample(number) / u128::from(steps) > sample(number - 1) / u128::from(steps);
            let time =
                if number == steps { horizon } else { horizon * (number as f64 / steps as f64) };
            let now = self.reference.interval(time, &mut hint);
            if is_even || now != interval {
                self.reference.write(time, &mut hint, &mut exact);
                show(state, &exact);
            }
            interval = now;
        })
    }

    /// Shows the state after each step. Returns whether all were finite; false as well after an interrupt, for which the caller checks.
    fn follow(&self, method: Method, steps: u64, mut show: impl FnMut(u64, &[f64])) -> bool {
        let dt = self.request.horizon / steps as f64;
        let mut trajectory = Trajectory::new(method.into(), self.dynamics(), &self.start, dt);
        (1..=steps).all(|number| {
            let is_running =
                trajectory.advance(1) && (number % 64 != 0 || self.work.check().is_ok());
            if is_running {
                show(number, trajectory.state());
            }
            is_running
        })
    }
}
