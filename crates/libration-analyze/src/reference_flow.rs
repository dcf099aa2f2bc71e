//! The exact flow of a system to about thirty digits: the reference of every error.
//!
//! The explicit midpoint rule has an error with even powers of the step only, so that each column
//! of the extrapolation wins two orders (Gragg; Hairer, Nørsett, Wanner: Solving Ordinary
//! Differential Equations I, §II.9). It shares no line with the integrators under study.

use libration::equations::{Dynamics, Evaluation};
use libration::number::TwoFloat;
use libration::{Elementary, Float, Scalar};

/// Columns of the extrapolation: order 20.
const COLUMNS: usize = 10;

/// The pieces into which a time is cut are halved until that changes nothing beyond this.
const TARGET: f64 = 1e-28;

/// Beyond this many pieces rounding would be worse than what is left.
const MOST_PIECES: u32 = 1 << 10;

/// Positions, then velocities.
pub type Point = Vec<TwoFloat>;

/// The rates of change of positions and velocities, on numbers of type `S`.
#[derive(Debug)]
pub struct Rates<'p, S> {
    accelerations: Evaluation<'p, S>,
}

impl<'p, S: Elementary> Rates<'p, S> {
    /// Those of a system whose inputs are zero.
    pub fn new(dynamics: &'p Dynamics) -> Self {
        Rates { accelerations: dynamics.accelerations().on() }
    }

    /// The rates at positions and velocities.
    pub fn at(&mut self, state: &[S]) -> Vec<S> {
        let mut rates = Vec::with_capacity(state.len());
        rates.extend_from_slice(&state[state.len() / 2..]);
        rates.extend(self.accelerations.run(state));
        rates
    }
}

/// The state that a system reaches from `start` after `time` seconds, and its distance from the one with pieces twice as long.
pub fn flow(rates: &mut Rates<'_, TwoFloat>, start: &[TwoFloat], time: TwoFloat) -> (Point, f64) {
    let mut after = |pieces: u32| {
        let piece = time.ratio(1, pieces as i32);
        (0..pieces).fold(start.to_vec(), |state, _| self::piece(rates, &state, piece).0)
    };
    let (mut pieces, mut coarse) = (2, after(1));
    loop {
        let fine = after(pieces);
        let apart = distance(&fine, &coarse);
        // What rests at the origin has no size.
        let off = if apart == 0.0 { 0.0 } else { apart / size(&fine) };
        // What is not a number may become one in shorter pieces.
        if off <= TARGET || pieces >= MOST_PIECES {
            return (fine, off);
        }
        (pieces, coarse) = (2 * pieces, fine);
    }
}

/// The largest coordinate.
pub fn size(state: &[TwoFloat]) -> f64 {
    state.iter().fold(0.0, |size, x| size.max(x.to_f64().abs()))
}

/// The largest difference of a coordinate; NaN if one is.
pub fn distance(a: &[TwoFloat], b: &[TwoFloat]) -> f64 {
    let differences = a.iter().zip(b).map(|(&a, &b)| (a - b).to_f64().abs());
    differences.fold(0.0, |size, x| if x > size || x.is_nan() { x } else { size })
}

/// `x + h·y`, entry by entry.
fn plus(x: &[TwoFloat], h: TwoFloat, y: &[TwoFloat]) -> Point {
    x.iter().zip(y).map(|(&x, &y)| x + h * y).collect()
}

/// The state after one piece, by Aitken's and Neville's scheme on `2, 4, 6, …` midpoint steps, and for each state the distance from the
/// result of one order less.
pub fn piece(
    rates: &mut Rates<'_, TwoFloat>,
    start: &[TwoFloat],
    time: TwoFloat,
) -> (Point, Vec<f64>) {
    let mut row: Vec<Point> = Vec::with_capacity(COLUMNS);
    for j in 1..=COLUMNS as i32 {
        let mut value = midpoint(rates, start, time, 2 * j);
        for k in 1..j {
            // Entry k − 1 still holds the row before; its step is j/(j − k) times as long.
            let before = std::mem::replace(&mut row[k as usize - 1], value.clone());
            let (short, long) = (j - k, j);
            let (num, den) = (short * short, long * long - short * short);
            value.iter_mut().zip(&before).for_each(|(x, &before)| {
                *x = *x + (*x - before).ratio(num, den);
            });
        }
        row.push(value);
    }
    let last = row.pop().unwrap_or_default();
    let before = row.pop().unwrap_or_default();
    let off = last.iter().zip(&before).map(|(&a, &b)| (a - b).to_f64().abs()).collect();
    (last, off)
}

/// An even number `n` of steps of the explicit midpoint rule, begun by one of Euler.
fn midpoint(rates: &mut Rates<'_, TwoFloat>, start: &[TwoFloat], time: TwoFloat, n: i32) -> Point {
    let h = time.ratio(1, n);
    let two = h + h;
    let first = plus(start, h, &rates.at(start));
    let (mut before, mut now) = (start.to_vec(), first);
    for _ in 1..n {
        let next = plus(&before, two, &rates.at(&now));
        (before, now) = (now, next);
    }
    now
}
