//! The largest time step for a tolerance over a horizon.

use libration_report::notation::number;
use serde::Serialize;

use crate::estimate::NORMAL_95;
use crate::slow_change::SlowChange;
use crate::{DriftCause, Estimate, OscillationCause, Run, TraceError, WalkCause};

/// How far below the shortest step laws are continued.
const SHORTER: f64 = 1e-3;
/// Ratio of neighbouring steps of the search.
const RATIO: f64 = 1.001;
/// Energies that are as large as this many deviations have a relative tolerance.
const RELATIVE: f64 = 10.0;
/// Meanings of the scale.
const START: &str = "energy at the start";
const GIVEN: &str = "given scale";
const UNIT: &str = "unit of the energies";

/// What is required of the energy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Requirement {
    /// Largest deviation from the energy at the start, relative to the scale. Without it runs have no verdict, and the largest step is that
    /// for [`Requirement::TOLERANCE`].
    pub tolerance: Option<f64>,
    /// Duration in s; none for that of the shortest run.
    pub horizon: Option<f64>,
    /// The energy that the tolerance is relative to; none for that at the start, or its unit if that is close to 0.
    ///
    /// The energy at the start has the arbitrary constant of the potential.
    pub scale: Option<f64>,
}

impl Requirement {
    /// The tolerance of the largest step where none is stated.
    pub const TOLERANCE: f64 = 1e-4;

    pub(crate) fn check(&self) -> Result<(), TraceError> {
        let named =
            [("tolerance", self.tolerance), ("horizon", self.horizon), ("scale", self.scale)];
        for (what, value) in named {
            if let Some(value) = value.filter(|x| !(x.is_finite() && *x > 0.0)) {
                return Err(TraceError::Requirement { what, value });
            }
        }
        Ok(())
    }
}

/// The largest time step that meets the requirement, by the laws of oscillation, drift and walk.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct LargestDt {
    /// Tolerance and horizon.
    pub tolerance: f64,
    /// Duration in s.
    pub horizon: f64,
    /// The energy that the tolerance is relative to; 1 for an energy close to 0.
    pub scale: f64,
    /// The meaning of the scale: `energy at the start`, `given scale`, or `unit of the energies`.
    pub scale_of: &'static str,
    /// The step in s by the values of the laws; none if no step of the range meets the requirement.
    pub dt: Option<f64>,
    /// Whether `dt` is none because the runs do not tell how a part depends on the step.
    pub is_unknown: bool,
    /// The shortest step in s of the search.
    pub shortest_dt: f64,
    /// The step that meets it at the unfavourable ends of all intervals.
    pub low: Option<f64>,
    /// The step that meets it at the favourable ends.
    pub high: Option<f64>,
    /// Whether the longest step of the runs meets the requirement: longer steps are unknown.
    pub is_limited_by_runs: bool,
    /// Whether the step is shorter than those of the runs.
    pub is_extrapolated: bool,
    /// Duration of runs in s that would resolve the drift; none if it is resolved, or does not matter.
    pub resolving_duration: Option<f64>,
}

/// The part of an interval that a law takes.
#[derive(Clone, Copy)]
enum End {
    Low,
    Value,
    High,
}

/// Sizes at the steps of the runs, and the exponent below them.
struct Law {
    points: Vec<(f64, Estimate)>,
    exponent_below: f64,
    /// Whether the runs tell how the size depends on the step.
    is_known: bool,
}

impl Law {
    /// The size at a step: between neighbours a power law, below the shortest step the law of the cause.
    fn at(&self, dt: f64, end: End) -> f64 {
        let size = |estimate: &Estimate| match end {
            End::Low => estimate.low,
            End::Value => estimate.value,
            End::High => estimate.high,
        };
        let Some(first) = self.points.first() else { return 0.0 };
        if dt <= first.0 {
            return size(&first.1) * (dt / first.0).powf(self.exponent_below);
        }
        let above = self.points.partition_point(|(step, _)| *step < dt);
        match (self.points.get(above - 1), self.points.get(above)) {
            (Some(short), Some(long)) => {
                let (a, b) = (size(&short.1), size(&long.1));
                let part = (dt / short.0).ln() / (long.0 / short.0).ln();
                match a > 0.0 && b > 0.0 {
                    true => a * (b / a).powf(part),
                    false => a + (b - a) * part,
                }
            }
            (Some(last), None) => size(&last.1),
            (None, _) => 0.0,
        }
    }
}

fn oscillation(runs: &[Run], cause: OscillationCause, drift_cause: DriftCause) -> Law {
    let point = |run: &Run| {
        let Estimate { value, low, high } = run.oscillation;
        let is_rounding = run.has_unclear_oscillation() && !run.resolves_oscillation();
        let size = |x: f64| match value > 0.0 && !is_rounding {
            // An infinite bound times a deviation of 0 is no number.
            true => run.largest_deviation.max(f64::MIN_POSITIVE) * (x / value),
            false => run.largest_deviation,
        };
        (run.dt, Estimate { value: size(value), low: size(low), high: size(high) })
    };
    let points: Vec<(f64, Estimate)> = runs.iter().map(point).collect();
    let exponent_below = match (cause, &points[..]) {
        (OscillationCause::Truncation, [short, long, ..]) => {
            exponent_of_values(short, long).round().max(1.0)
        }
        // Deviations that are no oscillation, such as the curvature of a drift by truncation.
        (OscillationCause::Unresolved, [short, long, ..])
            if drift_cause == DriftCause::Truncation =>
        {
            exponent_of_values(short, long).max(0.0)
        }
        _ => 0.0,
    };
    let is_known = exponent_below > 0.0 || cause == OscillationCause::StepIndependent;
    Law { points, exponent_below, is_known }
}

/// The exponent between the values of two sizes.
fn exponent_of_values(short: &(f64, Estimate), long: &(f64, Estimate)) -> f64 {
    (long.1.value / short.1.value).ln() / (long.0 / short.0).ln()
}

fn drift(runs: &[Run], cause: DriftCause, order: Option<f64>) -> Law {
    let mut points: Vec<(f64, Estimate)> = runs
        .iter()
        .map(|run| {
            let rate = run.drift_rate;
            let value = if run.drifts() { rate.value.abs() } else { 0.0 };
            (
                run.dt,
                Estimate { value, low: rate.smallest_size().min(value), high: rate.largest_size() },
            )
        })
        .collect();
    // A drift by truncation at a step is no larger than at a longer one.
    if matches!(cause, DriftCause::Unresolved | DriftCause::Truncation) {
        let mut bound = f64::INFINITY;
        for (_, rate) in points.iter_mut().rev() {
            bound = bound.min(rate.high);
            rate.high = bound.max(rate.value);
        }
    }
    let exponent_below = match cause {
        DriftCause::Truncation => order.unwrap_or(1.0).round().max(1.0),
        DriftCause::Rounding => -1.0,
        _ => 0.0,
    };
    Law { points, exponent_below, is_known: cause != DriftCause::Unclear }
}

fn walk(runs: &[Run], cause: WalkCause, exponent: Option<f64>) -> Law {
    let none = Estimate { value: 0.0, low: 0.0, high: 0.0 };
    let point = |run: &Run| (run.dt, run.present_walk().map_or(none, |walk| walk.diffusion));
    let exponent_below = match cause {
        WalkCause::Rounding => -1.0,
        WalkCause::Truncation => exponent.unwrap_or(0.0).max(0.0),
        _ => 0.0,
    };
    let is_known = match cause {
        WalkCause::Unclear => false,
        WalkCause::Truncation => exponent_below > 0.0,
        _ => true,
    };
    Law { points: runs.iter().map(point).collect(), exponent_below, is_known }
}

/// A slow change by as much at each step. The oscillation may contain it.
fn constant(dt: f64, slow: Option<SlowChange>) -> Law {
    let point = |slow: SlowChange| (dt, Estimate { value: slow.size, low: 0.0, high: slow.size });
    Law {
        points: slow.map(point).into_iter().collect(),
        exponent_below: 0.0,
        is_known: slow.is_none_or(|slow| slow.is_of_all),
    }
}

impl LargestDt {
    /// The allowed deviation: `10⁻⁴ of the energy at the start`.
    pub(crate) fn allowed_in_words(&self) -> String {
        let tolerance = number(self.tolerance, 3);
        match self.scale_of {
            UNIT => format!("{tolerance} in the {UNIT}"),
            of => format!("{tolerance} of the {of}, {}", number(self.scale, 4)),
        }
    }

    /// Searches the step, with runs that have the shortest step first, and the deviations of the runs over the horizon at the favourable
    /// and the unfavourable ends of all intervals. `exponents` are those of the drift rate and of the variance of the walk.
    pub(crate) fn search(
        runs: &[Run],
        requirement: Requirement,
        causes: (OscillationCause, DriftCause, WalkCause),
        exponents: (Option<f64>, Option<f64>),
        slow: Option<SlowChange>,
    ) -> Option<(Self, Vec<[f64; 2]>)> {
        let (first, last) = (runs.first()?, runs.last()?);
        let horizon = requirement.horizon.unwrap_or(first.duration);
        let start = first.energy_at_start.abs();
        let (scale, scale_of) = match requirement.scale {
            Some(scale) => (scale, GIVEN),
            None if start > RELATIVE * first.largest_deviation => (start, START),
            None => (1.0, UNIT),
        };
        let tolerance = requirement.tolerance.unwrap_or(Requirement::TOLERANCE);
        let allowed = tolerance * scale;
        let laws = [
            oscillation(runs, causes.0, causes.1),
            drift(runs, causes.1, exponents.0),
            walk(runs, causes.2, exponents.1),
            constant(first.dt, slow),
        ];
        let deviation = |dt: f64, end: End, is_counted: fn(&Law) -> bool| {
            let size = |law: &Law| if is_counted(law) { law.at(dt, end) } else { 0.0 };
            let [oscillation, drift, walk, slow] = laws.each_ref().map(size);
            slow + oscillation + drift * horizon + NORMAL_95 * (walk * horizon).sqrt()
        };
        let shortest_dt = SHORTER * first.dt;
        let search = |end: End, is_counted: fn(&Law) -> bool| {
            let mut dt = last.dt;
            while dt > shortest_dt {
                if deviation(dt, end, is_counted) <= allowed {
                    return Some(dt);
                }
                dt /= RATIO;
            }
            None
        };
        let all = |end: End| search(end, |_| true);
        let (dt, low, high) = (all(End::Value), all(End::High), all(End::Low));
        let is_unknown = dt.is_none() && search(End::Value, |law| law.is_known).is_some();
        let at_runs = runs
            .iter()
            .map(|run| [End::Low, End::High].map(|end| deviation(run.dt, end, |_| true)));
        let largest = LargestDt {
            tolerance,
            horizon,
            scale,
            scale_of,
            dt,
            is_unknown,
            shortest_dt,
            low,
            high,
            is_limited_by_runs: dt == Some(last.dt),
            is_extrapolated: dt.is_some_and(|dt| dt < first.dt),
            resolving_duration: resolving_duration(runs, dt, horizon, allowed),
        };
        Some((largest, at_runs.collect()))
    }
}

/// Duration of runs whose interval of the rate, over the horizon, is a fifth of the tolerance: with noise of a short memory it falls as
/// the power 3/2 of the duration, under a random walk as its root.
fn resolving_duration(runs: &[Run], dt: Option<f64>, horizon: f64, allowed: f64) -> Option<f64> {
    let dt = dt?;
    let run = runs.iter().rev().find(|run| run.dt <= dt).or(runs.first())?;
    let half_width = run.drift_rate.high - run.drift_rate.value;
    let ratio = 5.0 * half_width * horizon / allowed;
    if run.drifts() || ratio <= 1.0 {
        return None;
    }
    let power = if run.present_walk().is_some() { 2.0 } else { 2.0 / 3.0 };
    // No run need be longer than the horizon.
    Some((run.duration * ratio.powf(power)).min(horizon.max(run.duration)))
}
