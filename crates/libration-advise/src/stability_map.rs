//! Stability maps of a loop.

use libration_report::figure::Grid;
use libration_work::Work;

use super::AdviseError;
use super::imperfection::Imperfection;
use super::loops::LoopError;
use super::subject::Subject;
use super::timed_loop::TimedLoop;

/// The growth of a loop over latency and gain.
#[derive(Clone, Debug, PartialEq)]
pub struct StabilityMap {
    /// The logarithm of the growth per period over latencies in s and factors of all gains.
    pub growth: Grid,
    /// The stated latency, in s.
    pub latency: f64,
}

/// Number of latencies and of gains.
const SIZE: [usize; 2] = [48, 32];

/// Largest latency of the map, in periods, unless more is stated.
const MOST_PERIODS: f64 = 24.0;

impl TimedLoop {
    /// The map of latencies from zero to 1.5 times the limit, and of gains from a quarter to four times.
    pub(super) fn map(
        &self,
        work: &Work<'_>,
        limit: Option<f64>,
    ) -> Result<StabilityMap, AdviseError> {
        let period = self.period();
        let subject = Subject { kind: Imperfection::Latency, channel: None };
        let stated = self.stated_size(subject);
        let reach = limit.unwrap_or(8.0 * period).max(1.2 * stated).max(0.5 * period);
        let reach = (1.5 * reach).min(MOST_PERIODS * period).max(1.2 * stated);
        // Long queues are expensive: every second line suffices.
        let coarser = if reach > 1.5 * MOST_PERIODS * period { 2 } else { 1 };
        let [columns, rows] = SIZE.map(|size| size / coarser + 1);
        let even = |i: usize, of: usize| i as f64 / (of - 1) as f64;
        let x: Vec<f64> = (0..columns).map(|i| reach * even(i, columns)).collect();
        let y: Vec<f64> = (0..rows).map(|i| 4.0_f64.powf(2.0 * even(i, rows) - 1.0)).collect();
        let lines = work.sweep("the map of stability", &y, |&factor| {
            let scaled = self.amplified(factor).map_err(LoopError::from)?;
            let at = |latency: &f64| -> Result<f64, LoopError> {
                let late = scaled.single(subject, latency / period)?;
                Ok(scaled.growth(&late)? / 2.0)
            };
            Ok::<_, AdviseError>(x.iter().map(at).collect::<Result<Vec<f64>, LoopError>>()?)
        })?;
        Ok(StabilityMap { growth: Grid { x, y, z: lines.concat() }, latency: stated })
    }
}
