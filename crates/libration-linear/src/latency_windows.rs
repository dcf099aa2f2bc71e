//! The latencies of channels at which a loop is stable.

use crate::angle_grid::AngleGrid;
use crate::latency_crossings::{BEFORE, Crossing, LatencyCrossings};
use crate::open_channels::OpenChannels;
use crate::{Channels, LinearLoop, LinearLoopError, LoopTiming};

/// An interval of latencies of channels within which a loop is stable, in periods.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LatencyWindow {
    /// The smallest latency.
    pub from: f64,
    /// The largest latency; none if the loop stays stable up to the largest that was analysed.
    pub to: Option<f64>,
    /// The angle in rad per period by which the loop turns at the largest latency; none without one.
    pub angle: Option<f64>,
}

/// Distance from a crossing at which eigenvalues are counted, relative to the interval between two crossings.
const BESIDE: f64 = 1e-3;

impl LinearLoop {
    /// The windows of stable latencies that `channels` have together, in addition to those in `timing`: in rising order, all that begin
    /// below `until`, and those up to it; at most up to `most`. All else is as in `timing`, without jitter and losses.
    ///
    /// Windows end where an eigenvalue is on the unit circle. With the channels open, the matrix of responses `G_f` of the loop depends
    /// on the part `f` of a period only: all crossings of a latency of `k + f` periods solve `det(zᵏ − G_f(z)) = 0` on curves where an
    /// eigenvalue of `G_f` has size 1. Between two of them the number of eigenvalues outside the circle is that of Nyquist's criterion,
    /// and is the same at both ends of the interval (J. E. Marshall, H. Górecki, A. Korytowski, K. Walton, *Time-Delay Systems*, 1992,
    /// for continuous time).
    ///
    /// # Errors
    /// [`LinearLoopError`]: an invalid timing or channel, or a schedule of several controllers.
    pub fn latency_windows(
        &self,
        timing: &LoopTiming,
        channels: &Channels,
        [until, most]: [f64; 2],
    ) -> Result<Vec<LatencyWindow>, LinearLoopError> {
        self.only_controller("windows of latency")?;
        let open = OpenChannels::new(self, timing, channels)?;
        let grid = AngleGrid::new(&open, &self.period_matrix(timing)?);
        if self.plant().sampling_period.is_some() {
            return whole_windows(&grid, until, most);
        }
        let turn = self.smooth_rate() * self.period();
        let crossings = LatencyCrossings::new(&grid, (16.0 + 8.0 * turn).min(512.0))?;
        // Samples see commands that take over at the same time, or those before.
        let jumps = if self.plant().d.largest() > 0.0 { open.breaks() } else { Vec::new() };
        Search { grid: &grid, crossings, jumps }.windows(until, most)
    }
}

struct Search<'a> {
    grid: &'a AngleGrid<'a>,
    crossings: LatencyCrossings<'a>,
    /// The parts of a period at which the loop jumps.
    jumps: Vec<f64>,
}

impl Search<'_> {
    /// The windows between crossings.
    fn windows(&self, until: f64, most: f64) -> Result<Vec<LatencyWindow>, LinearLoopError> {
        let mut windows: Vec<LatencyWindow> = Vec::new();
        let mut begun: Option<f64> = None;
        let mut from = Crossing::jump(0.0);
        // The number of eigenvalues outside before `from`, while it follows from the crossings.
        let mut outside: Option<i64> = None;
        for whole in 0..most.ceil() as u64 {
            let mut ends = self.crossings.at(whole)?;
            let next = (whole + 1) as f64;
            if !self.jumps.is_empty() {
                let inside = self.jumps.iter().filter(|part| **part > 0.0);
                ends.extend(inside.map(|part| Crossing::jump(whole as f64 + part)));
                ends.sort_by(|a, b| a.latency.total_cmp(&b.latency));
            }
            // Beyond `until` one unstable interval ends the search.
            let ends_here = begun.is_none() && next > until;
            if !self.jumps.is_empty() || ends_here || next >= most {
                ends.push(Crossing::jump(next.min(most)));
            }
            for end in ends.into_iter().filter(|end| end.latency <= most) {
                let expected = outside.zip(from.more).map(|(before, more)| before + more);
                // In an unstable interval the crossings are enough.
                let parts = match expected {
                    Some(expected @ 1..) => vec![(end, expected)],
                    _ => self.intervals(from.latency, end)?,
                };
                for (part_end, count) in parts {
                    match (count, begun) {
                        (0, None) => begun = Some(from.latency),
                        (1.., Some(begin)) => {
                            let to = Some(from.latency);
                            windows.push(LatencyWindow { from: begin, to, angle: from.angle });
                            begun = None;
                        }
                        _ => {}
                    }
                    if count > 0 && from.latency >= until {
                        return Ok(windows);
                    }
                    (from, outside) = (part_end, Some(count));
                }
            }
            // Counted anew from time to time.
            outside = outside.filter(|_| whole % 8 != 7);
        }
        windows.extend(begun.map(|from| LatencyWindow { from, to: None, angle: None }));
        Ok(windows)
    }

    /// An interval without crossings, and the number of eigenvalues outside the unit circle in it. Where these differ at its ends,
    /// a crossing was missed, and the interval has two parts.
    fn intervals(&self, from: f64, end: Crossing) -> Result<Vec<(Crossing, i64)>, LinearLoopError> {
        let width = end.latency - from;
        if width <= 1e-12 * end.latency.max(1.0) {
            return Ok(Vec::new());
        }
        let [mut low, mut high] = [from + BESIDE * width, end.latency - BESIDE * width];
        let [first, last] = [self.unstable_at(low)?, self.unstable_at(high)?];
        if first == last {
            return Ok(vec![(end, first)]);
        }
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if self.unstable_at(middle)? == first { low = middle } else { high = middle }
        }
        Ok(vec![(Crossing::jump(low), first), (end, last)])
    }

    /// The number of eigenvalues outside the unit circle with a latency.
    fn unstable_at(&self, latency: f64) -> Result<i64, LinearLoopError> {
        let whole = latency.floor();
        let response = self.grid.open.response((latency - whole).min(1.0 - BEFORE))?;
        self.grid.unstable(&response, whole as u64)
    }
}

/// The windows of a plant that is sampled: from one whole latency to another.
fn whole_windows(
    grid: &AngleGrid<'_>,
    until: f64,
    most: f64,
) -> Result<Vec<LatencyWindow>, LinearLoopError> {
    let response = grid.open.response(0.0)?;
    let mut windows: Vec<LatencyWindow> = Vec::new();
    let mut begun = None;
    for whole in 0..=most as u64 {
        match (grid.unstable(&response, whole)? == 0, begun) {
            (true, None) => begun = Some(whole as f64),
            (false, Some(from)) => {
                let to = Some((whole - 1) as f64);
                windows.push(LatencyWindow { from, to, angle: None });
                begun = None;
            }
            _ => {}
        }
        if begun.is_none() && whole as f64 > until {
            return Ok(windows);
        }
    }
    windows.extend(begun.map(|from| LatencyWindow { from, to: None, angle: None }));
    Ok(windows)
}
