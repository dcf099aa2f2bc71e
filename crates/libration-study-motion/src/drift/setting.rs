//! One integrator at one time step, with bounds on rounding.

use libration::analysis::DriftForecast;
use libration::simulation::{EnergyDrift, Sample, Simulator};
use libration::system::Oscillator;
use libration::{Method, Model, State, with_method};
use libration_study::{Config, StudyError};

use crate::drift::DriftSettings;
use crate::rounding::{rounding_of_run, slip_of_run};

/// Explanation of the bound [`Setting::rounding`], for the page.
pub(super) const ROUNDING: &str = "eᶻ(12√n + s·n) roundings, with s = z/10 for products of shears and z² \
                                   for others, times the condition of the eigenvectors";

/// Explanation of the bound [`Setting::uncertainty`].
pub(super) const UNCERTAINTY: &str = "eᶻ(12√n + s·n) roundings, with s = z/10 for products of shears and z² for others, times the \
     condition of the eigenvectors; and what the slip of the phase changes where the orbit does not \
     reach the edge of its band";

/// Integrator and time step of a run.
#[derive(Clone, Copy, Debug)]
pub(super) struct Setting {
    pub(super) method: Method,
    pub(super) dt: f64,
    pub(super) steps: u64,
    pub(super) oscillator: Oscillator<f64>,
    pub(super) start: State<f64, 1>,
}

impl Setting {
    pub(super) fn new(config: &Config, method: Method, dt: f64) -> Self {
        Setting {
            method,
            dt,
            steps: config.get::<DriftSettings>().steps,
            oscillator: config.oscillator.system(),
            start: State { q: [config.start.q], v: [config.start.v] },
        }
    }

    /// The relative error that rounding may leave in an energy at the end.
    pub(super) fn rounding(&self) -> f64 {
        rounding_of_run(self.method, self.oscillator.omega2.sqrt(), self.dt, self.steps)
    }

    /// The absolute error that rounding may leave in a largest drift that is predicted for an orbit
    /// within a band of drifts.
    ///
    /// Where the orbit fills its band, a slip of the phase does not change the largest drift. Where it
    /// closes after a few points, or has not come round yet, it stays off the edge by a gap
    /// `g = W·sin²α`, with `W` the width of the band and `α` the phase that is missing, and a slip `Φ`
    /// changes it by up to `W(sin²(α + Φ) − sin²α) ≤ 2√(g(W − g))·Φ + W·Φ²`. Beyond the steps that a
    /// forecast searches one by one, the orbit may come closer by all of the gap.
    pub(super) fn uncertainty(&self, predicted: f64, band: Option<(f64, f64)>) -> f64 {
        let rounding = self.rounding() * (1.0 + predicted);
        let Some((low, high)) = band else { return rounding };
        let (width, edge) = (high - low, low.abs().max(high.abs()));
        let gap = (edge - predicted).max(0.0);
        let sooner = gap.min(0.5 * width);
        let slip = slip_of_run(self.method, self.oscillator.omega2.sqrt(), self.dt, self.steps);
        let moved = (2.0 * (sooner * (width - sooner)).sqrt() + width * slip) * slip;
        let later = if self.steps > DriftForecast::SEARCHED { gap } else { 0.0 };
        rounding + moved.min(width) + later
    }

    /// Simulates from `start`; `watch` sees each sample with its relative drift.
    pub(super) fn simulate(
        &self,
        start: State<f64, 1>,
        mut watch: impl FnMut(&Sample<f64, 1>, f64),
    ) -> Result<(), StudyError> {
        let system = Model::<1>::on::<f64>(&self.oscillator);
        let drift = EnergyDrift::new(system, &start);
        let mut observer = |sample: &Sample<f64, 1>| watch(sample, drift.of(&sample.state));
        with_method!(self.method, |m| {
            let mut simulator = Simulator::new(system, m, start, self.dt)?;
            // An overflow is a result: what was observed until then tells when it happened.
            simulator.run(self.steps, &mut observer).ok();
        });
        Ok(())
    }
}
