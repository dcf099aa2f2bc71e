//! Curves on which an open loop has unit gain.

use core::f64::consts::PI;

use num_complex::Complex64;

use crate::LinearLoopError;
use crate::angle_grid::{AngleGrid, ROUNDING, UnitGain, excess, turned};

impl AngleGrid<'_> {
    /// The unit gains for all parts of a period in each of these intervals, as curves over the part.
    pub(crate) fn curves(
        &self,
        intervals: &[Vec<f64>],
    ) -> Result<Vec<CurvePiece>, LinearLoopError> {
        let mut pieces = Vec::new();
        let at = |part: f64| -> Result<Column, LinearLoopError> {
            let response = self.open.response(part)?;
            let ends = self.end_loci(&response);
            Ok(Column { part, gains: self.unit_gains(&response), ends })
        };
        for parts in intervals {
            let mut from = at(parts.first().copied().unwrap_or(0.0))?;
            for &part in parts.iter().skip(1) {
                let to = at(part)?;
                join(&mut pieces, &at, &from, &to, DEEPEST)?;
                from = to;
            }
        }
        Ok(pieces)
    }
}

/// All unit gains for one part of a period.
struct Column {
    part: f64,
    gains: Vec<UnitGain>,
    /// The loci without a turn per period and with half of one.
    ends: [Vec<Complex64>; 2],
}

impl Column {
    /// The numbers of loci at an end that are outside the unit circle, of the real ones to its right and to its left. A locus on the
    /// circle is on neither side.
    fn outside(&self, end: usize) -> [usize; 3] {
        let loci = || self.ends[end].iter().filter(|locus| excess(**locus) > ROUNDING);
        let real = |sign: f64| {
            let real = |locus: &&Complex64| locus.im.abs() < 1e-6 * locus.norm();
            loci().filter(real).filter(|locus| sign * locus.re > 0.0).count()
        };
        [loci().count(), real(1.0), real(-1.0)]
    }

    fn is_at_circle(&self, end: usize) -> bool {
        self.ends[end].iter().any(|locus| excess(*locus).abs() < ROUNDING)
    }
}

/// A piece of a curve of unit gain, between two parts of a period. Where two curves meet it connects them at one part.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CurvePiece {
    pub(crate) parts: [f64; 2],
    pub(crate) gains: [UnitGain; 2],
}

/// Halvings of an interval of parts in which curves begin, end or move far.
const DEEPEST: u32 = 14;

/// Distance of two curves that need not be told apart, in rad.
const CLOSE: f64 = 1e-5;

/// The unit gain of `to` that continues each of `from`; none where one is not clear.
fn continued(from: &Column, to: &Column) -> Option<Vec<UnitGain>> {
    let distance =
        |a: &UnitGain, b: &UnitGain| (b.angle - a.angle).abs() + turned(a.phase, b.phase).abs();
    let mut free: Vec<UnitGain> = to.gains.clone();
    let mut next = Vec::with_capacity(free.len());
    for (i, a) in from.gains.iter().enumerate() {
        let order = |(_, b): &(usize, &UnitGain), (_, c): &(usize, &UnitGain)| {
            distance(a, b).total_cmp(&distance(a, c))
        };
        let (k, _) = free.iter().enumerate().min_by(order)?;
        let b = free.remove(k);
        // Others whose phase differs are other loci.
        let before = from.gains.iter().enumerate().filter(|(k, _)| *k != i).map(|(_, g)| g);
        let after = to.gains.iter().filter(|g| g.angle != b.angle || g.phase != b.phase);
        let alike = before.chain(after).filter(|g| turned(g.phase, a.phase).abs() < 1.5);
        let room = alike.map(|g| (g.angle - a.angle).abs()).fold(PI, f64::min).max(CLOSE);
        let close = turned(a.phase, b.phase).abs() < 0.7 && (b.angle - a.angle).abs() < 0.5 * room;
        if !close {
            return None;
        }
        next.push(b);
    }
    free.is_empty().then_some(next)
}

/// Joins the unit gains at the ends of an interval of parts.
fn join(
    pieces: &mut Vec<CurvePiece>,
    at: &impl Fn(f64) -> Result<Column, LinearLoopError>,
    from: &Column,
    to: &Column,
    depth: u32,
) -> Result<(), LinearLoopError> {
    let parts = [from.part, to.part];
    let passes = |end: usize| {
        let known = !from.is_at_circle(end) && !to.is_at_circle(end);
        known && from.outside(end) != to.outside(end)
    };
    if !passes(0)
        && !passes(1)
        && let Some(next) = continued(from, to)
    {
        let pairs = from.gains.iter().zip(next);
        pieces.extend(pairs.map(|(&a, b)| CurvePiece { parts, gains: [a, b] }));
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
        let alike = to.gains.iter().filter(|b| turned(a.phase, b.phase).abs() < 1.5);
        let nearest = alike.min_by(|b, c| near(b).total_cmp(&near(c)));
        let real = if a.angle < 0.5 * PI { (0, 0.0) } else { (1, PI) };
        let on_circle = |b: &&Complex64, c: &&Complex64| {
            let off = |locus: &Complex64| excess(*locus).abs();
            off(b).total_cmp(&off(c))
        };
        let end = from.ends[real.0].iter().min_by(on_circle);
        let end = end.map_or(*a, |end| UnitGain { angle: real.1, phase: end.arg() });
        let b = nearest.copied().filter(|b| near(&b) < (a.angle - real.1).abs()).unwrap_or(end);
        pieces.push(CurvePiece { parts, gains: [*a, b] });
    }
    for (k, angle) in [0.0, PI].into_iter().enumerate() {
        if passes(k) {
            let gains = from.ends[k].iter().map(|end| UnitGain { angle, phase: end.arg() });
            pieces.extend(gains.map(|gain| CurvePiece { parts, gains: [gain; 2] }));
        }
    }
    for column in [from, to] {
        let parts = [column.part; 2];
        for (k, &a) in column.gains.iter().enumerate() {
            let after = column.gains[k + 1..].iter().take_while(|b| b.angle - a.angle < 0.05);
            let alike = after.filter(|b| turned(a.phase, b.phase).abs() < 1.5);
            pieces.extend(alike.take(1).map(|&b| CurvePiece { parts, gains: [a, b] }));
        }
        for (k, angle) in [0.0, PI].into_iter().enumerate() {
            let last = column.gains.iter().filter(|gain| (gain.angle - angle).abs() < 0.05);
            for &gain in last {
                let ends = column.ends[k].iter().map(|end| UnitGain { angle, phase: end.arg() });
                let alike = ends.filter(|end| turned(gain.phase, end.phase).abs() < 1.5);
                pieces.extend(alike.map(|end| CurvePiece { parts, gains: [gain, end] }));
            }
        }
    }
    Ok(())
}
