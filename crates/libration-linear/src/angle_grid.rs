//! The responses of an open loop at many angles, and its unit gains.

use core::f64::consts::{PI, TAU};

use num_complex::Complex64;

use crate::hessenberg::Resolved;
use crate::open_channels::{OpenChannels, PartResponse};
use crate::{Matrix, eigenvalues};

/// An angle at which a characteristic locus of the open loop is on the unit circle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct UnitGain {
    /// The angle per period, from 0 to π rad.
    pub(crate) angle: f64,
    /// The phase of the locus in rad.
    pub(crate) phase: f64,
}

/// The responses of an open loop at many angles.
pub(crate) struct AngleGrid<'a> {
    pub(crate) open: &'a OpenChannels<'a>,
    /// Each with its angle, in rising order from almost 0 to π, or to almost π where the response has a pole there.
    pub(crate) points: Vec<(f64, Resolved)>,
}

/// The slowest angle, in rad.
const SLOWEST: f64 = 1e-9;

/// The slowest angle of several channels beside the slowest motion of the loop. Loci of different sizes lose digits nearer to zero,
/// where those of integrators grow without bound.
const SLOW: f64 = 1e-4;

/// Angles in equal distances.
const EVEN: u32 = 256;

/// Logarithm of a gain that is no more than rounding.
pub(crate) const ROUNDING: f64 = 1e-11;

/// Least distance from the unit circle that widens the grid around an eigenvalue.
const NEAREST: f64 = 1e-8;

/// Logarithm of the gain up to which a locus counts as one on the unit circle with another there.
const ALIKE: f64 = 1e-9;

/// Twice the logarithm of a gain.
pub(crate) fn excess(value: Complex64) -> f64 {
    value.norm_sqr().ln()
}

impl<'a> AngleGrid<'a> {
    /// A grid that is dense where the open loop and the closed loop `closed` have eigenvalues near the unit circle.
    pub(crate) fn new(open: &'a OpenChannels<'a>, closed: &Matrix) -> Self {
        // Latencies of the channels turn loci against each other.
        let even = EVEN + 16 * open.most_periods().min(160) as u32;
        let mut angles: Vec<f64> =
            (1..=even).map(|k| PI * f64::from(k) / f64::from(even)).collect();
        let near = |value: &Complex64| (0.2..5.0).contains(&value.norm());
        let mut values = open.eigenvalues();
        values.extend(eigenvalues(closed).unwrap_or_default());
        let mut slowest = SLOWEST;
        if open.channels() > 1 {
            let from_rest = values.iter().map(|value| (value - 1.0).norm());
            slowest = SLOW * from_rest.filter(|off| *off > 100.0 * NEAREST).fold(1.0, f64::min);
        }
        for value in values.into_iter().filter(|value| near(value) && value.im >= 0.0) {
            // From a quarter of its distance on, in ratios of √2.
            let distance = value.norm().ln().abs().max(NEAREST);
            let steps = core::iter::successors(Some(0.25 * distance), |step| Some(1.414 * step));
            let away = steps.take_while(|step| *step < PI).flat_map(|step| [-step, step]);
            // Not the eigenvalue itself, which may be a pole of the response.
            angles.extend(away.map(|step| value.arg() + step));
        }
        // The response has a pole where the open loop has an eigenvalue, such as -1 of a motion that alternates.
        let poles = open.eigenvalues();
        let is_pole =
            |angle: f64| poles.iter().any(|pole| (pole - unit(angle)).norm() < 0.5 * SLOWEST);
        let last = if is_pole(PI) { PI - SLOWEST } else { PI };
        angles.extend([slowest, last]);
        angles.retain(|&angle| (slowest..=last).contains(&angle) && !is_pole(angle));
        angles.sort_by(f64::total_cmp);
        angles.dedup_by(|b, a| *b - *a < 1e-3 * SLOWEST);
        let points = angles.into_iter().map(|angle| (angle, open.resolved(unit(angle)))).collect();
        AngleGrid { open, points }
    }

    /// The loci at an angle that need not be on the grid, from the largest on.
    pub(crate) fn loci(&self, response: &PartResponse, angle: f64) -> Vec<Complex64> {
        let z = unit(angle);
        response.loci(z, &self.open.resolved(z))
    }

    /// The loci at both ends of the grid.
    pub(crate) fn end_loci(&self, response: &PartResponse) -> [Vec<Complex64>; 2] {
        let slowest = self.points.first().map_or(SLOWEST, |(angle, _)| *angle);
        let last = self.points.last().map_or(PI, |(angle, _)| *angle);
        [slowest, last].map(|angle| self.loci(response, angle))
    }

    /// All angles at which a locus is on the unit circle, in rising order. The sizes of loci in their order are continuous.
    pub(crate) fn unit_gains(&self, response: &PartResponse) -> Vec<UnitGain> {
        let loci = |(angle, resolved): &(f64, Resolved)| response.loci(unit(*angle), resolved);
        let known: Vec<Vec<Complex64>> = self.points.iter().map(loci).collect();
        let mut gains: Vec<UnitGain> = Vec::new();
        for place in 0..self.open.channels() {
            let at = |angle: f64| excess(self.loci(response, angle)[place]);
            let angles = self.points.iter().map(|(angle, _)| *angle);
            let along =
                angles.zip(known.iter().map(|loci| excess(loci[place]))).collect::<Vec<_>>();
            for angle in unit_crossings(at, &along) {
                let loci = self.loci(response, angle);
                let alike = loci.iter().enumerate();
                let alike = alike.filter(|(k, locus)| *k == place || excess(**locus).abs() < ALIKE);
                gains.extend(alike.map(|(_, locus)| UnitGain { angle, phase: locus.arg() }));
            }
        }
        gains.sort_by(|a, b| a.angle.total_cmp(&b.angle));
        let mut distinct: Vec<UnitGain> = Vec::with_capacity(gains.len());
        for gain in gains {
            let before = distinct.iter().rev().take_while(|b| gain.angle - b.angle < 1e-7);
            let mut before = before.filter(|b| turned(b.phase, gain.phase).abs() < 1e-6);
            if self.open.channels() == 1 || before.next().is_none() {
                distinct.push(gain);
            }
        }
        distinct
    }
}

/// The angles at which a function with these values passes zero.
fn unit_crossings(at: impl Fn(f64) -> f64, known: &[(f64, f64)]) -> Vec<f64> {
    let mut angles = Vec::new();
    for (k, pair) in known.windows(2).enumerate() {
        let [from, to] = [pair[0], pair[1]];
        // A gain of 1 without a turn, as of many oscillators, is no crossing.
        let rounding = from.1.abs().max(to.1.abs()) < ROUNDING;
        if (from.1 > 0.0) != (to.1 > 0.0) && !rounding {
            angles.push(crossing(&at, from, to));
        } else if let Some(&after) = known.get(k + 2)
            && let Some(turn) = turn(&at, from, to, after)
        {
            angles.extend([crossing(&at, from, turn), crossing(&at, turn, after)]);
        }
    }
    angles
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
