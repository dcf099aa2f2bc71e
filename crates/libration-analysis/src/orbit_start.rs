//! The start of an orbit, as criteria require it.

use libration_core::number::Wide;
use libration_core::{Elementary, Scalar};

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
    /// The start at positions `q` and velocities `v`, in units in which `ω = 1`, as `(q, v/ω)`.
    pub fn new(q: &[f64], v: &[f64]) -> Self {
        let wide = |state: &[f64]| state.iter().map(|&x| Wide::from_f64(x)).collect::<Vec<_>>();
        let (q, v) = (wide(q), wide(v));
        let exponents = q.iter().chain(&v).filter_map(|x| x.exponent());
        let largest = exponents.max().unwrap_or(0);
        let seen = |x: Wide| match x.exponent() {
            Some(exponent) if exponent >= largest - NEGLIGIBLE => x,
            _ => Wide::ZERO,
        };
        let sum = |a: &[Wide], b: &[Wide]| {
            a.iter().zip(b).fold(Wide::ZERO, |sum, (&a, &b)| sum + seen(a) * seen(b))
        };
        OrbitStart { qq: sum(&q, &q), qv: sum(&q, &v), vv: sum(&v, &v) }
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
