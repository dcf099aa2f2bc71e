//! Runs on an ellipse with adaptive steps.

use std::f64::consts::TAU;

use libration::Method;
use libration::equations::{Dynamics, StepProgram};
use libration::system::Kepler;
use libration_analyze::adaptive::{AdaptivePrograms, AdaptiveStepper, StepControl};

use crate::program_stepper::ProgramStepper;

/// The integrator of all runs: symmetric, of order 2.
pub(super) const METHOD: Method = Method::Leapfrog;

/// An ellipse with semi-major axis 1 around a mass with `G·M = 1`, from its pericentre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ellipse {
    pub(super) eccentricity: f64,
}

impl Ellipse {
    pub(super) fn dynamics() -> Dynamics {
        Dynamics::of::<2>(&Kepler { mu: 1.0 }, None)
    }

    pub(super) fn start(self) -> [f64; 4] {
        let e = self.eccentricity;
        [1.0 - e, 0.0, 0.0, ((1.0 + e) / (1.0 - e)).sqrt()]
    }

    /// Steps of a period for a first step of 1: the integral of the local frequency over that of the start, which is
    /// `((1 − e)/r)^(3/2)`, over the period.
    ///
    /// With the eccentric anomaly `E` the time is `dt = r dE` and the distance `r = 1 − e cos E`. The mean of the integrand at equally
    /// spaced anomalies converges as the exponential of their number.
    pub(super) fn steps_for_a_first_step_of_one(self) -> f64 {
        const PLACES: usize = 1 << 12;
        let e = self.eccentricity;
        let place = |i: usize| (1.0 - e * (TAU * i as f64 / PLACES as f64).cos()).powf(-0.5);
        let mean = (0..PLACES).map(place).sum::<f64>() / PLACES as f64;
        TAU * (1.0 - e).powf(1.5) * mean
    }
}

/// The length of the steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Steps {
    Fixed,
    Adaptive(StepControl),
}

impl Steps {
    pub(super) const ALL: [Steps; 4] = [
        Steps::Fixed,
        Steps::Adaptive(StepControl::Naive),
        Steps::Adaptive(StepControl::Symmetric),
        Steps::Adaptive(StepControl::Integrating),
    ];

    pub(super) fn name(self) -> &'static str {
        match self {
            Steps::Fixed => "fixed",
            Steps::Adaptive(control) => control.name(),
        }
    }

    pub(super) fn is_reversible_and_adaptive(self) -> bool {
        matches!(self, Steps::Adaptive(StepControl::Symmetric | StepControl::Integrating))
    }
}

/// The relative error of the energy in each period of a run.
#[derive(Clone, Debug)]
pub(super) struct EnergyErrors {
    /// Means over the time of each period.
    pub(super) means: Vec<f64>,
    /// The largest size in each period.
    pub(super) largest: Vec<f64>,
    /// Steps taken.
    pub(super) steps: u64,
    /// Whether all periods were run.
    pub(super) is_complete: bool,
}

/// Runs `periods` periods with about `steps` steps each.
pub(super) fn energy_errors(
    ellipse: Ellipse,
    steps: Steps,
    per_period: f64,
    periods: u64,
) -> EnergyErrors {
    let dynamics = Ellipse::dynamics();
    let start = ellipse.start();
    let most = (4.0 * per_period * periods as f64) as u64;
    let mut errors = Collector::new(periods);
    match steps {
        Steps::Fixed => {
            let step = StepProgram::new(METHOD, &dynamics);
            let mut stepper = ProgramStepper::<f64>::new(&step, &dynamics, &start);
            let dt = TAU / per_period;
            for number in 1..=most {
                let state = stepper.step(dt);
                if !errors.add(state, number as f64 * dt, dt) {
                    break;
                }
            }
        }
        Steps::Adaptive(control) => {
            let programs = AdaptivePrograms::new(&dynamics, METHOD);
            let dt = ellipse.steps_for_a_first_step_of_one() / per_period;
            let stepper = AdaptiveStepper::new(&programs, control, &start, dt);
            // Gravity has a frequency everywhere.
            let Some(mut stepper) = stepper else { return errors.finish() };
            for _ in 0..most {
                let went_on = stepper.advance().is_ok();
                if !went_on || !errors.add(stepper.state(), stepper.time(), stepper.last_length()) {
                    break;
                }
            }
        }
    }
    errors.finish()
}

/// Distances of a state from the start after as many steps there as back.
pub(super) fn return_error(ellipse: Ellipse, steps: Steps, per_period: f64, count: u64) -> f64 {
    distance_after_return(ellipse, steps, per_period, count, None)
}

/// The exponent of the grid of a motion that is reversible to the bits: coordinates below 2⁵³ of its spacings.
pub(super) const GRID: i32 = -44;

/// The same on a grid, from the start on the grid.
pub(super) fn return_error_on_grid(ellipse: Ellipse, per_period: f64, count: u64) -> f64 {
    let steps = Steps::Adaptive(StepControl::Integrating);
    distance_after_return(ellipse, steps, per_period, count, Some(GRID))
}

fn distance_after_return(
    ellipse: Ellipse,
    steps: Steps,
    per_period: f64,
    count: u64,
    grid: Option<i32>,
) -> f64 {
    let Steps::Adaptive(control) = steps else { return f64::NAN };
    let programs = AdaptivePrograms::new(&Ellipse::dynamics(), METHOD);
    let dt = ellipse.steps_for_a_first_step_of_one() / per_period;
    let stepper = AdaptiveStepper::new(&programs, control, &ellipse.start(), dt);
    let stepper = match grid {
        Some(exponent) => stepper.and_then(|stepper| stepper.on_grid(&programs, exponent)),
        None => stepper,
    };
    let Some(mut stepper) = stepper else { return f64::NAN };
    let start = stepper.state().to_vec();
    for _ in 0..2 {
        if (0..count).any(|_| stepper.advance().is_err()) {
            return f64::NAN;
        }
        stepper.reverse();
    }
    let pairs = stepper.state().iter().zip(&start);
    pairs.map(|(now, start)| (now - start).abs()).fold(0.0, f64::max)
}

/// Collects energy errors period by period.
struct Collector {
    periods: u64,
    errors: EnergyErrors,
    /// Of the period that is under way: the integral of the error over time, the time, and the largest size.
    now: (f64, f64, f64),
}

impl Collector {
    fn new(periods: u64) -> Self {
        let errors =
            EnergyErrors { means: Vec::new(), largest: Vec::new(), steps: 0, is_complete: false };
        Collector { periods, errors, now: (0.0, 0.0, 0.0) }
    }

    /// Adds the state after a step of a length. Returns whether the run goes on.
    fn add(&mut self, state: &[f64], time: f64, length: f64) -> bool {
        let [x, y, vx, vy] = *state else { return false };
        // The energy is −1/2.
        let error = (0.5 * (vx * vx + vy * vy) - x.hypot(y).recip() + 0.5) / 0.5;
        if !error.is_finite() {
            return false;
        }
        self.errors.steps += 1;
        let (integral, total, largest) = self.now;
        self.now = (integral + error * length, total + length, largest.max(error.abs()));
        if time >= TAU * (self.errors.means.len() as f64 + 1.0) {
            let (integral, total, largest) = std::mem::take(&mut self.now);
            self.errors.means.push(integral / total);
            self.errors.largest.push(largest);
            self.errors.is_complete = self.errors.means.len() as u64 >= self.periods;
        }
        !self.errors.is_complete
    }

    fn finish(self) -> EnergyErrors {
        self.errors
    }
}
