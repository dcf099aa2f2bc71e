//! The latencies at which eigenvalues of a loop are on the unit circle.

use core::f64::consts::{PI, TAU};

use num_complex::Complex64;

use crate::LinearLoopError;
use crate::angle_grid::{AngleGrid, turned};
use crate::crossing_curves::CurvePiece;
use crate::open_channels::PartResponse;

/// An eigenvalue on the unit circle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    pub(crate) latency: f64,
    /// Its angle; none where the loop jumps.
    pub(crate) angle: Option<f64>,
    /// By how much the number of eigenvalues outside the unit circle grows; none if it is unknown.
    pub(crate) more: Option<i64>,
}

impl Crossing {
    /// Where the loop jumps, or nothing is known but that its eigenvalues change.
    pub(crate) fn jump(latency: f64) -> Self {
        Crossing { latency, angle: None, more: None }
    }
}

/// Distance of the last part of an interval from its end.
pub(crate) const BEFORE: f64 = 1e-9;

/// All crossings of the unit circle.
pub(crate) struct LatencyCrossings<'a> {
    grid: &'a AngleGrid<'a>,
    pieces: Vec<CurvePiece>,
    /// The first and last parts of the intervals in which responses are smooth.
    intervals: Vec<[f64; 2]>,
}

impl<'a> LatencyCrossings<'a> {
    /// Of responses that change little within one of `count` parts of a period.
    pub(crate) fn new(grid: &'a AngleGrid<'a>, count: f64) -> Result<Self, LinearLoopError> {
        let breaks = grid.open.breaks();
        let ends = breaks.iter().skip(1).chain([&1.0]);
        let intervals: Vec<[f64; 2]> =
            breaks.iter().zip(ends).map(|(&from, &to)| [from, (to - BEFORE).max(from)]).collect();
        let parts = |&[from, to]: &[f64; 2]| -> Vec<f64> {
            let count = (count * (to - from)).ceil().max(4.0) as u32;
            (0..=count).map(|i| from + (to - from) * f64::from(i) / f64::from(count)).collect()
        };
        let pieces = grid.curves(&intervals.iter().map(parts).collect::<Vec<_>>())?;
        Ok(LatencyCrossings { grid, pieces, intervals })
    }

    /// The interval in which a part is.
    fn smooth(&self, part: f64) -> [f64; 2] {
        let begun = self.intervals.iter().rev().find(|[from, _]| *from <= part);
        begun.copied().unwrap_or([0.0, 1.0 - BEFORE])
    }

    /// All crossings with this number of whole periods, by rising latency.
    pub(crate) fn at(&self, whole: u64) -> Result<Vec<Crossing>, LinearLoopError> {
        let mut found: Vec<Crossing> = Vec::new();
        for guess in self.guesses(whole) {
            if let Some(crossing) = self.refined(whole, guess)? {
                found.push(crossing);
            }
        }
        found.sort_by(|a, b| a.latency.total_cmp(&b.latency));
        found.dedup_by(|b, a| {
            let same = (b.latency - a.latency).abs() <= 1e-12 * a.latency.max(1.0);
            // Two that happen to be at one latency count both.
            let apart = a.angle.zip(b.angle).is_some_and(|(a, b)| (a - b).abs() > 1e-6);
            if same && apart {
                a.more = a.more.zip(b.more).map(|(a, b)| a + b);
            }
            same
        });
        Ok(found)
    }

    /// Parts and angles near which `zᵏ` is a locus: on each piece of a curve the phase of their quotient passes a multiple of a turn.
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
        let [first, last] = self.smooth(part);
        // Of the loci, in the order of distance from `zᵏ`.
        let errors = |response: &PartResponse, angle: f64| -> Vec<Complex64> {
            let delay = Complex64::from_polar(1.0, k * angle);
            let loci = self.grid.loci(response, angle).into_iter();
            let mut errors: Vec<Complex64> = loci.map(|locus| delay - locus).collect();
            errors.sort_by(|a, b| a.norm_sqr().total_cmp(&b.norm_sqr()));
            errors
        };
        let error = |response: &PartResponse, angle: f64| errors(response, angle)[0];
        let (mut moved, mut outward) = (f64::INFINITY, 0.0);
        for _ in 0..30 {
            let response = self.grid.open.response(part)?;
            let now = error(&response, angle);
            let step = 1e-6;
            let other = if part < 0.5 * (first + last) { part + step } else { part - step };
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
            part = (part + limit * d_part).clamp(first - 1e-6, last + BEFORE);
            angle += limit * d_angle;
            let change = d_part.abs() + d_angle.abs();
            if change < 1e-14 * (k + 1.0) || change < 1e-9 && change >= moved {
                break;
            }
            moved = change;
            part = part.clamp(first, last);
        }
        let part = part.clamp(first, last);
        let left = errors(&self.grid.open.response(part)?, angle);
        let holds = left[0].norm() < 1e-7 && (-1e-12..=PI + 1e-7).contains(&angle);
        let angle = angle.clamp(0.0, PI);
        let real = !(1e-9..=PI - 1e-9).contains(&angle);
        let count = if real { 1 } else { 2 };
        let several = left.get(1).is_some_and(|other| other.norm() < 1e-4);
        let more = match outward {
            _ if several => None,
            0.0 => None,
            outward => Some(if outward > 0.0 { count } else { -count }),
        };
        let latency = k + part;
        Ok(holds.then_some(Crossing { latency, angle: Some(angle), more }))
    }
}
