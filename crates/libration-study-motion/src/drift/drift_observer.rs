//! Observer of the energy drift of a long run.

use libration::simulation::Sample;
use libration_report::record::Series;
use libration_study::log_spaced_steps;

/// Samples of the running maximum for each decade of steps.
const PER_DECADE: f64 = 24.0;

/// Stretches in which the signed drift is kept.
const STRETCHES: u64 = 480;

/// Keeps the running maximum of the drift, its extremes in stretches of the horizon, and how far
/// it leaves its bounds.
pub(super) struct DriftObserver<B> {
    /// The lowest and highest drift that theory allows after `n` steps; monotone in `n`.
    bounds: B,
    steps: u64,
    stride: u64,
    sampled: Vec<u64>,
    stretch: (f64, f64),
    bound: (f64, f64),
    /// The largest drift, by absolute value.
    pub(super) largest: f64,
    /// The first step whose drift was not finite.
    pub(super) overflow: Option<u64>,
    /// Distance of the drift beyond its bounds, relative to 1 + |δE|; none without bounds.
    pub(super) excursion: Option<f64>,
    /// The running maximum at the sampled steps.
    running: Vec<f64>,
    /// Lowest and highest drift in stretches of the horizon.
    pub(super) signed: Signed,
}

impl<B: Fn(u64) -> (f64, f64)> DriftObserver<B> {
    pub(super) fn new(steps: u64, bounds: B) -> Self {
        DriftObserver {
            bound: bounds(0),
            bounds,
            steps,
            stride: steps.div_ceil(STRETCHES).max(1),
            sampled: log_spaced_steps(steps, PER_DECADE),
            stretch: (0.0, 0.0),
            largest: 0.0,
            overflow: None,
            excursion: None,
            running: Vec::new(),
            signed: Signed::default(),
        }
    }

    /// Takes note of one sample and its drift.
    pub(super) fn see(&mut self, sample: &Sample<f64, 1>, drift: f64) {
        let n = sample.step;
        if !drift.is_finite() {
            self.overflow.get_or_insert(n);
            return;
        }
        self.largest = self.largest.max(drift.abs());
        self.stretch = (self.stretch.0.min(drift), self.stretch.1.max(drift));
        if n.is_multiple_of(self.stride) || n == self.steps {
            self.end_stretch(sample, drift);
        }
        if self.sampled.get(self.running.len()) == Some(&n) {
            self.running.push(self.largest);
        }
    }

    fn end_stretch(&mut self, sample: &Sample<f64, 1>, drift: f64) {
        let ((low, high), begun) = (self.stretch, self.bound);
        // The bounds are monotone in n: within a stretch the looser end holds.
        let ended = (self.bounds)(sample.step);
        let beyond = (high - begun.1.max(ended.1)).max(begun.0.min(ended.0) - low);
        let beyond = beyond / (1.0 + high.max(-low));
        if beyond.is_finite() {
            self.excursion = Some(self.excursion.unwrap_or(0.0).max(beyond));
        }
        if sample.step > 0 {
            self.signed.push(sample.time, self.stretch, ended);
        }
        (self.stretch, self.bound) = ((drift, drift), ended);
    }

    /// The sampled steps, and the running maximum there; NaN where the run had overflowed.
    pub(super) fn running(&self) -> (Vec<u64>, Vec<f64>) {
        let mut running = self.running.clone();
        running.resize(self.sampled.len(), f64::NAN);
        (self.sampled.clone(), running)
    }
}

/// Lowest and highest drift in stretches of the horizon.
#[derive(Clone, Debug, Default)]
pub(super) struct Signed {
    time: Vec<f64>,
    low: Vec<f64>,
    high: Vec<f64>,
    bound_low: Vec<f64>,
    bound_high: Vec<f64>,
}

impl Signed {
    fn push(&mut self, time: f64, (low, high): (f64, f64), bound: (f64, f64)) {
        self.time.push(time);
        self.low.push(low);
        self.high.push(high);
        self.bound_low.push(bound.0);
        self.bound_high.push(bound.1);
    }

    /// As a series.
    pub(super) fn to_series(&self, name: String) -> Series {
        Series::new(name)
            .with("t", "s", self.time.clone())
            .with("low", "1", self.low.clone())
            .with("high", "1", self.high.clone())
            .with("bound_low", "1", self.bound_low.clone())
            .with("bound_high", "1", self.bound_high.clone())
    }
}
