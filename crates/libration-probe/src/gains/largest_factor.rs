//! The largest factor of gains with which steps are stable.

use libration::linear::{Matrix, is_schur_stable, log_spectral_radius};

/// Growth per step that is no rounding: the two factors of a free joint, both 1, are off by the root of a rounding.
const OUTSIDE: f64 = 1e-7;
/// Smallest and largest factor that is tried.
const RANGE: [f64; 2] = [1e-6, 1e9];
const RATIO: f64 = 1.5;
const BISECTIONS: usize = 60;
const RESOLUTION: f64 = 1e-9;

/// Whether a mode grows.
pub(super) fn is_stable(step: Option<Matrix>) -> bool {
    step.is_some_and(|step| is_schur_stable(&step.scaled((-OUTSIDE).exp())))
}

/// The logarithm of the growth per step; infinite without a step.
pub(super) fn growth(step: Option<Matrix>) -> f64 {
    step.map_or(f64::INFINITY, |step| log_spectral_radius(&step))
}

/// The largest factor up to which all steps are stable, from 1 on; below 1 if a step with 1 is unstable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum LargestFactor {
    /// The limit.
    Limit(f64),
    /// There is none up to the largest factor.
    Unlimited,
    /// Even the smallest one is unstable.
    Never,
}

impl LargestFactor {
    pub(super) fn search(step: impl Fn(f64) -> Option<Matrix>) -> Self {
        let stable = |factor: f64| is_stable(step(factor));
        let starts_stable = stable(1.0);
        let [least, most] = RANGE;
        let mut factor = 1.0;
        let (mut low, mut high) = loop {
            let next = if starts_stable { factor * RATIO } else { factor / RATIO };
            if next > most {
                return LargestFactor::Unlimited;
            }
            if next < least {
                return LargestFactor::Never;
            }
            if stable(next) != starts_stable {
                break if starts_stable { (factor, next) } else { (next, factor) };
            }
            factor = next;
        };
        for _ in 0..BISECTIONS {
            if high - low <= RESOLUTION * high {
                break;
            }
            let middle = f64::midpoint(low, high);
            if stable(middle) { low = middle } else { high = middle }
        }
        // Growth that falls with the factor has no limit: it only becomes smaller than what counts as growth.
        let always = growth(step(low / 4.0)) > 0.15 * growth(step(high));
        if always { LargestFactor::Never } else { LargestFactor::Limit(low) }
    }

    /// The limit; infinite if there is none, 0 if there is no stable factor.
    pub(super) fn value(self) -> f64 {
        match self {
            LargestFactor::Limit(factor) => factor,
            LargestFactor::Unlimited => f64::INFINITY,
            LargestFactor::Never => 0.0,
        }
    }
}
