//! Coordinates in which a form is a circle.

use crate::QuadraticForm;

/// A matrix of two rows in floats.
pub(super) type Matrix = [[f64; 2]; 2];

/// The coordinates `x = scale·q` and `y = v + shear·q`: a definite form is a multiple of `x² + y²` in them.
#[derive(Clone, Copy, Debug)]
pub(super) struct CircularCoordinates {
    pub(super) scale: f64,
    pub(super) shear: f64,
}

impl CircularCoordinates {
    /// The coordinates in which the definite `form` is a circle.
    pub(super) fn of(form: &QuadraticForm<f64>) -> Self {
        let [qq, shear] = [form.qq, form.qv].map(|x| x / form.vv);
        // q²·qq + 2·q·v·shear + v² = (scale·q)² + (v + shear·q)².
        CircularCoordinates { scale: (qq - shear * shear).sqrt(), shear }
    }

    /// A matrix on `(q, v)` in these coordinates.
    pub(super) fn turned(self, [[a, b], [c, d]]: Matrix) -> Matrix {
        let CircularCoordinates { scale, shear } = self;
        let column = |q: f64, v: f64| {
            let (next_q, next_v) = (a * q + b * v, c * q + d * v);
            [scale * next_q, next_v + shear * next_q]
        };
        let (first, second) = (column(1.0 / scale, -shear / scale), column(0.0, 1.0));
        [[first[0], second[0]], [first[1], second[1]]]
    }

    /// The ones in which the largest norm among `steps` is smallest; `dt` is the unit of time.
    ///
    /// Forms `P` with `MᵀPM ≤ s²P` for every step `M` are a convex set, smaller for smaller `s`. So the norm of the largest
    /// has no minimum but one, along each coordinate and over the smallest of the other.
    pub(super) fn smallest(steps: &[Matrix], dt: f64) -> Self {
        // The form x² + y² with x = scale·q, y = v + shear·q. Of its slope, as of its scale, 1/Δt is the unit.
        let at = |logarithm: f64, share: f64| {
            let qq = (2.0 * logarithm).exp() / (dt * dt);
            CircularCoordinates::of(&QuadraticForm { qq, qv: share * qq.sqrt(), vv: 1.0 })
        };
        let size = |circle: CircularCoordinates| {
            let turned: Vec<Matrix> = steps.iter().map(|&step| circle.turned(step)).collect();
            largest_norm(&turned)
        };
        let best = |logarithm: f64| golden(-1.0, 1.0, |share| size(at(logarithm, share)));
        let logarithm = golden(-WIDEST, WIDEST, |x| size(at(x, best(x))));
        at(logarithm, best(logarithm))
    }
}

/// The largest singular value: that of the part that turns, and that of the part that reflects.
pub(super) fn norm([[a, b], [c, d]]: &Matrix) -> f64 {
    0.5 * ((a + d).hypot(c - b) + (a - d).hypot(b + c))
}

pub(super) fn largest_norm(steps: &[Matrix]) -> f64 {
    // What has no value is beyond any bound; `max` would leave it out.
    let size = |step| Some(norm(step)).filter(|size| !size.is_nan()).unwrap_or(f64::INFINITY);
    steps.iter().map(size).fold(0.0, f64::max)
}

/// The logarithm of the largest and smallest scale that are tried, in units of `1/Δt`.
const WIDEST: f64 = 12.0;

/// The minimum of a unimodal function, by golden-section search.
fn golden(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    const SHARE: f64 = 0.618_033_988_749_894_9;
    let inner = |low: f64, high: f64| [high - SHARE * (high - low), low + SHARE * (high - low)];
    let [mut a, mut b] = inner(low, high);
    let (mut at_a, mut at_b) = (f(a), f(b));
    // To 10⁻⁹ of the interval.
    for _ in 0..44 {
        if at_a <= at_b {
            high = b;
            (b, at_b) = (a, at_a);
            [a, _] = inner(low, high);
            at_a = f(a);
        } else {
            low = a;
            (a, at_a) = (b, at_b);
            [_, b] = inner(low, high);
            at_b = f(b);
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_norm_is_the_longest_image_of_a_circle() {
        let matrix = [[0.3, -2.0], [0.7, 1.1]];
        let images = (0..1000).map(|i| {
            let (sine, cosine) = (core::f64::consts::PI * f64::from(i) / 1000.0).sin_cos();
            (0.3 * cosine - 2.0 * sine).hypot(0.7 * cosine + 1.1 * sine)
        });
        let longest = images.fold(0.0, f64::max);
        // Between two of the directions at most π/2000 is missed, and the square of it counts.
        let norm = norm(&matrix);
        assert!(longest <= norm && norm < longest * (1.0 + 1e-5), "{longest} {norm}");
    }

    #[test]
    fn a_turn_about_any_ellipse_is_no_larger_than_a_turn() {
        // By 1 rad about q²·9 + 2·q·v·2 + v², a hundred times smaller.
        let circle = CircularCoordinates { scale: 5.0_f64.sqrt(), shear: 2.0 };
        let (sine, cosine) = 1.0_f64.sin_cos();
        let back = |x: f64, y: f64| [x / circle.scale, y - circle.shear * x / circle.scale];
        let image = |q: f64, v: f64| {
            let (x, y) = (circle.scale * q, v + circle.shear * q);
            back(0.01 * (cosine * x + sine * y), 0.01 * (cosine * y - sine * x))
        };
        let ([a, c], [b, d]) = (image(1.0, 0.0), image(0.0, 1.0));
        let step = [[a, b], [c, d]];
        let found = CircularCoordinates::smallest(&[step], 0.4);
        // Golden section finds the ellipse to 10⁻⁸ of its shape.
        assert!((norm(&found.turned(step)) / 0.01 - 1.0).abs() < 1e-7, "{found:?}");
        assert!((found.shear - 2.0).abs() < 1e-6, "{found:?}");
    }
}
