//! One integrator at one time step, for the whole horizon.

use libration::State;
use libration::analysis::{EnergyBand, Spectrum, UpdateMatrix, forecast_drift};
use libration_report::notation::{count, number, power_of_ten};
use libration_report::record::{Cell, Series};
use libration_study::StudyError;

use super::drift_observer::{DriftObserver, Signed};
use super::invariant::Invariant;
use super::overflow::Overflow;
use super::setting::Setting;
use super::tag;

/// Predicted and measured result of one setting.
#[derive(Clone, Debug)]
pub(super) struct DriftRun {
    pub(super) setting: Setting,
    /// Decimal logarithm of the predicted largest drift, which `f64` may not hold.
    pub(super) predicted_log10: f64,
    measured: f64,
    predicted: f64,
    /// Steps at which the running maximum was taken.
    sampled: Vec<u64>,
    /// Running maximum of the drift there.
    pub(super) running: Vec<f64>,
    /// The envelope's value there.
    pub(super) predicted_running: Vec<f64>,
    /// Distance of the drift beyond the envelope, relative to 1 + |δE|.
    pub(super) excursion: Option<f64>,
    /// Change of the invariant of a symplectic step; none without a definite invariant.
    pub(super) invariant: Option<f64>,
    /// Lowest and highest drift of an orbit whose drift depends on its phase.
    pub(super) band: Option<(f64, f64)>,
    /// When the energy overflowed, if it did.
    pub(super) overflow: Option<Overflow>,
    /// The worst start; none if all starts are alike.
    pub(super) worst: Option<Worst>,
    signed: Signed,
}

/// A run from the start that drifts most.
#[derive(Clone, Copy, Debug)]
pub(super) struct Worst {
    pub(super) start: State<f64, 1>,
    pub(super) predicted: f64,
    pub(super) measured: f64,
    pub(super) band: Option<(f64, f64)>,
}

impl DriftRun {
    pub(super) fn run(setting: &Setting) -> Result<Self, StudyError> {
        let Setting { method, dt, steps, oscillator, start } = *setting;
        let step = UpdateMatrix::of_step(method, oscillator, &start, dt);
        let band = EnergyBand::new(oscillator, &step);
        let spectrum = Spectrum::new(&step);
        let angle = spectrum.angle().to_f64();
        let keeps_areas = spectrum.determinant_minus_one().is_zero();
        let bounds = |n: u64| match &band {
            Some(band) => band.drift_after(&start, n),
            None => (f64::NEG_INFINITY, f64::INFINITY),
        };
        let mut watch = DriftObserver::new(steps, bounds);
        let mut invariant =
            band.filter(|_| keeps_areas).map(|_| Invariant::new(&step, &start, steps));
        setting.simulate(start, |sample, drift| {
            watch.see(sample, drift);
            invariant.iter_mut().for_each(|invariant| invariant.see(sample));
        })?;
        let (sampled, running) = watch.running();
        // A band that depends on the phase is filled after half a turn.
        let phased = band.filter(|band| keeps_areas && band.worst_start().is_some());
        let filled = phased.map_or(0, |_| (std::f64::consts::PI / angle).ceil() as u64);
        let size = |n: u64| {
            let (low, high) = bounds(n);
            low.abs().max(high.abs())
        };
        let predicted_running =
            sampled.iter().map(|&n| if n < filled { f64::NAN } else { size(n) }).collect();
        let forecast = forecast_drift(oscillator, &step, &start, steps);
        let predicted = forecast.map_or(0.0, |f| f.drift.to_f64());
        let predicted_log10 = forecast.map_or(f64::NEG_INFINITY, |f| f.drift.log10().to_f64());
        let worst = band.and_then(|band| {
            let start = band.worst_start()?;
            let worst = forecast_drift(oscillator, &step, &start, steps)?;
            let mut measured = 0.0_f64;
            setting.simulate(start, |_, drift| measured = measured.max(drift.abs())).ok()?;
            let predicted = worst.drift.to_f64();
            let band = phased.map(|band| band.drift_after(&start, 0));
            Some(Worst { start, predicted, measured, band })
        });
        let overflow =
            watch.overflow.map(|measured| Overflow::new(measured, oscillator, &step, &start));
        Ok(DriftRun {
            setting: *setting,
            predicted_log10,
            measured: watch.largest,
            predicted,
            sampled,
            running,
            predicted_running,
            excursion: watch.excursion,
            invariant: invariant.map(|invariant| invariant.largest),
            band: phased.map(|band| band.drift_after(&start, 0)),
            overflow,
            worst,
            signed: watch.signed,
        })
    }

    /// Largest drift as predicted.
    pub(super) fn predicted(&self) -> f64 {
        self.predicted
    }

    /// Largest drift as measured, up to an overflow.
    pub(super) fn measured(&self) -> f64 {
        self.measured
    }

    /// The predicted drift for a table; no number where `f64` cannot hold it.
    pub(super) fn predicted_cell(&self) -> Cell {
        match self.predicted_log10 > 308.0 {
            true => Cell::absent(power_of_ten(self.predicted_log10, 3)),
            false => Cell::rounded(self.predicted, 7),
        }
    }

    /// The measured drift for a table; no number if the run left the range of `f64`.
    pub(super) fn measured_cell(&self) -> Cell {
        match self.overflow {
            Some(overflow) => {
                Cell::absent(format!("leaves f64 at step {}", count(overflow.measured)))
            }
            None => Cell::rounded(self.measured, 7),
        }
    }

    /// Measured minus predicted; of overflows, which are compared by their steps, in words.
    pub(super) fn difference(&self) -> Cell {
        match self.overflow {
            Some(overflow) => {
                let late = overflow.measured as f64 - overflow.predicted as f64;
                Cell::absent(format!("{} steps", number(late, 2)))
            }
            None => Cell::rounded(self.measured - self.predicted, 2),
        }
    }

    /// The steps at which the running maximum was taken.
    pub(super) fn log_spaced_steps(&self) -> Vec<f64> {
        self.sampled.iter().map(|&n| n as f64).collect()
    }

    /// The signed drift along the horizon, with its bounds.
    pub(super) fn signed_series(&self) -> Series {
        self.signed.to_series(format!("{}-{}", self.setting.method.name(), tag(self.setting.dt)))
    }
}
