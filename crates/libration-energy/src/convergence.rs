//! Whether runs of several steps converge: whether their energies are evidence of anything.

use libration_report::notation::number;

use crate::local_deviations::Roughness;
use crate::{EnergyTrace, Run};

/// Part of the largest deviation of an energy by which a sample of the shortest step may be off the curve through its neighbours, if that
/// deviation is large. An oscillation of five samples per period is off by this part. Where a stiffness jumps, such as at a contact, small
/// deviations of honest steps jump, too.
const OFF_CURVE: f64 = 0.1;
/// Samples further apart than this many steps do not show what happens in a step.
const EACH_STEP: f64 = 1.5;
/// Part of the scale from which on a deviation of the energy is as large as the motion.
const LARGE: f64 = 0.1;
/// Part of their rms deviation by which energies that are together differ.
const TOGETHER: f64 = 0.5;
/// How many times as long the shorter steps stay together. Of chaotic motions with an error of 10⁻⁵ that falls fourfold it is 1.12.
const LONGER: f64 = 1.05;
/// Part of the duration that counts as all of it.
const THROUGHOUT: f64 = 0.95;
/// The least exponent of the largest deviation, between 0 and 1.
const FALLS: f64 = 0.5;
/// Change of the exponent from step to step that neither rare events nor the next term of an error explain: a factor of 11 at half the step.
const BEND: f64 = 3.5;
/// Ratio by which the largest deviation of a shorter step may exceed that of its neighbour: rare events differ from run to run.
const RARE: f64 = 1.5;

/// Whether runs of several steps converge.
pub(crate) struct Convergence {
    /// Whether energies of shorter steps stay together for longer, or throughout.
    pub stays_together: bool,
    /// Whether deviations are as large as the scale, and the runs do not stay together.
    pub is_saturated: bool,
    /// Why the runs are no evidence.
    pub reason: Option<String>,
}

impl Convergence {
    pub(crate) fn of(
        traces: &[&EnergyTrace],
        runs: &[Run],
        roughness: &[Roughness],
        scale: Option<f64>,
    ) -> Self {
        let times: Vec<f64> =
            traces.windows(2).map(|pair| time_together(pair[0], pair[1])).collect();
        let duration = runs.iter().map(|run| run.duration).fold(f64::INFINITY, f64::min);
        let stays_together = match times[..] {
            [fine, .., coarse] => fine >= THROUGHOUT * duration || fine > LONGER * coarse,
            [only] => only >= THROUGHOUT * duration,
            [] => false,
        };
        let scale = scale.unwrap_or_else(|| runs[0].energy_at_start.abs());
        let is_large = |run: &Run| run.deviation_from_start > LARGE * scale;
        let is_saturated = runs.iter().any(is_large) && !stays_together;
        let reason = unresolved_step(&runs[0], &roughness[0])
            .filter(|_| is_large(&runs[0]))
            .or_else(|| is_saturated.then(|| saturated(runs, &times, scale)))
            .or_else(|| not_falling(runs));
        Convergence { stays_together, is_saturated, reason }
    }
}

/// That the energy of the shortest step changes from sample to sample by no small part of its largest deviation.
fn unresolved_step(run: &Run, roughness: &Roughness) -> Option<String> {
    let off = roughness.largest();
    let is_unresolved = run.duration / (run.samples - 1) as f64 <= EACH_STEP * run.dt
        && off > run.rounding()
        && off > OFF_CURVE * run.deviation_from_start;
    is_unresolved.then(|| {
        format!(
            "the shortest step does not resolve the energy: at dt = {} s a sample is {} off the curve through its neighbours, and the largest deviation of all is {}",
            number(run.dt, 4),
            number(off, 2),
            number(run.deviation_from_start, 2)
        )
    })
}

fn saturated(runs: &[Run], times: &[f64], scale: f64) -> String {
    let times: Vec<String> = times.iter().rev().map(|time| number(*time, 2)).collect();
    format!(
        "the runs do not converge: their energies deviate by {}, of {} in scale, and those of neighbouring steps, the longest first, part after {} s",
        deviations(runs),
        number(scale, 2),
        times.join(" and ")
    )
}

/// That the largest deviation does not fall with the step, or by no one law.
fn not_falling(runs: &[Run]) -> Option<String> {
    let (first, last) = (runs.first()?, runs.last()?);
    let is_seen = |run: &Run| run.deviation_from_start > run.rounding();
    let exponent = |short: &Run, long: &Run| {
        (long.deviation_from_start / short.deviation_from_start).ln() / (long.dt / short.dt).ln()
    };
    let grows = runs.windows(2).any(|pair| {
        is_seen(&pair[0]) && pair[0].deviation_from_start > RARE * pair[1].deviation_from_start
    });
    let exponents: Vec<f64> = runs
        .windows(2)
        .filter(|pair| is_seen(&pair[0]))
        .map(|pair| exponent(&pair[0], &pair[1]))
        .collect();
    let bends = exponents.windows(2).any(|pair| (pair[1] - pair[0]).abs() > BEND);
    let why = match grows || (is_seen(first) && exponent(first, last) < FALLS) {
        true => "do not fall with the step",
        false if bends => "follow no power of the step",
        false => return None,
    };
    Some(format!("the largest deviations from the start, {}, {why}", deviations(runs)))
}

/// The largest deviations, with their steps.
fn deviations(runs: &[Run]) -> String {
    let own = |run: &Run| {
        format!("{} at dt = {} s", number(run.deviation_from_start, 2), number(run.dt, 4))
    };
    runs.iter().rev().map(own).collect::<Vec<_>>().join(", ")
}

/// The time up to which two runs have energies that are the same but for a factor.
fn time_together(fine: &EnergyTrace, coarse: &EnergyTrace) -> f64 {
    let deviation = |trace: &EnergyTrace| -> Vec<f64> {
        let start = trace.energies[0];
        let all: Vec<f64> = trace.energies.iter().map(|energy| energy - start).collect();
        let square = all.iter().map(|x| x * x).sum::<f64>() / all.len() as f64;
        all.iter().map(|x| x / square.sqrt()).collect()
    };
    let (short, long) = (deviation(fine), deviation(coarse));
    let begin = coarse.times[0];
    let mut next = 1;
    for (time, value) in coarse.times.iter().zip(&long) {
        while next + 1 < fine.times.len() && fine.times[next] < *time {
            next += 1;
        }
        let (from, to) = (fine.times[next - 1], fine.times[next]);
        let part = ((time - from) / (to - from)).clamp(0.0, 1.0);
        let other = short[next - 1] + part * (short[next] - short[next - 1]);
        if (value - other).abs() > TOGETHER {
            return time - begin;
        }
    }
    coarse.duration()
}
