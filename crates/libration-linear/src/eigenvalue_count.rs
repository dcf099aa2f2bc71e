//! The number of eigenvalues of a loop outside the unit circle.

use core::f64::consts::PI;

use num_complex::Complex64;

use crate::crossing_curves::{AngleGrid, turned, unit};
use crate::hessenberg::Resolved;
use crate::open_channel::PartResponse;

/// The characteristic polynomial `(1 − z⁻ᵏ G)·det(z − A)` at an angle.
#[derive(Clone, Copy)]
struct Point {
    angle: f64,
    gain: f64,
    value: Complex64,
}

/// Gain below which `1 − z⁻ᵏ G` stays right of zero however often `z⁻ᵏ` turns.
const SMALL: f64 = 0.9;

impl AngleGrid<'_> {
    /// The number of eigenvalues outside the unit circle: the argument of the characteristic polynomial along half of it.
    pub(crate) fn unstable(&self, response: &PartResponse, whole: u64) -> i64 {
        let k = whole as f64;
        let point = |angle: f64, resolved: &Resolved| {
            let open = response.at(unit(angle), resolved);
            let back = Complex64::from_polar(1.0, -k * angle);
            let value = (Complex64::ONE - back * open) * resolved.determinant;
            Point { angle, gain: open.norm(), value }
        };
        let fresh = |angle: f64| point(angle, &self.open.resolved(unit(angle)));
        let all = self.points.iter().map(|(angle, resolved)| (point(*angle, resolved), resolved));
        let known: Vec<(Point, &Resolved)> = all.collect();
        let mut turn = 0.0;
        for pair in known.windows(2) {
            let [(from, a), (to, b)] = [pair[0], pair[1]];
            turn += match from.gain.max(to.gain) < SMALL {
                // Right of zero an argument needs no steps.
                true => {
                    let [first, last] =
                        [(from, a), (to, b)].map(|(at, open)| (at.value / open.determinant).arg());
                    last - first + turned(a.determinant.arg(), b.determinant.arg())
                }
                false => argument(&fresh, from, to, 0.5 / (k + 1.0), 48),
            };
        }
        self.open.size() as i64 - (turn / PI).round() as i64
    }
}

/// The angle by which the polynomial turns from one point to another, which are halved until it changes by a part of its size.
fn argument(f: &impl Fn(f64) -> Point, from: Point, to: Point, most: f64, depth: u32) -> f64 {
    let change = (to.value - from.value).norm();
    let small = change < 0.7 * from.value.norm().min(to.value.norm());
    if small && to.angle - from.angle <= most || depth == 0 {
        return turned(from.value.arg(), to.value.arg());
    }
    let at = f(0.5 * (from.angle + to.angle));
    argument(f, from, at, most, depth - 1) + argument(f, at, to, most, depth - 1)
}
