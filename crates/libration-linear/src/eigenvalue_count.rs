//! The number of eigenvalues of a loop outside the unit circle.

use core::f64::consts::PI;

use num_complex::Complex64;

use crate::crossing_curves::{AngleGrid, turned, unit};
use crate::hessenberg::Resolved;
use crate::open_channel::PartResponse;

impl AngleGrid<'_> {
    /// The number of eigenvalues outside the unit circle: the argument of the characteristic polynomial along half of it.
    pub(crate) fn unstable(&self, response: &PartResponse, whole: u64) -> i64 {
        let k = whole as f64;
        let polynomial = |angle: f64, resolved: &Resolved| {
            let back = Complex64::from_polar(1.0, -k * angle);
            (Complex64::ONE - back * response.at(unit(angle), resolved)) * resolved.determinant
        };
        let fresh = |angle: f64| polynomial(angle, &self.open.resolved(unit(angle)));
        let known: Vec<(f64, Complex64)> = self
            .points
            .iter()
            .map(|(angle, resolved)| (*angle, polynomial(*angle, resolved)))
            .collect();
        let mut turn = 0.0;
        for pair in known.windows(2) {
            let most = 0.5 / (k + 1.0);
            turn += argument(&fresh, pair[0], pair[1], most, 48);
        }
        self.open.size() as i64 - (turn / PI).round() as i64
    }
}

/// The angle by which a function turns from one point to another, which are halved until it changes by a part of its size.
fn argument(
    f: &impl Fn(f64) -> Complex64,
    from: (f64, Complex64),
    to: (f64, Complex64),
    most: f64,
    depth: u32,
) -> f64 {
    let change = (to.1 - from.1).norm();
    let small = change < 0.7 * from.1.norm().min(to.1.norm()) && to.0 - from.0 <= most;
    if small || depth == 0 {
        return turned(from.1.arg(), to.1.arg());
    }
    let middle = 0.5 * (from.0 + to.0);
    let at = (middle, f(middle));
    argument(f, from, at, most, depth - 1) + argument(f, at, to, most, depth - 1)
}
