//! The latencies of one channel at which a loop is stable.

use core::f64::consts::{PI, TAU};

use num_complex::Complex64;

use crate::crossing_curves::{AngleGrid, CurvePiece, turned};
use crate::open_channel::{OpenChannel, PartResponse};
use crate::{Channel, LinearLoop, LinearLoopError, LoopTiming};

/// An interval of latencies of a channel within which a loop is stable, in periods.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LatencyWindow {
    /// The smallest latency.
    pub from: f64,
    /// The largest latency; none if the loop stays stable up to the largest that was analysed.
    pub to: Option<f64>,
    /// The angle in rad per period by which the loop turns at the largest latency; none without one.
    pub angle: Option<f64>,
}

/// An eigenvalue on the unit circle.
#[derive(Clone, Copy, Debug)]
struct Crossing {
    latency: f64,
    /// Its angle; none where the loop jumps.
    angle: Option<f64>,
    /// By how much the number of eigenvalues outside the unit circle grows; none if it is unknown.
    more: Option<i64>,
}

impl Crossing {
    /// Where the loop jumps, or nothing is known but that its eigenvalues change.
    fn jump(latency: f64) -> Self {
        Crossing { latency, angle: None, more: None }
    }
}

/// Where a part of a period ends, as the largest below 1.
const WHOLE: f64 = 1.0 - 1e-9;

/// Distance from a crossing at which eigenvalues are counted, relative to the interval between two crossings.
const BESIDE: f64 = 1e-3;

impl LinearLoop {
    /// The windows of stable latencies of one channel, in rising order: all that begin below `until`, and those up to it; at most up to
    /// `most`. All else is as in `timing`, without jitter and losses.
    ///
    /// Windows end where an eigenvalue is on the unit circle. With the channel open, the response `G_f` of the loop depends on the part
    /// `f` of a period only: all crossings of a latency of `k + f` periods solve `zᵏ = G_f(z)` on curves with `|G_f| = 1`. Between two
    /// of them the number of eigenvalues outside the circle is that of Nyquist's criterion, and is the same at both ends of the
    /// interval (J. E. Marshall, H. Górecki, A. Korytowski, K. Walton, *Time-Delay Systems*, 1992, for continuous time).
    ///
    /// # Errors
    /// [`LinearLoopError`]: an invalid timing.
    pub fn latency_windows(
        &self,
        timing: &LoopTiming,
        channel: Channel,
        [until, most]: [f64; 2],
    ) -> Result<Vec<LatencyWindow>, LinearLoopError> {
        self.only_controller("windows of latency")?;
        let open = OpenChannel::new(self, timing, channel)?;
        let grid = AngleGrid::new(&open, &self.period_matrix(timing)?);
        let sampled = self.plant().sampling_period.is_some();
        let search = Search {
            grid: &grid,
            pieces: if sampled { Vec::new() } else { grid.curves(&self.parts())? },
            // Samples at whole periods see commands that take over there, or those before.
            jumps: self.plant().d.largest() > 0.0,
        };
        if sampled { search.whole_windows(until, most) } else { search.windows(until, most) }
    }

    /// Parts of a period between which responses change little.
    fn parts(&self) -> Vec<f64> {
        let turn = self.smooth_rate() * self.period();
        let count = (16.0 + 8.0 * turn).min(512.0) as u32;
        (0..=count).map(|i| WHOLE * f64::from(i) / f64::from(count)).collect()
    }
}

struct Search<'a> {
    grid: &'a AngleGrid<'a>,
    pieces: Vec<CurvePiece>,
    /// Whether the loop changes at whole periods.
    jumps: bool,
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
            let mut ends = self.crossings(whole)?;
            let next = (whole + 1) as f64;
            // Beyond `until` one unstable interval ends the search.
            let ends_here = begun.is_none() && next > until;
            if self.jumps || ends_here || next >= most {
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

    /// The windows of a plant that is sampled: from one whole latency to another.
    fn whole_windows(&self, until: f64, most: f64) -> Result<Vec<LatencyWindow>, LinearLoopError> {
        let response = self.grid.open.response(0.0)?;
        let mut windows: Vec<LatencyWindow> = Vec::new();
        let mut begun = None;
        for whole in 0..=most as u64 {
            match (self.grid.unstable(&response, whole) == 0, begun) {
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

    /// All crossings with this number of whole periods, by rising latency.
    fn crossings(&self, whole: u64) -> Result<Vec<Crossing>, LinearLoopError> {
        let mut found: Vec<Crossing> = Vec::new();
        for guess in self.guesses(whole) {
            if let Some(crossing) = self.refined(whole, guess)? {
                found.push(crossing);
            }
        }
        found.sort_by(|a, b| a.latency.total_cmp(&b.latency));
        found.dedup_by(|b, a| (b.latency - a.latency).abs() <= 1e-12 * a.latency.max(1.0));
        Ok(found)
    }

    /// Parts and angles near which `zᵏ = G_f(z)`: on each piece of a curve the phase of `zᵏ/G_f` passes a multiple of a turn.
    fn guesses(&self, whole: u64) -> Vec<[f64; 2]> {
        let whole = whole as f64;
        let mut guesses = Vec::new();
        // The phase at both ends of a piece.
        let phases = |piece: &CurvePiece| {
            let [a, b] = piece.gains;
            let from = whole * a.angle - a.phase;
            let on = from + whole * (b.angle - a.angle) - turned(a.phase, b.phase);
            [from, on]
        };
        for piece in &self.pieces {
            let [from, to] = phases(piece);
            let (low, high) = (from.min(to), from.max(to));
            // Where the phase turns round within the piece it goes beyond its ends, by less than a part of the change.
            let beyond =
                0.3 * (high - low) + 1e-3 * (1.0 + whole * (piece.parts[1] - piece.parts[0]));
            let first = ((low - beyond) / TAU).ceil();
            let count = ((high + beyond) / TAU).floor() - first;
            for turn in 0..=(count as i64) {
                if count < 0.0 {
                    break;
                }
                let at = TAU * (first + turn as f64);
                let share =
                    if high > low { ((at - from) / (to - from)).clamp(0.0, 1.0) } else { 0.5 };
                let between = |a: f64, b: f64| a + share * (b - a);
                let [a, b] = piece.gains;
                guesses.push([between(piece.parts[0], piece.parts[1]), between(a.angle, b.angle)]);
            }
        }
        guesses
    }

    /// The crossing near a guess, by Newton's iteration; none if there is none.
    fn refined(&self, whole: u64, guess: [f64; 2]) -> Result<Option<Crossing>, LinearLoopError> {
        let [mut part, mut angle] = guess;
        let k = whole as f64;
        let error = |response: &PartResponse, angle: f64| -> Complex64 {
            Complex64::from_polar(1.0, k * angle) - self.grid.value(response, angle)
        };
        let (mut moved, mut outward) = (f64::INFINITY, 0.0);
        for _ in 0..30 {
            let response = self.grid.open.response(part)?;
            let now = error(&response, angle);
            let step = 1e-6;
            let other = if part < 0.5 { part + step } else { part - step };
            let by_part = (error(&self.grid.open.response(other)?, angle) - now) / (other - part);
            let step = 1e-7 * angle.max(1e-3);
            let by_angle =
                (error(&response, angle + step) - error(&response, angle - step)) / (2.0 * step);
            // Of `z = e^(iθ + ρ)`, with `θ − iρ` in place of the angle.
            outward = (by_part / by_angle).im;
            let determinant = by_part.re * by_angle.im - by_part.im * by_angle.re;
            let d_part = -(now.re * by_angle.im - now.im * by_angle.re) / determinant;
            let d_angle = -(by_part.re * now.im - by_part.im * now.re) / determinant;
            if !(d_part.is_finite() && d_angle.is_finite()) {
                return Ok(None);
            }
            // No more than a tenth of a period, nor beyond its ends by more than a bit.
            let limit = (0.1 / d_part.abs()).min(0.3 * angle.max(1e-6) / d_angle.abs()).min(1.0);
            part = (part + limit * d_part).clamp(-1e-6, 1.0);
            angle += limit * d_angle;
            let change = d_part.abs() + d_angle.abs();
            if change < 1e-14 * (k + 1.0) || change < 1e-9 && change >= moved {
                break;
            }
            moved = change;
            part = part.clamp(0.0, WHOLE);
        }
        let response = self.grid.open.response(part.clamp(0.0, WHOLE))?;
        let left = error(&response, angle).norm();
        let holds = left < 1e-7 && (-1e-12..=PI + 1e-7).contains(&angle);
        let angle = angle.clamp(0.0, PI);
        let real = !(1e-9..=PI - 1e-9).contains(&angle);
        let count = if real { 1 } else { 2 };
        let more = match outward {
            0.0 => None,
            outward => Some(if outward > 0.0 { count } else { -count }),
        };
        let latency = k + part.clamp(0.0, WHOLE);
        Ok(holds.then_some(Crossing { latency, angle: Some(angle), more }))
    }

    /// The number of eigenvalues outside the unit circle with a latency.
    fn unstable_at(&self, latency: f64) -> Result<i64, LinearLoopError> {
        let whole = latency.floor();
        let response = self.grid.open.response((latency - whole).min(WHOLE))?;
        Ok(self.grid.unstable(&response, whole as u64))
    }
}
