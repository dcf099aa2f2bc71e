//! The exact flow of a system to about thirty digits: the reference of every error.
//!
//! The explicit midpoint rule has an error with even powers of the step only, so that each column
//! of the extrapolation wins two orders (Gragg; Hairer, Nørsett, Wanner: Solving Ordinary
//! Differential Equations I, §II.9). It shares no line with the integrators under study.

use libration::number::TwoFloat;
use libration::{Float, Scalar, State, System};

/// Columns of the extrapolation: order 20.
const COLUMNS: usize = 10;

/// The pieces into which a time is cut are halved until that changes nothing beyond this.
const TARGET: f64 = 1e-28;

/// Beyond this many pieces rounding would be worse than what is left.
const MOST_PIECES: u32 = 1 << 10;

/// A state of the flow, and its distance from the one with pieces twice as long.
pub(super) type Flowed<const D: usize> = (State<TwoFloat, D>, f64);

/// The state that `system` reaches from `start` after `time` seconds.
pub(super) fn flow<const D: usize>(
    system: &impl System<TwoFloat, D>,
    start: State<TwoFloat, D>,
    time: TwoFloat,
) -> Flowed<D> {
    let after = |pieces: u32| {
        let piece = time.ratio(1, pieces as i32);
        (0..pieces).fold(start, |state, _| extrapolated(system, state, piece))
    };
    let (mut pieces, mut coarse) = (2, after(1));
    loop {
        let fine = after(pieces);
        let off = distance(&fine, &coarse) / size(&fine);
        // What is not a number will not become one.
        if off <= TARGET || pieces >= MOST_PIECES || off.is_nan() {
            return (fine, off);
        }
        (pieces, coarse) = (2 * pieces, fine);
    }
}

/// The largest coordinate.
pub(super) fn size<const D: usize>(state: &State<TwoFloat, D>) -> f64 {
    state.coordinates().fold(0.0, |size, x| size.max(x.to_f64().abs()))
}

/// The largest difference of a coordinate; NaN if one is.
pub(super) fn distance<const D: usize>(a: &State<TwoFloat, D>, b: &State<TwoFloat, D>) -> f64 {
    let differences = a.coordinates().zip(b.coordinates()).map(|(a, b)| (a - b).to_f64().abs());
    differences.fold(0.0, |size, x| if x > size || x.is_nan() { x } else { size })
}

/// One piece by Aitken's and Neville's scheme on `2, 4, 6, …` midpoint steps.
fn extrapolated<const D: usize>(
    system: &impl System<TwoFloat, D>,
    start: State<TwoFloat, D>,
    time: TwoFloat,
) -> State<TwoFloat, D> {
    let mut row: Vec<State<TwoFloat, D>> = Vec::with_capacity(COLUMNS);
    for j in 1..=COLUMNS as i32 {
        let mut value = midpoint(system, start, time, 2 * j);
        for k in 1..j {
            // Entry k − 1 still holds the row before; its step is j/(j − k) times as long.
            let before = std::mem::replace(&mut row[k as usize - 1], value);
            let (short, long) = (j - k, j);
            let (num, den) = (short * short, long * long - short * short);
            let gain = value.plus(-TwoFloat::one(), before).map(|x| x.ratio(num, den));
            value = value + gain;
        }
        row.push(value);
    }
    row[COLUMNS - 1]
}

/// An even number `n` of steps of the explicit midpoint rule, begun by one of Euler.
fn midpoint<const D: usize>(
    system: &impl System<TwoFloat, D>,
    start: State<TwoFloat, D>,
    time: TwoFloat,
    n: i32,
) -> State<TwoFloat, D> {
    let h = time.ratio(1, n);
    let two = h + h;
    let (mut before, mut now) = (start, start.plus(h, system.rate(start)));
    for _ in 1..n {
        (before, now) = (now, before.plus(two, system.rate(now)));
    }
    now
}

#[cfg(test)]
mod tests {
    use libration::system::{Kepler, Oscillator};
    use libration::{Elementary, Model};

    use super::*;

    #[test]
    fn the_oscillator_follows_its_closed_form() {
        let oscillator = Model::<1>::on::<TwoFloat>(&Oscillator { omega2: 10.0 });
        let start = State { q: [TwoFloat::from_f64(0.3)], v: [TwoFloat::from_f64(-1.2)] };
        let (time, omega) = (TwoFloat::from_f64(1.7), oscillator.omega2.sqrt());
        let (found, off) = flow(&oscillator, start, time);
        let (sin, cos) = ((omega * time).sin(), (omega * time).cos());
        let exact = State {
            q: [start.q[0] * cos + start.v[0] * sin * omega.recip()],
            v: [start.v[0] * cos - start.q[0] * omega * sin],
        };
        assert!(distance(&found, &exact) < 1e-27, "{:e}", distance(&found, &exact));
        assert!(off < 1e-27, "{off:e}");
    }

    /// `E − e sin E = t` gives the time of a place in closed form, without solving for it.
    #[test]
    fn kepler_follows_keplers_equation() {
        let kepler = Kepler { mu: 1.0 };
        let system = kepler.on::<TwoFloat>();
        let constant = TwoFloat::from_f64;
        let (e, anomaly) = (constant(0.6), constant(2.0));
        let axis = constant(0.64).sqrt();
        let time = anomaly - e * anomaly.sin();
        let perihelion = State {
            q: [TwoFloat::one() - e, TwoFloat::zero()],
            v: [TwoFloat::zero(), ((TwoFloat::one() + e) * (TwoFloat::one() - e).recip()).sqrt()],
        };
        let (found, _) = flow(&system, perihelion, time);
        // 1 − 0.6² and 0.64 differ by rounding of the constants.
        let exact = [anomaly.cos() - e, axis * anomaly.sin()];
        for (found, exact) in found.q.iter().zip(exact) {
            assert!((*found - exact).to_f64().abs() < 1e-15);
        }
        let energy = |s: &State<TwoFloat, 2>| libration::Hamiltonian::energy(&system, s);
        let change = (energy(&found) - energy(&perihelion)).to_f64();
        assert!(change.abs() < 1e-27, "{change:e}");
    }
}
