//! The factors of gains with which steps are stable.

use libration::linear::{Matrix, is_schur_stable, log_spectral_radius};

/// Growth per step that is no rounding: the two factors of a free joint, both 1, are off by the root of a rounding.
pub(super) const OUTSIDE: f64 = 1e-7;
/// Smallest and largest factor that is tried.
const RANGE: [f64; 2] = [1e-6, 1e9];
const RATIO: f64 = 1.5;
/// Entries of a step of which products would overflow: no stable step has them.
const LARGEST: f64 = 1e100;
const BISECTIONS: usize = 60;
const RESOLUTION: f64 = 1e-9;

/// Part by which a step is longer that must be stable, too: at a limit, where two factors meet at −1, deviations grow with the number of
/// steps without a factor above 1. Just beyond the limit the largest factor exceeds 1 by more than [`OUTSIDE`].
const LONGER: f64 = 2e-7;

/// The matrix of a step, and that of a slightly longer one; none where it is not finite.
pub(super) struct TrialStep([Option<Matrix>; 2]);

impl TrialStep {
    /// The steps of `length` and slightly more.
    pub(super) fn new(step: impl Fn(f64) -> Option<Matrix>, length: f64) -> Self {
        TrialStep([length, length * (1.0 + LONGER)].map(step))
    }

    /// Whether no mode grows, also in steps that are slightly longer.
    pub(super) fn is_stable(&self) -> bool {
        self.0.iter().all(|step| {
            step.as_ref().is_some_and(|step| {
                step.largest() < LARGEST && is_schur_stable(&step.scaled((-OUTSIDE).exp()))
            })
        })
    }

    /// The logarithm of the growth per step; infinite without a step.
    pub(super) fn growth(&self) -> f64 {
        self.0[0].as_ref().map_or(f64::INFINITY, log_spectral_radius)
    }
}

/// The factors with which steps are stable: those around 1, or the next ones if a step with 1 is unstable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct StableFactors {
    /// The smallest one; 0 if the search begins with it or does not go there.
    pub(super) least: f64,
    /// The largest one; infinite if there is no limit, 0 if no factor is stable.
    pub(super) most: f64,
}

impl StableFactors {
    const NONE: Self = StableFactors { least: 0.0, most: 0.0 };

    pub(super) fn search(step: impl Fn(f64) -> TrialStep) -> Self {
        let stable = |factor: f64| step(factor).is_stable();
        let upper = |from: f64| end(from, RATIO, &stable).unwrap_or(f64::INFINITY);
        if stable(1.0) {
            return StableFactors { least: 0.0, most: upper(1.0) };
        }
        // Gains that are too large, or too small beside a negative stiffness.
        let below = end(1.0, RATIO.recip(), &|factor| !stable(factor));
        if let Some(limit) = below {
            // Growth that falls with the factor has no limit: it only becomes smaller than what counts as growth.
            let always = step(limit / 4.0).growth() > 0.15 * step(limit * (1.0 + 1e-6)).growth();
            return if always { Self::NONE } else { StableFactors { least: 0.0, most: limit } };
        }
        match end(1.0, RATIO, &|factor| !stable(factor)) {
            Some(least) => {
                let least = least * (1.0 + 10.0 * RESOLUTION);
                StableFactors { least, most: upper(least) }
            }
            None => Self::NONE,
        }
    }
}

/// The factor up to which `holds` from one at which it does, by geometric steps and bisection; none within the range.
fn end(from: f64, ratio: f64, holds: &impl Fn(f64) -> bool) -> Option<f64> {
    let [least, most] = RANGE;
    let (mut inside, mut outside) = (from, from * ratio);
    while holds(outside) {
        inside = outside;
        outside *= ratio;
        if !(least..=most).contains(&outside) {
            return None;
        }
    }
    for _ in 0..BISECTIONS {
        if (outside - inside).abs() <= RESOLUTION * inside {
            break;
        }
        let middle = f64::midpoint(inside, outside);
        if holds(middle) { inside = middle } else { outside = middle }
    }
    Some(inside)
}
