//! Curves on which an open loop has unit gain.

use core::f64::consts::{PI, TAU};

use num_complex::Complex64;

use crate::hessenberg::Resolved;
use crate::open_channel::{OpenChannel, PartResponse};
use crate::{LinearLoopError, Matrix, eigenvalues};

/// A frequency at which the open loop has unit gain.
#[derive(Clone, Copy, Debug)]
pub(crate) struct UnitGain {
    /// The angle per period, from 0 to π rad.
    pub(crate) angle: f64,
    /// The phase of the response in rad.
    pub(crate) phase: f64,
}

/// The responses of an open loop at many angles.
pub(crate) struct AngleGrid<'a> {
    pub(crate) open: &'a OpenChannel<'a>,
    /// Each with its angle, in rising order from almost 0 to π.
    pub(crate) points: Vec<(f64, Resolved)>,
}

/// The slowest angle, in rad.
const SLOWEST: f64 = 1e-9;

/// Angles in equal distances.
const EVEN: u32 = 256;

/// Logarithm of a gain that is no more than rounding.
const ROUNDING: f64 = 1e-11;

/// Least distance from the unit circle that widens the grid around an eigenvalue.
const NEAREST: f64 = 1e-8;

impl<'a> AngleGrid<'a> {
    /// A grid that is dense where the open loop and the closed loop `closed` have eigenvalues near the unit circle.
    pub(crate) fn new(open: &'a OpenChannel<'a>, closed: &Matrix) -> Self {
        let mut angles: Vec<f64> =
            (1..=EVEN).map(|k| PI * f64::from(k) / f64::from(EVEN)).chain([SLOWEST]).collect();
        let near = |value: &Complex64| (0.2..5.0).contains(&value.norm());
        let mut values = open.eigenvalues();
        values.extend(eigenvalues(closed).unwrap_or_default());
        for value in values.into_iter().filter(|value| near(value) && value.im >= 0.0) {
            // From a quarter of its distance on, in ratios of √2.
            let distance = value.norm().ln().abs().max(NEAREST);
            let steps = core::iter::successors(Some(0.25 * distance), |step| Some(1.414 * step));
            let away = steps.take_while(|step| *step < PI).flat_map(|step| [-step, step]);
            // Not the eigenvalue itself, which may be a pole of the response.
            angles.extend(away.map(|step| value.arg() + step));
        }
        angles.retain(|angle| (SLOWEST..=PI).contains(angle));
        angles.sort_by(f64::total_cmp);
        angles.dedup_by(|b, a| *b - *a < 1e-3 * SLOWEST);
        let points = angles.into_iter().map(|angle| (angle, open.resolved(unit(angle)))).collect();
        AngleGrid { open, points }
    }

    /// The response at an angle that need not be on the grid.
    pub(crate) fn value(&self, response: &PartResponse, angle: f64) -> Complex64 {
        let z = unit(angle);
        response.at(z, &self.open.resolved(z))
    }

    /// All angles at which the gain is 1, in rising order.
    pub(crate) fn unit_gains(&self, response: &PartResponse) -> Vec<UnitGain> {
        let excess = |value: Complex64| value.norm_sqr().ln();
        let at = |angle: f64| excess(self.value(response, angle));
        let known: Vec<(f64, f64)> = self
            .points
            .iter()
            .map(|(angle, resolved)| (*angle, excess(response.at(unit(*angle), resolved))))
            .collect();
        let mut angles = Vec::new();
        for (k, pair) in known.windows(2).enumerate() {
            let [from, to] = [pair[0], pair[1]];
            // A gain of 1 without a turn, as of many oscillators, is no crossing.
            let rounding = from.1.abs().max(to.1.abs()) < ROUNDING;
            if (from.1 > 0.0) != (to.1 > 0.0) && !rounding {
                angles.push(crossing(at, from, to));
            } else if let Some(&after) = known.get(k + 2)
                && let Some(turn) = turn(at, from, to, after)
            {
                angles.extend([crossing(at, from, turn), crossing(at, turn, after)]);
            }
        }
        angles.sort_by(f64::total_cmp);
        let phase = |angle: f64| self.value(response, angle).arg();
        angles.into_iter().map(|angle| UnitGain { angle, phase: phase(angle) }).collect()
    }

    /// The unit gains for all parts of a period, as curves over the part.
    pub(crate) fn curves(&self, parts: &[f64]) -> Result<Vec<CurvePiece>, LinearLoopError> {
        let mut pieces = Vec::new();
        let at = |part: f64| -> Result<Column, LinearLoopError> {
            let response = self.open.response(part)?;
            let ends = [0.0, PI].map(|angle| self.value(&response, angle.max(SLOWEST)));
            Ok(Column { part, gains: self.unit_gains(&response), ends })
        };
        let mut from = at(parts.first().copied().unwrap_or(0.0))?;
        for &part in parts.iter().skip(1) {
            let to = at(part)?;
            join(&mut pieces, &at, &from, &to, DEEPEST)?;
            from = to;
        }
        Ok(pieces)
    }
}

/// All unit gains for one part of a period.
struct Column {
    part: f64,
    gains: Vec<UnitGain>,
    /// The responses without a turn per period and with half of one.
    ends: [Complex64; 2],
}

/// A piece of a curve of unit gain, between two parts of a period. Where two curves meet it connects them at one part.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CurvePiece {
    pub(crate) parts: [f64; 2],
    pub(crate) gains: [UnitGain; 2],
}

/// Halvings of an interval of parts in which curves begin, end or move far.
const DEEPEST: u32 = 14;

/// Joins the unit gains at the ends of an interval of parts.
fn join(
    pieces: &mut Vec<CurvePiece>,
    at: &impl Fn(f64) -> Result<Column, LinearLoopError>,
    from: &Column,
    to: &Column,
    depth: u32,
) -> Result<(), LinearLoopError> {
    let parts = [from.part, to.part];
    let close = |i: usize| {
        let [a, b] = [from.gains[i], to.gains[i]];
        let neighbours = [from, to].into_iter().flat_map(|column| {
            let beside = |k: Option<usize>| k.and_then(|k| column.gains.get(k)).map(|g| g.angle);
            [beside(i.checked_sub(1)), beside(Some(i + 1))].into_iter().flatten()
        });
        let room = neighbours.map(|angle| (angle - a.angle).abs()).fold(PI, f64::min);
        turned(a.phase, b.phase).abs() < 0.7 && (b.angle - a.angle).abs() < 0.5 * room
    };
    // On which side of ±1 real responses are, which says nothing where they are at it.
    let sides = |column: &Column| {
        let side = |x: f64| if x.abs() < ROUNDING { 0.0 } else { x.signum() };
        column.ends.map(|end| [side(end.re - 1.0), side(end.re + 1.0)])
    };
    let passes = |k: usize| {
        let [a, b] = [sides(from)[k], sides(to)[k]];
        a[0] * b[0] < 0.0 || a[1] * b[1] < 0.0
    };
    let alike = from.gains.len() == to.gains.len() && !passes(0) && !passes(1);
    if alike && (0..from.gains.len()).all(close) {
        let pairs = from.gains.iter().zip(&to.gains);
        pieces.extend(pairs.map(|(&a, &b)| CurvePiece { parts, gains: [a, b] }));
        return Ok(());
    }
    if depth > 0 {
        let middle = at(0.5 * (parts[0] + parts[1]))?;
        join(pieces, at, from, &middle, depth - 1)?;
        return join(pieces, at, &middle, to, depth - 1);
    }
    // Neighbours of either end: curves go on, turn round, or end where the response is real.
    for a in &from.gains {
        let near = |b: &&UnitGain| (b.angle - a.angle).abs();
        let nearest = to.gains.iter().min_by(|b, c| near(b).total_cmp(&near(c)));
        let real = if a.angle < 0.5 * PI { (0, 0.0) } else { (1, PI) };
        let end = UnitGain { angle: real.1, phase: from.ends[real.0].arg() };
        let b = nearest.copied().filter(|b| near(&b) < (a.angle - real.1).abs()).unwrap_or(end);
        pieces.push(CurvePiece { parts, gains: [*a, b] });
    }
    for (k, angle) in [0.0, PI].into_iter().enumerate() {
        if passes(k) {
            let gain = UnitGain { angle, phase: from.ends[k].arg() };
            pieces.push(CurvePiece { parts, gains: [gain; 2] });
        }
    }
    for column in [from, to] {
        for pair in column.gains.windows(2) {
            let parts = [column.part; 2];
            if pair[1].angle - pair[0].angle < 0.05 {
                pieces.push(CurvePiece { parts, gains: [pair[0], pair[1]] });
            }
        }
        for end in [0.0, PI] {
            let phase = column.ends[usize::from(end > 0.0)].arg();
            let last = column.gains.iter().filter(|gain| (gain.angle - end).abs() < 0.05);
            let end = UnitGain { angle: end, phase };
            pieces.extend(
                last.map(|&gain| CurvePiece { parts: [column.part; 2], gains: [gain, end] }),
            );
        }
    }
    Ok(())
}

/// A number of the unit circle.
pub(crate) fn unit(angle: f64) -> Complex64 {
    // Exactly real at its ends.
    if angle == PI { Complex64::from(-1.0) } else { Complex64::from_polar(1.0, angle) }
}

/// The angle from one phase to another, within half a turn.
pub(crate) fn turned(from: f64, to: f64) -> f64 {
    let turn = to - from;
    turn - TAU * (turn / TAU).round()
}

/// Where a function passes zero, between ends of different signs: by false positions, of which one that stays is halved.
fn crossing(f: impl Fn(f64) -> f64, mut low: (f64, f64), mut high: (f64, f64)) -> f64 {
    for i in 0..80 {
        let width = high.0 - low.0;
        if width <= 4.0 * f64::EPSILON * high.0 {
            break;
        }
        let secant = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
        let inside = low.0 < secant && secant < high.0;
        let at = if inside && i % 4 != 3 { secant } else { 0.5 * (low.0 + high.0) };
        let value = f(at);
        if value.abs() < 1e-13 {
            return at;
        }
        match (value > 0.0) == (low.1 > 0.0) {
            true => (low, high.1) = ((at, value), 0.5 * high.1),
            false => (high, low.1) = ((at, value), 0.5 * low.1),
        }
    }
    0.5 * (low.0 + high.0)
}

/// A point of the other sign between three of one sign, where the parabola through them may have one.
fn turn(f: impl Fn(f64) -> f64, a: (f64, f64), b: (f64, f64), c: (f64, f64)) -> Option<(f64, f64)> {
    let sign = 1.0_f64.copysign(b.1);
    let [fa, fb, fc] = [a.1, b.1, c.1].map(|value| sign * value);
    if !(fb <= fa && fb <= fc && fb >= 0.0 && fa > 0.0 && fc > 0.0) {
        return None;
    }
    // A parabola falls below its middle point by no more than this.
    if fb > (fa - fb).max(fc - fb) {
        return None;
    }
    let (mut low, mut best, mut high) = (a.0, b, c.0);
    for _ in 0..40 {
        let left = best.0 - low > high - best.0;
        let at =
            if left { best.0 - 0.382 * (best.0 - low) } else { best.0 + 0.382 * (high - best.0) };
        let value = f(at);
        if sign * value < 0.0 {
            return Some((at, value));
        }
        let better = sign * value < sign * best.1;
        match (left, better) {
            (true, true) => (high, best) = (best.0, (at, value)),
            (true, false) => low = at,
            (false, true) => (low, best) = (best.0, (at, value)),
            (false, false) => high = at,
        }
    }
    None
}
