//! The start of an orbit, as criteria require it.

use libration_core::number::Wide;
use libration_core::{Elementary, Scalar, State};

/// Where an orbit of an isotropic oscillator starts, as far as criteria ask: the sums of `q²`, `q·v`
/// and `v²` over its degrees of freedom.
#[derive(Clone, Copy, Debug)]
pub struct OrbitStart {
    pub(super) qq: Wide,
    pub(super) qv: Wide,
    pub(super) vv: Wide,
}

/// Coordinates this many bits below the largest are left out: a criterion is answered to 96 digits.
pub(super) const NEGLIGIBLE: i64 = 200;

impl OrbitStart {
    /// The start at `state`, in units in which `ω = 1`, as `(q, v/ω)`.
    pub fn new<const D: usize>(state: &State<f64, D>) -> Self {
        let state = state.map(Wide::from_f64);
        let largest = state.coordinates().filter_map(Wide::exponent).max().unwrap_or(0);
        let seen = |x: Wide| match x.exponent() {
            Some(exponent) if exponent >= largest - NEGLIGIBLE => x,
            _ => Wide::ZERO,
        };
        let sum = |a: [Wide; D], b: [Wide; D]| {
            a.into_iter().zip(b).fold(Wide::ZERO, |sum, (a, b)| sum + seen(a) * seen(b))
        };
        let State { q, v } = state;
        OrbitStart { qq: sum(q, q), qv: sum(q, v), vv: sum(v, v) }
    }

    /// The largest `q²` on the circle of the exact orbit.
    pub(super) fn reach(&self) -> Wide {
        let mean = (self.qq + self.vv).ratio(1, 2);
        let side = (self.qq - self.vv).ratio(1, 2);
        mean + (side * side + self.qv * self.qv).sqrt()
    }

    /// Twice the energy.
    pub(super) fn size(&self) -> Wide {
        self.qq + self.vv
    }
}
