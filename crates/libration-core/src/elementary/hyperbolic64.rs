//! Hyperbolic sine, cosine and tangent of an `f64`.

use super::error_free::{fast_two_sum, quotient};
use super::exponential64::{kernels, power_of_two, reduce};

const SIGN: u64 = 1 << 63;

/// `sinh x`, within 0.74 ulp; infinite above 710.47 in magnitude.
#[inline(always)]
pub fn sinh(x: f64) -> f64 {
    let (parts, scale) = Parts::of_large(x.abs());
    let value = parts.difference().0 * scale;
    let value = f64::from_bits(value.to_bits() | (x.to_bits() & SIGN));
    if x.is_nan() { f64::NAN } else { value }
}

/// `cosh x`, within 0.7 ulp; infinite above 710.47 in magnitude.
#[inline(always)]
pub fn cosh(x: f64) -> f64 {
    let (parts, scale) = Parts::of_large(x.abs());
    let value = parts.sum().0 * scale;
    if x.is_nan() { f64::NAN } else { value }
}

/// `tanh x`, within 0.74 ulp; ±1 above 19.07 in magnitude.
#[inline(always)]
pub fn tanh(x: f64) -> f64 {
    let a = x.abs();
    let parts = Parts::of(if a > 22.0 { 22.0 } else { a }, 0.0);
    let (q, low) = quotient(parts.difference(), parts.sum());
    let value = f64::from_bits((q + low).to_bits() | (x.to_bits() & SIGN));
    if x.is_nan() { f64::NAN } else { value }
}

/// A number `k·ln 2 + r` with `|r| ≤ ln 2 / 2` in the parts of its exponentials.
#[derive(Clone, Copy)]
struct Parts {
    /// `2ᵏ`, or a power below it.
    up: f64,
    /// `2⁻ᵏ`, with the same factor.
    down: f64,
    r: f64,
    /// `cosh r − 1`.
    even: f64,
    /// `sinh r − r`.
    odd: f64,
}

impl Parts {
    /// The parts of `a ≥ 0`, and the half of the factor that they leave out.
    #[inline(always)]
    fn of_large(a: f64) -> (Self, f64) {
        let capped = if a > 711.0 { 711.0 } else { a };
        // 2ᵏ may be beyond the range where the result is not: it leaves out a factor of 2⁸.
        let (less, scale) = if a > 100.0 { (8.0, 128.0) } else { (0.0, 0.5) };
        (Parts::of(capped, less), scale)
    }

    /// The parts of `0 ≤ a ≤ 711`, the powers divided by 2 to the power of `less`.
    #[inline(always)]
    fn of(a: f64, less: f64) -> Self {
        let (k, r, tail) = reduce(a);
        let (even, odd) = kernels(r);
        // 2⁻¹⁰⁰ is as good as any smaller power.
        let down = if k > 100.0 { 100.0 } else { k };
        Parts {
            up: power_of_two(k - less),
            down: power_of_two(-down),
            r,
            even: even + tail * r,
            odd: odd + tail,
        }
    }

    /// Twice the hyperbolic sine as an unevaluated sum.
    #[inline(always)]
    fn difference(self) -> (f64, f64) {
        self.combine(-self.down)
    }

    /// Twice the hyperbolic cosine as an unevaluated sum.
    #[inline(always)]
    fn sum(self) -> (f64, f64) {
        self.combine(self.down)
    }

    /// `up·eʳ + down·e⁻ʳ`, that is `(up + down)·cosh r + (up − down)·sinh r`.
    #[inline(always)]
    fn combine(self, down: f64) -> (f64, f64) {
        let Parts { up, r, even, odd, .. } = self;
        let (both, lost) = fast_two_sum(up, down);
        // The products with powers of two are exact.
        let (first, first_lost) = fast_two_sum(both, up * r);
        let (second, second_lost) = fast_two_sum(first, -(down * r));
        let low = ((lost + first_lost) + second_lost) + (both * even + (up - down) * odd);
        fast_two_sum(second, low)
    }
}
