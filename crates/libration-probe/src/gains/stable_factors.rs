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

/// Part by which a step is longer that must be stable, too, for gains to hold: at a limit, where factors leave the unit circle at −1, a
/// motion does not decay, or grows with the number of steps. Just beyond the limit a factor exceeds 1 by more than [`OUTSIDE`].
const LONGER: f64 = 2e-7;

/// Whether no mode grows.
pub(super) fn is_stable(step: Option<Matrix>) -> bool {
    step.is_some_and(|step| {
        step.largest() < LARGEST && is_schur_stable(&step.scaled((-OUTSIDE).exp()))
    })
}

/// Whether no mode grows in steps of `length`, nor in slightly longer ones.
pub(super) fn holds(step: impl Fn(f64) -> Option<Matrix>, length: f64) -> bool {
    [length, length * (1.0 + LONGER)].into_iter().all(|length| is_stable(step(length)))
}

/// The logarithm of the growth per step; infinite without a step.
pub(super) fn growth(step: Option<Matrix>) -> f64 {
    step.map_or(f64::INFINITY, |step| log_spectral_radius(&step))
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

    pub(super) fn search(step: impl Fn(f64) -> Option<Matrix>) -> Self {
        let stable = |factor: f64| is_stable(step(factor));
        let upper = |from: f64| end(from, RATIO, &stable).unwrap_or(f64::INFINITY);
        if stable(1.0) {
            return StableFactors { least: 0.0, most: upper(1.0) };
        }
        // Gains that are too large, or too small beside a negative stiffness.
        let below = end(1.0, RATIO.recip(), &|factor| !stable(factor));
        if let Some(limit) = below {
            // Growth that falls with the factor has no limit: it only becomes smaller than what counts as growth.
            let always = growth(step(limit / 4.0)) > 0.15 * growth(step(limit * (1.0 + 1e-6)));
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
