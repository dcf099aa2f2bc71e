//! The random walk of an energy.

use serde::Serialize;

use crate::Estimate;
use crate::batches::{Batches, MEAN_DISTANCE};
use crate::local_level::{LocalLevel, POSSIBLE};

/// Twice the difference of log-likelihoods at which a walk is present: without one it is exceeded in about 5·10⁻⁵ of all runs.
const PRESENT: f64 = 15.1;

/// Walks below this many leakages are none: a slow beat has the size of the leakage on either side.
const LEAKS: f64 = 2.0;

/// Part of the squared changes of batch means that two neighbours have where the energy jumps once. Of 47 normal changes the largest two
/// neighbours have a fifth, and half with a probability below 10⁻⁵.
const JUMP: f64 = 0.5;

/// A random walk of the energy.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Walk {
    /// Variance per second, in squares of the unit of the energy.
    pub diffusion: Estimate,
    /// Twice the logarithm of the ratio of likelihoods, with and without a walk.
    pub evidence: f64,
    /// Whether the walk may be present, at a level of 5 %.
    #[serde(skip)]
    pub(crate) is_possible: bool,
    /// Whether the walk is present; else the energy is that of a trend and of noise with a short memory.
    pub is_present: bool,
}

impl Walk {
    /// The walk in batch means, under a trend that may be curved: a change of the rate is no walk.
    ///
    /// `leakage` is the part of an oscillation that the means keep: a walk that is no larger is a beat of the oscillation with the batches.
    pub(crate) fn of(batches: &Batches, means: &[f64], leakage: f64) -> Option<Self> {
        let fit = LocalLevel::fit(&batches.times, means, 3)?;
        // Means of a walk over batches move less than the walk.
        let per_second = 1.0 / (batches.spacing() * (1.0 - MEAN_DISTANCE));
        let Estimate { value, low, high } = fit.walk;
        Some(Walk {
            diffusion: Estimate {
                value: value * per_second,
                low: low * per_second,
                high: high * per_second,
            },
            evidence: fit.evidence,
            is_possible: fit.evidence > POSSIBLE
                && (value * batches.count() as f64).sqrt() > LEAKS * leakage,
            is_present: fit.evidence > PRESENT
                && !is_jump(means)
                && (value * batches.count() as f64).sqrt() > LEAKS * leakage,
        })
    }
}

/// Whether a single jump makes the means differ; the window may divide it between two changes.
fn is_jump(means: &[f64]) -> bool {
    let changes: Vec<f64> = means.windows(2).map(|pair| (pair[1] - pair[0]).powi(2)).collect();
    let total: f64 = changes.iter().sum();
    changes.windows(2).any(|pair| pair[0] + pair[1] > JUMP * total)
}
