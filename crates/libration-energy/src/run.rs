//! What a single run shows of its energy.

use core::f64::consts::PI;

use serde::Serialize;

use crate::batches::Batches;
use crate::estimate::{NORMAL_95, NORMAL_FINDING, student};
use crate::fluctuation::Fluctuation;
use crate::local_level::LocalLevel;
use crate::periods::Periods;
use crate::single_precision::{is_single_precision, quantum};
use crate::{EnergyTrace, Estimate, Walk};

/// Relative change of an energy from which its growth may be exponential.
const GROWS: f64 = 1e-3;
/// Part of a drift below which a fluctuation may be a curvature of the drift.
const CURVED: f64 = 1e-3;
/// Distances of stored energies below which a fluctuation is rounding of the energy.
const COARSE: f64 = 8.0;
/// The same for energies in single precision, relative to the energy: sums of up to 10⁴ terms with random errors of 2⁻²⁴.
const SINGLE: f64 = 6e-6;
/// How much better an exponential must fit than a line.
const BETTER: f64 = 4.0;
/// Part of a sampling interval within which times are equidistant.
const EQUIDISTANT: f64 = 0.01;

/// A run: the parts of its energy.
#[derive(Clone, Debug, Serialize)]
pub struct Run {
    /// Name of the run.
    pub title: String,
    /// Time step in s.
    pub dt: f64,
    /// Number of samples.
    pub samples: usize,
    /// Duration in s.
    pub duration: f64,
    /// Number of time steps.
    pub steps: f64,
    /// Energy of the first sample.
    pub energy_at_start: f64,
    /// Largest absolute energy.
    pub largest_energy: f64,
    /// Standard deviation of the fluctuation about the drift, without a random walk. A run of fewer than about 50 memories has no
    /// interval: 0 to infinity, `null` in JSON.
    pub oscillation: Estimate,
    /// Largest deviation from the drift.
    pub largest_deviation: f64,
    /// Largest deviation from the energy at the start.
    pub deviation_from_start: f64,
    /// Drift rate per second: the change over the run by its duration, or at the start of an exponential growth.
    pub drift_rate: Estimate,
    /// Half of the width of the interval that holds but for 10⁻⁴.
    #[serde(skip)]
    pub(crate) finding_width: f64,
    /// Whether the energy grows exponentially.
    pub is_exponential: bool,
    /// Random walk; none where the fit fails.
    pub walk: Option<Walk>,
    /// Integrated autocorrelation time of the fluctuation in s, by the variance of batch means; none under a random walk.
    pub correlation_time: Option<f64>,
    /// Smallest change of the energy from sample to sample.
    pub resolution: f64,
    /// Whether all energies are numbers of single precision.
    pub is_single_precision: bool,
    /// Whether samples are equidistant.
    pub is_equidistant: bool,
    /// The longest time without samples in s, from and to, if most samples are at equal distances.
    pub gap: Option<[f64; 2]>,
}

impl Run {
    /// The parts of the energy of a trace. None if squares of its energies or times overflow.
    pub(crate) fn of(trace: &EnergyTrace) -> Option<Self> {
        let start = *trace.energies.first()?;
        // Digits that all energies share would be lost in squares.
        let energies: Vec<f64> = trace.energies.iter().map(|energy| energy - start).collect();
        let fine = Batches::of(&trace.times, Periods::of(&energies).most_batches());
        let (_, residuals) = Trend::fit(trace, &energies, &fine)?;
        let periods = Periods::of(&residuals);
        let fine_means = fine.means(&energies);
        let kept = Periods::of(&fine.centred(&residuals)).leakage(fine.count());
        let walk = Walk::of(&fine, &fine_means, kept);
        let present = walk.as_ref().filter(|walk| walk.is_present);
        // A walk has no period.
        let is_possible = walk.as_ref().is_some_and(|walk| walk.is_possible);
        let batches = match is_possible {
            true => fine,
            false => Batches::of(&trace.times, periods.batch_count()),
        };
        let (trend, residuals) = Trend::fit(trace, &energies, &batches)?;
        let duration = trace.duration();
        let resolution = quantum(&trace.energies);
        // A change of less than the distance of stored numbers is not seen, nor that of a slow beat of the oscillation with the batches:
        // half a period of it over the run is a line of 12/π² times twice its amplitude.
        let leakage = if present.is_some() { 0.0 } else { periods.leakage(batches.count()) };
        let unseen = (resolution + 24.0 / (PI * PI) * leakage) / duration;
        let width = |z: f64| student(z, trend.degrees_of_freedom) * trend.error + unseen;
        let possible = walk.as_ref().filter(|walk| walk.is_possible);
        let fluctuation = Fluctuation::of(
            &batches,
            &residuals,
            possible,
            duration,
            trend.rate.abs() > width(NORMAL_FINDING),
        );
        let spacing = trace.spacing();
        let run = Run {
            title: trace.title.clone(),
            dt: trace.step(),
            samples: energies.len(),
            duration,
            steps: duration / trace.step(),
            energy_at_start: start,
            largest_energy: trace.energies.iter().fold(0.0, |most, energy| most.max(energy.abs())),
            largest_deviation: residuals
                .iter()
                .fold(0.0, |most, x| most.max((x - residuals[0]).abs())),
            deviation_from_start: energies.iter().fold(0.0, |most, x| most.max(x.abs())),
            correlation_time: fluctuation.correlation_time,
            oscillation: fluctuation.oscillation,
            drift_rate: Estimate::symmetric(trend.rate, width(NORMAL_95)),
            finding_width: width(NORMAL_FINDING),
            is_exponential: trend.is_exponential,
            walk,
            resolution,
            is_single_precision: is_single_precision(&trace.energies),
            gap: trace.gap(),
            is_equidistant: trace
                .times
                .windows(2)
                .all(|pair| ((pair[1] - pair[0]) / spacing - 1.0).abs() < EQUIDISTANT),
        };
        let Estimate { value, low, high } = run.drift_rate;
        let known = [run.oscillation.value, value, low, high];
        known.into_iter().all(f64::is_finite).then_some(run)
    }

    /// Whether the drift is no noise, at the level of findings.
    pub(crate) fn drifts(&self) -> bool {
        self.drift_rate.value.abs() > self.finding_width
    }

    /// Changes of the energy that its digits and its rounding explain: in double precision one rounding per step adds up as a walk.
    pub(crate) fn rounding(&self) -> f64 {
        let walk = f64::EPSILON * self.largest_energy * self.steps.sqrt();
        let single = if self.is_single_precision { SINGLE * self.largest_energy } else { 0.0 };
        (COARSE * self.resolution.max(walk)).max(single)
    }

    /// Whether the energies have enough digits for their fluctuation.
    pub(crate) fn resolves_oscillation(&self) -> bool {
        let drift = self.drift_rate.value.abs() * self.duration;
        self.oscillation.value > self.rounding()
            && !(self.drifts() && self.oscillation.value < CURVED * drift)
    }

    /// Whether the run is too short for an interval of its oscillation.
    pub(crate) fn has_unclear_oscillation(&self) -> bool {
        self.oscillation.high.is_infinite()
    }

    /// The walk, if it is present.
    pub(crate) fn present_walk(&self) -> Option<&Walk> {
        self.walk.as_ref().filter(|walk| walk.is_present)
    }
}

/// The trend of an energy.
struct Trend {
    /// Rate per second, at the start of an exponential.
    rate: f64,
    error: f64,
    degrees_of_freedom: usize,
    is_exponential: bool,
}

impl Trend {
    /// The trend by batch means, and the residuals of the energies less that of the start.
    fn fit(trace: &EnergyTrace, energies: &[f64], batches: &Batches) -> Option<(Self, Vec<f64>)> {
        let (start, first_time) = (trace.energies.first()?, trace.times.first()?);
        let line = LocalLevel::fit(&batches.times, &batches.means(energies), 2)?;
        let (first, last) = (batches.times.first()?, batches.times.last()?);
        let (middle, span) = ((first + last) / 2.0, last - first);
        let growth = exponential(trace, batches, &line);
        let fit = growth.unwrap_or(line);
        let at = |t: f64| match fit.middle + fit.change * (t - middle) / span {
            exponent if growth.is_some() => start.signum() * exponent.exp() - start,
            value => value,
        };
        let factor = if growth.is_some() { at(*first_time) + start } else { 1.0 };
        let trend = Trend {
            rate: factor * fit.change / span,
            error: (factor * fit.standard_error / span).abs(),
            degrees_of_freedom: fit.degrees_of_freedom,
            is_exponential: growth.is_some(),
        };
        let residuals = trace.times.iter().zip(energies).map(|(t, energy)| energy - at(*t));
        Some((trend, residuals.collect()))
    }
}

/// The trend of the logarithm of the energy, where it fits far better than a line.
fn exponential(trace: &EnergyTrace, batches: &Batches, line: &LocalLevel) -> Option<LocalLevel> {
    let sign = trace.energies[0].signum();
    if trace.energies.iter().any(|energy| energy * sign <= 0.0) {
        return None;
    }
    let logarithms: Vec<f64> = trace.energies.iter().map(|energy| energy.abs().ln()).collect();
    let growth = LocalLevel::fit(&batches.times, &batches.means(&logarithms), 2)?;
    let mean =
        trace.energies.iter().map(|energy| energy.abs()).sum::<f64>() / trace.energies.len() as f64;
    let relative = |fit: &LocalLevel| fit.white + fit.walk.value;
    let is_better = relative(line) / (mean * mean) > BETTER * relative(&growth);
    (growth.change.abs() > GROWS && is_better).then_some(growth)
}
