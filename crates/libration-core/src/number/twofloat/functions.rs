//! Elementary functions of double-double numbers.

use super::{INVERSE_FACTORIAL, TERMS, TwoFloat, fast_two_sum, two_prod};
use crate::Elementary;
use crate::number::pair::{equal, less};

/// ln 2 to 160 bits.
const LN_2: [f64; 3] =
    [core::f64::consts::LN_2, 2.319_046_813_846_299_6e-17, 5.707_708_438_416_212e-34];

/// Terms of the series of the logarithm: the first one left out, 0.0295²², is below 10⁻³³.
const LOGARITHM_TERMS: usize = 22;

/// `1/(2n + 1)`.
const INVERSE_ODD: [TwoFloat; LOGARITHM_TERMS] = {
    let mut table = [TwoFloat::constant(1.0); LOGARITHM_TERMS];
    let mut n = 1;
    while n < table.len() {
        table[n] = table[n].over(TwoFloat::constant((2 * n + 1) as f64));
        n += 1;
    }
    table
};

/// Above it `e⁻ˣ` is lost in `eˣ`: the square of the quotient is 10⁻³⁴.
const LARGE: f64 = 40.0;

impl TwoFloat {
    /// `√(1 − x²)`.
    fn leg(self) -> Self {
        let one = TwoFloat::constant(1.0);
        ((one - self) * (one + self)).sqrt()
    }

    #[inline(always)]
    fn parts(self) -> (f64, f64) {
        (self.hi, self.lo)
    }

    /// `self · 2^power` for a power of at most 2046 in magnitude.
    fn scaled(self, power: i32) -> Self {
        let half = power / 2;
        let factors = [half, power - half].map(|k| f64::from_bits(((k + 1023) as u64) << 52));
        let [hi, lo] = [self.hi, self.lo].map(|part| part * factors[0] * factors[1]);
        TwoFloat { hi, lo }
    }
}

/// `eˣ`: reduction modulo ln 2, then Taylor's polynomial.
fn exponential(x: TwoFloat) -> TwoFloat {
    let nearest = Elementary::exp(x.hi);
    if nearest == 0.0 || !nearest.is_finite() {
        return TwoFloat::constant(nearest);
    }
    let k = (x.hi * core::f64::consts::LOG2_E).round_ties_even();
    // The products are exact, and a sum keeps its relative accuracy when it cancels.
    let r = LN_2.iter().fold(x, |r, &part| r + two_prod(-k, part));
    let sum = INVERSE_FACTORIAL.iter().rev().fold(TwoFloat::constant(0.0), |sum, &c| c + r * sum);
    sum.scaled(k as i32)
}

/// `sinh(x)/x` for `z = x² ≤ 1`.
fn odd_exponential(z: TwoFloat) -> TwoFloat {
    (0..TERMS).rev().fold(TwoFloat::constant(0.0), |sum, i| INVERSE_FACTORIAL[2 * i + 1] + z * sum)
}

/// Half of the difference and of the sum of `eᵃ` and `e⁻ᵃ`.
fn exponentials(a: TwoFloat) -> (TwoFloat, TwoFloat) {
    let up = exponential(a);
    let down = up.recip();
    ((up - down).scaled(-1), (up + down).scaled(-1))
}

/// `eᵃ/2`, where `eᵃ` may be beyond the range.
fn half_exponential(a: TwoFloat) -> TwoFloat {
    let root = exponential(a.scaled(-1));
    let value = root.scaled(-1) * root;
    if value.hi.is_finite() { value } else { TwoFloat::constant(Elementary::cosh(a.hi)) }
}

/// `ln x` by the series of the inverse hyperbolic tangent.
fn logarithm(x: TwoFloat) -> TwoFloat {
    if !(x.hi > 0.0 && x.hi.is_finite()) {
        return TwoFloat::constant(Elementary::ln(x.hi));
    }
    let (x, moved) = if x.hi < f64::MIN_POSITIVE { (x.scaled(60), 60) } else { (x, 0) };
    let leading = ((x.hi.to_bits() >> 52) & 0x7ff) as i32 - 1023;
    // A mantissa between √½ and √2, so that a number close to 1 keeps its relative accuracy.
    let mantissa = x.scaled(-leading);
    let halve = i32::from(mantissa.hi > core::f64::consts::SQRT_2);
    let m = mantissa.scaled(-halve);
    let one = TwoFloat::constant(1.0);
    let t = (m - one) / (m + one);
    let z = t * t;
    let sum = INVERSE_ODD.iter().rev().fold(TwoFloat::constant(0.0), |sum, &c| c + z * sum);

    let k = f64::from(leading + halve - moved);
    LN_2.iter().rev().fold((t * sum).scaled(1), |sum, &part| sum + two_prod(k, part))
}

/// Angle of the vector `(x, y)`: that of `f64`, and the angle that is left of the vector turned back by it.
fn angle(y: TwoFloat, x: TwoFloat) -> TwoFloat {
    let nearest = Elementary::atan2(y.hi, x.hi);
    let largest = y.hi.abs().max(x.hi.abs());
    // An angle of zero, and what has no accuracy to gain.
    if nearest == 0.0 || largest == 0.0 || !(y.hi.is_finite() && x.hi.is_finite()) {
        return TwoFloat::constant(nearest);
    }
    let power = if largest > 1e150 { -600 } else { 0 } + if largest < 1e-150 { 600 } else { 0 };
    let (y, x) = (y.scaled(power), x.scaled(power));
    let nearest = TwoFloat::constant(nearest);
    let (sin, cos) = nearest.sin_cos();
    let rest = (y * cos - x * sin) / (x * cos + y * sin);
    // The angle of the rest is its tangent, up to a cube of 10⁻⁴⁸.
    if rest.hi.is_finite() { nearest + rest } else { nearest }
}

impl Elementary for TwoFloat {
    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.hi.sqrt();
        let square = two_prod(root, root);
        // What is left of `hi` after subtracting root² is a float: the difference is exact.
        let rest = ((self.hi - square.hi) - square.lo) + self.lo;
        let correction = if root == 0.0 { 0.0 } else { rest / (2.0 * root) };
        fast_two_sum(root, correction)
    }

    #[inline(always)]
    fn recip(self) -> Self {
        TwoFloat::constant(1.0).over(self)
    }

    fn quotient(self, divisor: Self) -> Self {
        self.over(divisor)
    }

    fn sin(self) -> Self {
        self.sin_cos().0
    }

    fn cos(self) -> Self {
        self.sin_cos().1
    }

    fn tan(self) -> Self {
        let (sin, cos) = self.sin_cos();
        sin / cos
    }

    fn asin(self) -> Self {
        self.atan2(self.leg())
    }

    fn acos(self) -> Self {
        self.leg().atan2(self)
    }

    fn atan(self) -> Self {
        self.atan2(TwoFloat::constant(1.0))
    }

    fn atan2(self, x: Self) -> Self {
        angle(self, x)
    }

    fn exp(self) -> Self {
        exponential(self)
    }

    fn ln(self) -> Self {
        logarithm(self)
    }

    fn sinh(self) -> Self {
        let a = self.abs();
        if a.hi < 1.0 {
            return self * odd_exponential(self * self);
        }
        let value = if a.hi > LARGE { half_exponential(a) } else { exponentials(a).0 };
        if self.hi < 0.0 { -value } else { value }
    }

    fn cosh(self) -> Self {
        let a = self.abs();
        if a.hi > LARGE { half_exponential(a) } else { exponentials(a).1 }
    }

    fn tanh(self) -> Self {
        if self.abs().hi > LARGE { self.signum() } else { self.sinh() / self.cosh() }
    }

    #[inline(always)]
    fn abs(self) -> Self {
        self.abs()
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        let value = if less(other.parts(), self.parts()) { other } else { self };
        if self.hi.is_nan() | other.hi.is_nan() { TwoFloat::constant(f64::NAN) } else { value }
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        let value = if less(self.parts(), other.parts()) { other } else { self };
        if self.hi.is_nan() | other.hi.is_nan() { TwoFloat::constant(f64::NAN) } else { value }
    }
    #[inline(always)]
    fn signum(self) -> Self {
        TwoFloat::constant(Elementary::signum(self.hi))
    }
    #[inline(always)]
    fn select_less(self, other: Self, then: Self, otherwise: Self) -> Self {
        if less(self.parts(), other.parts()) { then } else { otherwise }
    }
    #[inline(always)]
    fn select_equal(self, other: Self, then: Self, otherwise: Self) -> Self {
        if equal(self.parts(), other.parts()) { then } else { otherwise }
    }
}
