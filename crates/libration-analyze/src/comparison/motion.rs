//! A motion with its reference.

use libration::equations::StepProgram;
use libration::number::TwoFloat;
use libration::{Float, Method, Scalar};

use super::{ComparisonError, ComparisonRequest};
use crate::program_stepper::ProgramStepper;
use crate::reference_flow::{Point, Rates, flow};

/// Times at which errors are taken, evenly spaced; the last is the end.
pub(super) const SAMPLES: u64 = 8;

/// A motion with its exact states at the times of the samples.
pub(super) struct Motion<'r> {
    pub(super) request: &'r ComparisonRequest,
    reference: Vec<Point>,
    /// The largest size of each state, or 1 if it is always zero.
    scales: Vec<f64>,
    reference_error: f64,
}

impl<'r> Motion<'r> {
    pub(super) fn new(request: &'r ComparisonRequest) -> Result<Self, ComparisonError> {
        let ComparisonRequest { horizon, tolerance, .. } = *request;
        let mut rates = Rates::<TwoFloat>::new(&request.dynamics);
        let interval = TwoFloat::from_f64(horizon).ratio(1, SAMPLES as i32);
        let start: Point = request.start.iter().map(|&x| TwoFloat::from_f64(x)).collect();
        let (mut reference, mut reference_error) = (vec![start], 0.0);
        for sample in 0..SAMPLES {
            let (next, off) = flow(&mut rates, &reference[reference.len() - 1], interval);
            if !next.iter().all(|x| x.to_f64().is_finite()) {
                let time = horizon * sample as f64 / SAMPLES as f64;
                return Err(ComparisonError::NotFinite { time, horizon });
            }
            reference_error += off;
            reference.push(next);
        }
        // An error of a double grows as much as that of the reference does.
        if reference_error.is_nan() || reference_error > tolerance / 10.0 {
            return Err(ComparisonError::Reference { reference_error, horizon, tolerance });
        }
        let largest = |i: usize| reference.iter().map(|x| x[i].to_f64().abs()).fold(0.0, f64::max);
        let scales = (0..request.start.len()).map(largest);
        let scales = scales.map(|size| if size > 0.0 { size } else { 1.0 }).collect();
        Ok(Motion { request, reference, scales, reference_error })
    }

    pub(super) fn reference_error(&self) -> f64 {
        self.reference_error
    }

    /// The program of a step.
    pub(super) fn step_of(&self, method: Method) -> StepProgram {
        StepProgram::new(method, &self.request.dynamics)
    }

    /// The largest error of a motion in `steps` steps, a multiple of [`SAMPLES`]; infinite if it ends.
    pub(super) fn error(&self, step: &StepProgram, steps: u64) -> f64 {
        let mut worst = 0.0_f64;
        let is_finite = self.follow(step, steps, |number, state| {
            let sample = number * SAMPLES / steps;
            if sample * steps == number * SAMPLES {
                let exact = &self.reference[sample as usize];
                for ((&x, exact), scale) in state.iter().zip(exact).zip(&self.scales) {
                    let off = (TwoFloat::from_f64(x) - *exact).to_f64().abs() / scale;
                    worst = if off > worst || off.is_nan() { off } else { worst };
                }
            }
        });
        if is_finite && !worst.is_nan() { worst } else { f64::INFINITY }
    }

    /// The largest change of the energy in the course of a motion in `steps` steps; none without an energy.
    pub(super) fn energy_error(&self, step: &StepProgram, steps: u64) -> Option<f64> {
        let mut energy = self.request.dynamics.energy()?.on::<f64>();
        let start = energy.run(&self.request.start).next()?;
        let scale = if start == 0.0 { 1.0 } else { start.abs() };
        let mut worst = 0.0_f64;
        self.follow(step, steps, |_, state| {
            let off = energy.run(state).next().map_or(f64::NAN, |now| (now - start).abs() / scale);
            worst = if off > worst || off.is_nan() { off } else { worst };
        });
        Some(worst)
    }

    /// Shows the state after each step. Returns whether all were finite.
    fn follow(&self, step: &StepProgram, steps: u64, mut show: impl FnMut(u64, &[f64])) -> bool {
        let ComparisonRequest { dynamics, start, horizon, .. } = self.request;
        let mut stepper = ProgramStepper::<f64>::new(step, dynamics, start);
        let dt = horizon / steps as f64;
        for number in 1..=steps {
            let state = stepper.step(dt);
            // A state that is not finite stays so.
            if number % 64 == 0 && !state.iter().all(|x| x.is_finite()) {
                return false;
            }
            show(number, state);
        }
        stepper.state().iter().all(|x| x.is_finite())
    }
}
