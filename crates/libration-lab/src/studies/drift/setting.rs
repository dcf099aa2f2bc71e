//! One integrator at one time step, and the rounding that its run may carry.

use libration::simulation::{EnergyDrift, Sample, Simulator};
use libration::system::Oscillator;
use libration::{Method, Model, State, with_method};

use crate::Config;
use crate::studies::rounding::rounding_of_run;
use crate::study::StudyError;

/// Where the bound of [`Setting::rounding`] comes from, for the reader.
pub(super) const ROUNDING: &str =
    "12 eᶻ roundings a step, added up as independent ones unless they are biased";

/// What is run.
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
            steps: config.drift.steps,
            oscillator: config.oscillator.system(),
            start: State { q: [config.start.q], v: [config.start.v] },
        }
    }

    /// The relative error that rounding may leave in an energy at the end.
    pub(super) fn rounding(&self) -> f64 {
        rounding_of_run(self.method, self.oscillator.omega2.sqrt(), self.dt, self.steps)
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
