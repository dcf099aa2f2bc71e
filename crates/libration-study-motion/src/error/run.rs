//! One integrator compared with the exact solution.

use libration::analysis::{ErrorForecast, UpdateMatrix};
use libration::number::{TwoFloat, Wide};
use libration::simulation::{Sample, Simulator};
use libration::system::Oscillator;
use libration::{Elementary, Float, Method, Model, Scalar, State, with_method};
use libration_study::{StudyError, log_spaced_steps};

use super::mean::SumOfSquares;
use crate::rounding::rounding_of_run;

/// Samples of the running error for each decade of steps.
const PER_DECADE: f64 = 16.0;

/// Integrator and time step of a run.
#[derive(Clone, Copy, Debug)]
pub(super) struct Setting {
    pub(super) method: Method,
    pub(super) oscillator: Oscillator<f64>,
    pub(super) start: State<f64, 1>,
    pub(super) dt: f64,
    pub(super) steps: u64,
}

/// Errors in position, in m, at as many instants as steps are taken, from the start on: of the state
/// there, and of the state one step later beside the same solution.
#[derive(Clone, Copy, Debug)]
pub(super) struct Errors {
    pub(super) aligned: f64,
    pub(super) late: f64,
}

/// A finished run.
pub(super) struct Run {
    pub(super) setting: Setting,
    /// None where the step does not oscillate.
    pub(super) forecast: Option<ErrorForecast>,
    /// Root mean squares over all instants.
    pub(super) rms: Errors,
    /// The aligned error after the last step.
    pub(super) last: f64,
    /// Steps at which the running errors were taken, and these.
    pub(super) sampled: Vec<u64>,
    pub(super) running: Vec<Errors>,
    /// Largest `|x|` of the run.
    pub(super) amplitude: f64,
    /// Whether the run stayed within `f64`.
    pub(super) finished: bool,
}

impl Setting {
    /// The forecast of the shipped step.
    pub(super) fn forecast(&self) -> Option<ErrorForecast> {
        let Setting { method, oscillator, start, dt, .. } = *self;
        let step = UpdateMatrix::of_step(method, oscillator, &start, dt);
        ErrorForecast::new(oscillator, &step, dt, &start)
    }

    /// The error in m that rounding may leave in a position, for an orbit of this amplitude.
    ///
    /// The run rounds as any other; and the coefficients of a step are rounded once for all steps,
    /// which turns the orbit by 8 roundings of the angle `ωt`.
    pub(super) fn rounding(&self, amplitude: f64) -> f64 {
        let omega = self.oscillator.omega2.sqrt();
        let angle = omega * self.dt * self.steps as f64;
        let run = rounding_of_run(self.method, omega, self.dt, self.steps);
        amplitude * (run + 8.0 * f64::UNIT_ROUNDOFF * angle)
    }

    /// Simulates in `f64`, beside an exact solution in double-double.
    pub(super) fn run(&self) -> Result<Run, StudyError> {
        let sampled = log_spaced_steps(self.steps, PER_DECADE);
        let mut watch = ErrorObserver::new(self, &sampled);
        let system = Model::<1>::on::<f64>(&self.oscillator);
        let finished = with_method!(self.method, |m| {
            let mut simulator = Simulator::new(system, m, self.start, self.dt)?;
            // Leaving the range of f64 is a result; what was seen until then is kept.
            simulator.run(self.steps, &mut |sample: &Sample<f64, 1>| watch.see(sample)).is_ok()
        });
        let ErrorObserver { aligned, late, running, last, amplitude, .. } = watch;
        let rms = root_mean(aligned, late, self.steps);
        let forecast = self.forecast();
        Ok(Run { setting: *self, forecast, rms, last, sampled, running, amplitude, finished })
    }
}

/// Follows a run beside the exact solution.
struct ErrorObserver<'a> {
    /// The exact flow of one step.
    rotation: UpdateMatrix<TwoFloat>,
    exact: State<TwoFloat, 1>,
    sampled: &'a [u64],
    aligned: SumOfSquares,
    late: SumOfSquares,
    running: Vec<Errors>,
    last: f64,
    amplitude: f64,
}

impl<'a> ErrorObserver<'a> {
    fn new(setting: &Setting, sampled: &'a [u64]) -> Self {
        ErrorObserver {
            rotation: rotation(setting.oscillator, setting.dt),
            exact: setting.start.map(TwoFloat::from_f64),
            sampled,
            aligned: SumOfSquares::default(),
            late: SumOfSquares::default(),
            running: Vec::new(),
            last: 0.0,
            amplitude: 0.0,
        }
    }

    fn see(&mut self, sample: &Sample<f64, 1>) {
        let [x] = sample.state.q;
        self.amplitude = self.amplitude.max(x.abs());
        if sample.step == 0 {
            return;
        }
        let difference = |exact: &State<TwoFloat, 1>| (TwoFloat::from_f64(x) - exact.q[0]).to_f64();
        self.aligned.add(self.last);
        let late = difference(&self.exact);
        self.exact = self.rotation.apply(&self.exact);
        self.last = difference(&self.exact);
        self.late.add(late);
        if self.sampled.get(self.running.len()) == Some(&sample.step) {
            self.running.push(root_mean(self.aligned, self.late, sample.step));
        }
    }
}

/// The exact flow over `dt` as a matrix.
fn rotation(oscillator: Oscillator<f64>, dt: f64) -> UpdateMatrix<TwoFloat> {
    let omega = Wide::from_f64(oscillator.omega2).sqrt();
    let (sin, cos) = (omega * Wide::from_f64(dt)).sin_cos();
    let two = TwoFloat::from;
    UpdateMatrix {
        dq: State { q: [two(cos)], v: [two(-omega * sin)] },
        dv: State { q: [two(sin / omega)], v: [two(cos)] },
    }
}

fn root_mean(aligned: SumOfSquares, late: SumOfSquares, steps: u64) -> Errors {
    Errors { aligned: aligned.root_mean(steps), late: late.root_mean(steps) }
}
