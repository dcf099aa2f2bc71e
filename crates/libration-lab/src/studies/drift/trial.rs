//! One integrator at one time step, for the whole horizon.

use libration::analysis::{EnergyBand, Linearisation, Spectrum, UpdateMatrix, forecast_drift};
use libration::number::Wide;
use libration::simulation::{EnergyDrift, Sample, Simulator};
use libration::system::Oscillator;
use libration::{Hamiltonian, Method, Model, Scalar, State, with_method};

use super::tag;
use crate::Config;
use crate::notation::{number, power_of_ten};
use crate::record::Series;
use crate::studies::rounding::path_of_unit_step;
use crate::study::StudyError;

/// Samples of the running maximum for each decade of steps.
const PER_DECADE: f64 = 24.0;

/// Buckets of the signed drift along the horizon.
const BUCKETS: u64 = 480;

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

    /// `ωΔt`, summed over the sizes of the substeps of a step.
    pub(super) fn path(&self) -> f64 {
        self.oscillator.omega2.sqrt() * self.dt * path_of_unit_step(self.method)
    }

    fn simulate(
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

/// What one setting gave, and what was to be expected.
#[derive(Clone, Debug)]
pub(super) struct Trial {
    pub(super) setting: Setting,
    /// Decimal logarithms of the largest drift.
    pub(super) predicted_log10: f64,
    pub(super) measured_log10: f64,
    measured: f64,
    predicted: f64,
    /// Running maximum of the drift at the sampled steps.
    pub(super) running: Vec<f64>,
    /// The envelope's value there.
    pub(super) predicted_running: Vec<f64>,
    /// How far the drift leaves the envelope, relative to 1 + |δE|.
    pub(super) excursion: f64,
    /// When the energy overflowed, if it did.
    pub(super) overflow: Option<Overflow>,
    /// The worst start; none if all starts are alike.
    pub(super) worst: Option<Worst>,
    signed: Signed,
}

/// The step at which the energy left the range of `f64`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Overflow {
    pub(super) predicted: u64,
    pub(super) measured: u64,
}

/// A run from the start that drifts most.
#[derive(Clone, Copy, Debug)]
pub(super) struct Worst {
    pub(super) start: State<f64, 1>,
    pub(super) predicted: f64,
    pub(super) measured: f64,
}

/// Lowest and highest drift in stretches of the horizon.
#[derive(Clone, Debug, Default)]
struct Signed {
    time: Vec<f64>,
    low: Vec<f64>,
    high: Vec<f64>,
    bound_low: Vec<f64>,
    bound_high: Vec<f64>,
}

impl Trial {
    pub(super) fn run(setting: &Setting) -> Result<Self, StudyError> {
        let Setting { method, dt, steps, oscillator, start } = *setting;
        let linear = with_method!(method, |m| Linearisation::new(m, oscillator, &start, dt));
        let band = EnergyBand::new(oscillator, &linear.step);
        let angle = Spectrum::new(&linear.step).angle().to_f64();
        let bounds = |n: u64| match &band {
            Some(band) => band.drift_after(&start, n),
            None => (f64::NEG_INFINITY, f64::INFINITY),
        };
        let sampled = sampled_steps(steps);
        let stride = steps.div_ceil(BUCKETS).max(1);
        let (mut largest, mut overflow, mut excursion) = (0.0_f64, None, 0.0_f64);
        let (mut running, mut signed) = (Vec::new(), Signed::default());
        let mut bucket = (0.0_f64, 0.0_f64);
        let mut bound = bounds(0);
        setting.simulate(start, |sample, drift| {
            let n = sample.step;
            if !drift.is_finite() {
                overflow.get_or_insert(n);
                return;
            }
            largest = largest.max(drift.abs());
            bucket = (bucket.0.min(drift), bucket.1.max(drift));
            if n % stride == 0 || n == steps {
                // The bounds are monotone in n: within a stretch the looser end holds.
                let end = bounds(n);
                let beyond = (bucket.1 - bound.1.max(end.1)).max(bound.0.min(end.0) - bucket.0);
                excursion = excursion.max(beyond / (1.0 + drift.abs()));
                bound = end;
                if n > 0 {
                    signed.push(sample.time, bucket, bound);
                }
                bucket = (drift, drift);
            }
            if running.len() < sampled.len() && sampled[running.len()] == n {
                running.push(largest);
            }
        })?;
        running.resize(sampled.len(), f64::NAN);
        // A band that depends on the phase is filled after half a turn.
        let filled = match band.and_then(|band| band.worst_start()) {
            Some(_) => (std::f64::consts::PI / angle).ceil() as u64,
            None => 0,
        };
        let predicted_running =
            sampled.iter().map(|&n| if n < filled { f64::NAN } else { size(bounds(n)) }).collect();
        let forecast = forecast_drift(oscillator, &linear.step, &start, steps);
        let predicted = forecast.map_or(0.0, |f| f.drift.to_f64());
        let predicted_log10 = forecast.map_or(f64::NEG_INFINITY, |f| f.drift.log10().to_f64());
        let worst = band.and_then(|band| {
            let start = band.worst_start()?;
            let worst = forecast_drift(oscillator, &linear.step, &start, steps)?;
            let mut measured = 0.0_f64;
            setting.simulate(start, |_, drift| measured = measured.max(drift.abs())).ok()?;
            let predicted = worst.drift.to_f64();
            Some(Worst { start, predicted, measured })
        });
        let overflow = overflow.map(|measured| Overflow {
            predicted: predicted_overflow(oscillator, &linear.step, &start, measured),
            measured,
        });
        Ok(Trial {
            setting: *setting,
            predicted_log10,
            measured_log10: largest.log10(),
            measured: largest,
            predicted,
            running,
            predicted_running,
            excursion,
            overflow,
            worst,
            signed,
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

    /// A drift given by its logarithm, in words where `f64` cannot hold it.
    pub(super) fn shown(&self, log10: f64) -> String {
        match (self.overflow, log10 > 308.0) {
            (_, true) => power_of_ten(log10, 3),
            (Some(overflow), _) if log10 == self.measured_log10 => {
                format!("leaves f64 at step {}", crate::notation::count(overflow.measured))
            }
            _ => number(10_f64.powf(log10), 7),
        }
    }

    /// Measured minus predicted, in words.
    pub(super) fn difference(&self) -> String {
        match self.overflow {
            Some(overflow) => {
                let late = overflow.measured as f64 - overflow.predicted as f64;
                format!("{} steps", number(late, 2))
            }
            None => number(self.measured - self.predicted, 2),
        }
    }

    /// The steps at which the running maximum was taken.
    pub(super) fn sampled_steps(&self) -> Vec<f64> {
        sampled_steps(self.setting.steps).into_iter().map(|n| n as f64).collect()
    }

    /// The signed drift along the horizon, with its bounds.
    pub(super) fn signed_series(&self) -> Series {
        let signed = self.signed.clone();
        Series::new(format!("{}-{}", self.setting.method.name(), tag(self.setting.dt)))
            .with("t", "s", signed.time)
            .with("low", "1", signed.low)
            .with("high", "1", signed.high)
            .with("bound_low", "1", signed.bound_low)
            .with("bound_high", "1", signed.bound_high)
    }
}

impl Signed {
    fn push(&mut self, time: f64, (low, high): (f64, f64), bound: (f64, f64)) {
        self.time.push(time);
        self.low.push(low);
        self.high.push(high);
        self.bound_low.push(bound.0);
        self.bound_high.push(bound.1);
    }
}

/// The first step at which a term of the drift is too large for `f64`, by the exact orbit.
///
/// Twice the energy, that over ω² and that over E₀ bound all of `v²`, `q²`, `ω²q²`, E and E/E₀. They grow with the
/// energy of an unstable orbit, so the first step that could overflow is found by bisection, and
/// the first that does, by walking on from it; `about` bounds the search.
fn predicted_overflow(
    oscillator: Oscillator<f64>,
    step: &UpdateMatrix<Wide, 1>,
    start: &State<f64, 1>,
    about: u64,
) -> u64 {
    let (system, start) = (Model::<1>::on::<Wide>(&oscillator), start.map(Wide::from_f64));
    let most = Wide::from_f64(f64::MAX);
    let after = |n: u64| step.power(n).apply(&start);
    let initial = Hamiltonian::<Wide, 1>::energy(&system, &start);
    let could = |state: &State<Wide, 1>| {
        let twice = Hamiltonian::<Wide, 1>::energy(&system, state) * Wide::from_f64(2.0);
        [twice, twice / system.omega2, twice / initial].iter().any(|&bound| bound > most)
    };
    let does = |state: &State<Wide, 1>| {
        let (q2, v2) = (state.q[0] * state.q[0], state.v[0] * state.v[0]);
        let total = Hamiltonian::<Wide, 1>::energy(&system, state);
        let drift = (total - initial) / initial;
        [q2, v2, system.omega2 * q2, total, drift].iter().any(|&term| term > most)
    };
    let limit = about.saturating_mul(2);
    let (mut low, mut high) = (0, limit);
    while low < high {
        let middle = low + (high - low) / 2;
        if could(&after(middle)) { high = middle } else { low = middle + 1 }
    }
    let mut state = after(low);
    while !does(&state) && low < limit {
        state = step.apply(&state);
        low += 1;
    }
    low
}

/// The larger of two bounds by absolute value.
fn size((low, high): (f64, f64)) -> f64 {
    low.abs().max(high.abs())
}

/// Steps from 1 to `last`, evenly spaced in their logarithm, each once.
fn sampled_steps(last: u64) -> Vec<u64> {
    let decades = (last as f64).log10();
    let count = (decades * PER_DECADE).ceil().max(1.0) as u64;
    let mut steps: Vec<u64> = (0..=count)
        .map(|i| 10_f64.powf(decades * i as f64 / count as f64).round() as u64)
        .collect();
    steps.dedup();
    steps
}
