//! Causes of drifts, walks and oscillations, by how they change with the time step.

use serde::Serialize;

use crate::power_law::local_exponent;
use crate::{Estimate, PowerLaw, Run};

/// Exponents in the middle between 0, of what does not change with the step, and 1, of the lowest order or of the number of steps.
const MIDDLE: f64 = 0.5;

/// Why an energy drifts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum DriftCause {
    /// No run resolves a drift.
    Unresolved,
    /// The rate falls with the step.
    Truncation,
    /// The rate does not depend on the step: a force that is no gradient, friction, a drive.
    StepIndependent,
    /// The rate grows as the step falls.
    Rounding,
    /// The runs do not tell which.
    Unclear,
}

/// Why an energy wanders.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum WalkCause {
    /// No run has a random walk.
    Absent,
    /// It grows as the step falls.
    Rounding,
    /// It falls with the step: slow motions, or forces with jumps.
    Truncation,
    /// It does not depend on the step: random forces.
    StepIndependent,
    /// The runs do not tell which.
    Unclear,
}

/// How the fluctuation changes with the step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum OscillationCause {
    /// It is below what the energies resolve.
    Unresolved,
    /// It falls with the step.
    Truncation,
    /// It does not fall with the step.
    StepIndependent,
    /// The runs do not tell which.
    Unclear,
}

/// The class of an exponent.
enum Class {
    Falls,
    Stays,
    Grows,
    Unclear,
}

fn class(exponent: Estimate) -> Class {
    match exponent {
        e if e.low > MIDDLE => Class::Falls,
        e if e.high < -MIDDLE => Class::Grows,
        e if e.low > -MIDDLE && e.high < MIDDLE => Class::Stays,
        // Between the middles the interval is wide; 0 is excluded, and the nearest cause is the one on this side.
        e if e.high < 0.0 => Class::Grows,
        _ => Class::Unclear,
    }
}

/// The class by the two shortest steps, where all that falls with the step is smallest, or else by the shortest and the longest.
fn class_of(sizes: &[(f64, Estimate)]) -> Class {
    let [first, second, ..] = sizes else { return Class::Unclear };
    match class(local_exponent(*first, *second)) {
        Class::Unclear => match sizes.last() {
            Some(last) => class(local_exponent(*first, *last)),
            None => Class::Unclear,
        },
        known => known,
    }
}

/// How many times a size without an interval may be too small or too large. The deviation of as few as five independent values errs by
/// 30 %, so that a factor of 3 is more than three of its errors.
const NO_INTERVAL: f64 = 3.0;

/// Whether sizes of which some have no interval still fall with the step, from the shortest to the longest.
fn falls(sizes: &[(f64, Estimate)]) -> bool {
    let bounded = |(dt, size): &(f64, Estimate)| match size.high.is_infinite() {
        true => {
            let (low, high) = (size.value / NO_INTERVAL, size.value * NO_INTERVAL);
            (*dt, Estimate { value: size.value, low, high })
        }
        false => (*dt, *size),
    };
    let (Some(first), Some(last)) = (sizes.first(), sizes.last()) else { return false };
    matches!(class(local_exponent(bounded(first), bounded(last))), Class::Falls)
}

/// Whether sizes fall more slowly towards the shortest steps, beyond their intervals and by more than half an order: as the sum of one
/// that falls and one that does not, or of two orders, where no single law holds. Steps near a limit of stability change it by less.
fn levels_off(sizes: &[(f64, Estimate)]) -> bool {
    let [first, second, third, ..] = sizes else { return false };
    let (short, long) = (local_exponent(*first, *second), local_exponent(*second, *third));
    long.low > short.high && long.value > short.value + MIDDLE
}

impl DriftCause {
    /// The cause in runs with the shortest step first.
    pub(crate) fn of(runs: &[Run]) -> Self {
        if !runs.iter().any(Run::drifts) {
            return DriftCause::Unresolved;
        }
        let rates: Vec<(f64, Estimate)> = runs.iter().map(|run| (run.dt, run.drift_rate)).collect();
        let is_same_sign = rates.windows(2).all(|pair| pair[0].1.value * pair[1].1.value > 0.0);
        match class_of(&rates) {
            Class::Falls => DriftCause::Truncation,
            Class::Grows => DriftCause::Rounding,
            Class::Stays if is_same_sign => DriftCause::StepIndependent,
            _ => DriftCause::Unclear,
        }
    }

    /// The cause in words.
    pub fn text(self) -> &'static str {
        match self {
            DriftCause::Unresolved => "no drift is resolved",
            DriftCause::Truncation => "truncation: the rate falls with the step",
            DriftCause::StepIndependent => {
                "the system itself: the rate does not depend on the step"
            }
            DriftCause::Rounding => "rounding: the rate grows as the step falls",
            DriftCause::Unclear => "unclear: the runs do not tell how the rate depends on the step",
        }
    }
}

impl WalkCause {
    /// The cause in runs with the shortest step first, with the law of the walks that are present. Energies with a long memory look like
    /// walks of any size, so that rounding requires that the whole interval of the exponent is below −½.
    pub(crate) fn of(runs: &[Run], law: Option<PowerLaw>) -> Self {
        if runs.iter().all(|run| run.present_walk().is_none()) {
            return WalkCause::Absent;
        }
        let walks: Vec<(f64, Estimate)> =
            runs.iter().filter_map(|run| Some((run.dt, run.walk?.diffusion))).collect();
        match class_of(&walks) {
            Class::Grows if law.is_some_and(|law| law.exponent.high < -MIDDLE) => {
                WalkCause::Rounding
            }
            Class::Falls => WalkCause::Truncation,
            Class::Stays => WalkCause::StepIndependent,
            Class::Grows | Class::Unclear => WalkCause::Unclear,
        }
    }

    /// The cause in words.
    pub fn text(self) -> &'static str {
        match self {
            WalkCause::Absent => "no random walk",
            WalkCause::Rounding => "rounding: the walk grows as the step falls",
            WalkCause::Truncation => "the walk falls with the step",
            WalkCause::StepIndependent => "the walk does not depend on the step",
            WalkCause::Unclear => "unclear: the runs do not tell how the walk depends on the step",
        }
    }
}

impl OscillationCause {
    /// The cause in runs with the shortest step first.
    pub(crate) fn of(runs: &[Run]) -> Self {
        let sizes: Vec<(f64, Estimate)> = runs
            .iter()
            .filter(|run| run.resolves_oscillation())
            .map(|run| (run.dt, run.oscillation))
            .collect();
        // An oscillation that only a shorter step shows does not fall with the step.
        let is_of_longest =
            sizes.iter().all(|(dt, _)| runs.last().is_some_and(|run| run.dt == *dt));
        match (sizes.len(), class_of(&sizes)) {
            (0 | 1, _) if is_of_longest => OscillationCause::Unresolved,
            (0 | 1, _) => OscillationCause::Unclear,
            (_, Class::Falls) if levels_off(&sizes) => OscillationCause::Unclear,
            (_, Class::Falls) => OscillationCause::Truncation,
            (_, Class::Stays | Class::Grows) => OscillationCause::StepIndependent,
            (_, Class::Unclear) if falls(&sizes) => OscillationCause::Truncation,
            (_, Class::Unclear) => OscillationCause::Unclear,
        }
    }

    /// The cause in words.
    pub fn text(self) -> &'static str {
        match self {
            OscillationCause::Unresolved => "below what the energies resolve",
            OscillationCause::Truncation => "truncation: it falls with the step",
            OscillationCause::StepIndependent => "it does not fall with the step",
            OscillationCause::Unclear => "unclear: the runs do not tell how it depends on the step",
        }
    }
}
