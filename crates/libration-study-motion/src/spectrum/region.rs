//! The spectral radius over the complex plane.

use libration::Method;
use libration_report::record::Series;

use super::step::radius_at;

/// The part of the plane of `λΔt` that is mapped: real parts, and imaginary parts either way.
pub(super) const REAL: [f64; 2] = [-4.5, 2.0];
/// See [`REAL`].
pub(super) const IMAGINARY: [f64; 2] = [-3.4, 3.4];

/// The spectral radius of a step on modes with eigenvalues `λ, λ̄`, over a grid of `λΔt`.
///
/// For a Runge–Kutta method it is `|R(λΔt)|`. A split step has no function `R` of one variable; but
/// it has a spectral radius on every mode `q̈ = −|λ|²q + 2Re λ·q̇`, so all methods share one map.
pub(super) struct Region {
    re: Vec<f64>,
    im: Vec<f64>,
    radius: Vec<f64>,
}

impl Region {
    /// Maps `method` on a grid with `side` columns and rows.
    pub(super) fn new(method: Method, side: usize) -> Self {
        let even = |[from, to]: [f64; 2]| {
            (0..side).map(move |i| from + (to - from) * i as f64 / (side - 1) as f64)
        };
        let mut region = Region { re: Vec::new(), im: Vec::new(), radius: Vec::new() };
        for im in even(IMAGINARY) {
            for re in even(REAL) {
                region.re.push(re);
                region.im.push(im);
                region.radius.push(radius_at(method, re, im));
            }
        }
        region
    }

    /// The map as a series, row by row.
    pub(super) fn into_series(self, method: Method) -> Series {
        Series::new(format!("region-{}", method.name()))
            .with("re", "1", self.re)
            .with("im", "1", self.im)
            .with("radius", "1", self.radius)
    }
}
