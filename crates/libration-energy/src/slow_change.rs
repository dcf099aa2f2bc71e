//! A slow change of the energy that runs of all steps share.

use libration_report::notation::number;

use crate::batches::Batches;
use crate::{EnergyTrace, Finding, FindingKind, Run};

/// Batches of a run. Changes within one are no slow ones; longer ones leave less of the oscillation of the step.
const BATCHES: [usize; 4] = [32, 16, 8, 4];
/// The exponent in the middle between 0, of what does not depend on the step, and 1, of the lowest order.
const MIDDLE: f64 = 0.5;
/// The same for the two shortest steps of a fault, where all that falls with the step is smallest.
const SAME: f64 = 0.25;
/// Ratio of steps below which the two exponents make little difference.
const APART: f64 = 1.4;
/// Part of the range of a change from which on it is one from the start to the end.
const ONE_WAY: f64 = 0.5;

/// A slow change of the energy that does not fall with the step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SlowChange {
    /// The change from the start to the end, or the range of one that comes back, in the run of the shortest step.
    pub(crate) size: f64,
    /// The part of it in the run of the longest step.
    of_longest: f64,
    is_one_way: bool,
    /// Whether all of at least three runs share it, and the shortest steps alike.
    pub(crate) is_of_all: bool,
}

impl SlowChange {
    /// The change that the run with the shortest step, the first one, shares with the others.
    pub(crate) fn of(traces: &[&EnergyTrace], runs: &[Run]) -> Option<Self> {
        let found = BATCHES.map(|count| SlowChange::in_batches(count, traces, runs));
        let found = || found.iter().flatten();
        found().find(|slow| slow.is_of_all).or_else(|| found().next()).copied()
    }

    /// The same in a number of batches. Of an energy that is conserved but for errors of order 1 or higher, means over batches differ from
    /// step to step by more than the tolerated part; those of noise and of chaotic motions do so, too.
    fn in_batches(count: usize, traces: &[&EnergyTrace], runs: &[Run]) -> Option<Self> {
        let duration = runs.iter().map(|run| run.duration).fold(f64::INFINITY, f64::min);
        let all: Vec<Vec<f64>> =
            traces.iter().map(|trace| profile(count, trace, duration)).collect();
        let (own, others) = all.split_first()?;
        let differs_less = |(other, run): &(&Vec<f64>, &Run), exponent: f64| {
            let apart: Vec<f64> = own.iter().zip(*other).map(|(a, b)| a - b).collect();
            norm(&apart) < (1.0 - (runs[0].dt / run.dt).powf(exponent)) * norm(other)
        };
        let coarser: Vec<(&Vec<f64>, &Run)> =
            others.iter().zip(&runs[1..]).filter(|(_, run)| run.dt > APART * runs[0].dt).collect();
        let shared = coarser.iter().filter(|pair| differs_less(pair, MIDDLE)).count();
        let is_same = coarser.first().is_some_and(|next| differs_less(next, SAME));
        let is_one_way = change(own) > ONE_WAY * range(own);
        let size = if is_one_way { change(own) } else { range(own) };
        let common = |other: &Vec<f64>| {
            let product = own.iter().zip(other).map(|(a, b)| a * b).sum::<f64>();
            size * product / norm(own).powi(2)
        };
        (shared > 0 && range(own) > runs[0].rounding()).then(|| SlowChange {
            size,
            of_longest: all.last().map_or(0.0, common),
            is_one_way,
            is_of_all: shared == coarser.len() && shared > 1 && is_same,
        })
    }

    /// The finding: a fault if all of three or more runs share the change, else that the runs do not tell.
    pub(crate) fn finding(&self, runs: &[Run]) -> Option<Finding> {
        let (first, last) = (runs.first()?, runs.last()?);
        let (kind, why) = match (self.is_of_all, self.is_one_way) {
            (true, true) => (
                FindingKind::StepIndependentDrift,
                "which does not fall with the step: the system or its forces change it",
            ),
            (true, false) => (
                FindingKind::StepIndependentOscillation,
                "which does not fall with the step: it is not the energy that the simulation conserves",
            ),
            (false, _) => (
                FindingKind::UnclearDrift,
                "and not all runs tell whether that falls with the step",
            ),
        };
        // Means over batches miss a part of a turn.
        let (least, how) = match self.is_one_way {
            true => ("", "from the start to the end"),
            false => ("at least ", "and comes back in the course"),
        };
        Some(Finding::new(
            kind,
            format!(
                "the energy changes slowly by {least}{} {how} of the {} s at dt = {} s and by {} at dt = {} s, {why}",
                number(self.size, 2),
                number(first.duration, 4),
                number(first.dt, 4),
                number(self.of_longest, 2),
                number(last.dt, 4),
            ),
        ))
    }
}

/// The means of batches up to a duration, less their mean.
fn profile(count: usize, trace: &EnergyTrace, duration: f64) -> Vec<f64> {
    let (start, begin) = (trace.energies[0], trace.times[0]);
    let end = trace.times.partition_point(|t| t - begin <= duration).max(count);
    let energies: Vec<f64> = trace.energies[..end].iter().map(|energy| energy - start).collect();
    let means = Batches::of(&trace.times[..end], count).means(&energies);
    let mean = means.iter().sum::<f64>() / count as f64;
    means.iter().map(|x| x - mean).collect()
}

fn norm(values: &[f64]) -> f64 {
    values.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn range(values: &[f64]) -> f64 {
    let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    most - values.iter().copied().fold(f64::INFINITY, f64::min)
}

/// The change from the start to the end: half a batch beyond the first and the last mean, by lines.
fn change(values: &[f64]) -> f64 {
    let [first, second, .., before, last] = values else { return 0.0 };
    (1.5 * last - 0.5 * before - 1.5 * first + 0.5 * second).abs()
}
