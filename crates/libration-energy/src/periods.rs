//! Periods of a fluctuation, and what they leave in batch means.

use core::f64::consts::PI;

/// Periods that a batch should have.
const PERIODS: f64 = 6.0;
/// Blocks in a batch: their averages have the periods that a batch leaves, down to an eighth of a batch for noise without memory.
const BLOCKS: usize = 32;
/// Blocks in a batch, and their distance, at which averages must not be correlated any more.
const NEAR: (usize, usize) = (8, 2);
/// The largest correlation at a quarter of a batch: a memory of a ninth of the batch.
const CORRELATION: f64 = 0.1;
/// Numbers of batches.
const COUNTS: [usize; 8] = [48, 40, 32, 26, 21, 17, 14, 12];
/// Samples that a batch should have.
const SAMPLES: usize = 8;

/// The fluctuation of block averages.
#[derive(Clone, Copy, Debug)]
struct Level {
    /// Mean period by the changes of sign, in samples.
    period: f64,
    /// Amplitude of a sine with the same variance.
    amplitude: f64,
    /// Correlation of averages at the distance of [`NEAR`].
    correlation: f64,
}

/// Levels of block averages of 1, 2, 4, … samples.
#[derive(Clone, Debug)]
pub(crate) struct Periods {
    levels: Vec<Level>,
    samples: usize,
}

impl Periods {
    /// The periods of residuals about a trend.
    pub(crate) fn of(residuals: &[f64]) -> Self {
        let mut values = residuals.to_vec();
        let (mut levels, mut block) = (Vec::new(), 1_usize);
        while values.len() >= BLOCKS {
            let changes = values.windows(2).filter(|pair| pair[0] * pair[1] < 0.0).count();
            let variance = values.iter().map(|x| x * x).sum::<f64>() / values.len() as f64;
            levels.push(Level {
                period: 2.0 * (values.len() * block) as f64 / changes.max(1) as f64,
                amplitude: (2.0 * variance).sqrt(),
                correlation: values
                    .windows(NEAR.1 + 1)
                    .map(|part| part[0] * part[NEAR.1])
                    .sum::<f64>()
                    / (variance * (values.len() - NEAR.1) as f64).max(f64::MIN_POSITIVE),
            });
            values = values.chunks_exact(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
            block *= 2;
        }
        Periods { levels, samples: residuals.len() }
    }

    /// Whether averages at a quarter of a batch are independent.
    fn forgets(&self, count: usize) -> bool {
        let block = (self.samples / count / NEAR.0).max(1).ilog2() as usize;
        self.levels.get(block).is_none_or(|level| level.correlation < CORRELATION)
    }

    fn within(&self, count: usize) -> impl Iterator<Item = &Level> {
        let most = (self.samples / count / BLOCKS).max(1);
        self.levels.iter().take(most.ilog2() as usize + 1)
    }

    /// The largest number of batches that have enough periods each, or else the smallest.
    pub(crate) fn batch_count(&self) -> usize {
        let is_long = |count: usize| {
            let length = (self.samples / count) as f64;
            self.within(count).all(|level| length >= PERIODS * level.period)
        };
        let possible = |count: &usize| self.samples / count >= SAMPLES;
        let mut counts = COUNTS.into_iter().filter(possible);
        counts
            .find(|count| is_long(*count) && self.forgets(*count))
            .unwrap_or(COUNTS[COUNTS.len() - 1])
    }

    /// The largest number of batches that the samples allow.
    pub(crate) fn most_batches(&self) -> usize {
        let possible = |count: &usize| self.samples / count >= SAMPLES;
        COUNTS.into_iter().find(possible).unwrap_or(COUNTS[COUNTS.len() - 1])
    }

    /// The largest part of an oscillation that means of this many batches keep.
    pub(crate) fn leakage(&self, count: usize) -> f64 {
        let length = (self.samples / count) as f64;
        let left = |level: &Level| level.amplitude * envelope(length / level.period);
        self.within(count).map(left).fold(0.0, f64::max)
    }
}

/// The envelope of the transform of the window sin⁴ at a number of periods: sinc x / ((1 − x²)(1 − x²/4)) without the sine. Within the
/// main lobe, up to 3 periods, it is at most 1.
fn envelope(periods: f64) -> f64 {
    if periods <= 3.0 {
        return 1.0;
    }
    let x2 = periods * periods;
    4.0 / (PI * periods * (x2 - 1.0) * (x2 - 4.0))
}
