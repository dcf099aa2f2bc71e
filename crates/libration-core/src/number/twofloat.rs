//! Double-double arithmetic: about 106 bits from a pair of `f64`.

use core::ops::{Add, Div, Mul, Neg, Sub};

use crate::elementary::error_free;
use crate::{Float, Scalar};

mod functions;

/// The unevaluated sum `hi + lo` of two `f64`, with `hi` its value rounded to nearest.
///
/// It is the reference whose rounding one does not see. Algorithms and error bounds are those of
/// M. Joldes, J.-M. Muller and V. Popescu, *Tight and rigorous error bounds for basic building
/// blocks of double-word arithmetic*, ACM TOMS 44 (2017), 15res. With `u = 2⁻⁵³`, and as long as
/// nothing overflows or becomes smaller than 2⁻⁹⁰⁰ in magnitude, the relative errors are at most
///
/// | operation | bound | algorithm |
/// | --- | --- | --- |
/// | `+`, `-` | 3u² + 13u³ | 6, also when the terms nearly cancel |
/// | `*` | 7u² | 10 |
/// | `/`, `recip` | 15u² + 56u³ | 17 |
/// | `sqrt` | 25/8 u² | Lefèvre, Louvet, Muller, Picot and Rideau, ACM TOMS 49 (2023), 1 |
///
/// `sin` and `cos` have an absolute error of at most 10⁻³⁰ for `|x| ≤ 2⁵⁰` and are NaN beyond,
/// where the argument itself no longer names an angle to that accuracy. `tan` is their quotient. The other
/// functions have a relative error of at most 10⁻³⁰ and the special values of `f64`.
///
/// There is no fused multiply-add: the exact product is Dekker's, so that every machine gives the
/// same bits. Overflow gives infinity or NaN; products above 2¹⁰²² may already do so.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct TwoFloat {
    /// The value rounded to `f64`.
    hi: f64,
    /// The error of that rounding: `|lo| ≤ ulp(hi)/2`.
    lo: f64,
}

/// `a + b`.
#[inline(always)]
const fn two_sum(a: f64, b: f64) -> TwoFloat {
    TwoFloat::of(error_free::two_sum(a, b))
}

/// The same for `|a| ≥ |b|` or `a = 0`.
#[inline(always)]
const fn fast_two_sum(a: f64, b: f64) -> TwoFloat {
    TwoFloat::of(error_free::fast_two_sum(a, b))
}

/// `a` as a sum of two numbers of 26 bits each.
#[inline(always)]
const fn split(a: f64) -> (f64, f64) {
    // Near the top of the range the split would overflow, so work on a·2⁻²⁸ there.
    const DOWN: f64 = 1.0 / 268_435_456.0;
    let large = a.abs() > 6.696_928_794_914_17e299;
    let (down, up) = if large { (DOWN, 1.0 / DOWN) } else { (1.0, 1.0) };
    let (head, tail) = error_free::split(a * down);
    (head * up, tail * up)
}

/// `a · b`.
#[inline(always)]
const fn two_prod(a: f64, b: f64) -> TwoFloat {
    TwoFloat::of(error_free::product_of_parts(a * b, split(a), split(b)))
}

impl TwoFloat {
    /// π, with an error below 2⁻¹⁰⁶.
    pub const PI: Self = TwoFloat { hi: core::f64::consts::PI, lo: 1.224_646_799_147_353_2e-16 };

    /// The sum `a + b`, which need not be small or ordered.
    #[inline(always)]
    pub const fn from_sum(a: f64, b: f64) -> Self {
        two_sum(a, b)
    }

    /// The value rounded to `f64`.
    #[inline(always)]
    pub const fn hi(self) -> f64 {
        self.hi
    }

    /// The value minus [`hi`](Self::hi).
    #[inline(always)]
    pub const fn lo(self) -> f64 {
        self.lo
    }

    /// The absolute value.
    #[inline(always)]
    pub fn abs(self) -> Self {
        if self.hi < 0.0 { -self } else { self }
    }

    /// The sum of a value and its rounding error.
    #[inline(always)]
    const fn of((hi, lo): (f64, f64)) -> Self {
        TwoFloat { hi, lo }
    }

    const fn constant(hi: f64) -> Self {
        TwoFloat { hi, lo: 0.0 }
    }

    /// Algorithm 6, AccurateDWPlusDW.
    #[inline(always)]
    const fn plus(self, other: Self) -> Self {
        let s = two_sum(self.hi, other.hi);
        let t = two_sum(self.lo, other.lo);
        let v = fast_two_sum(s.hi, s.lo + t.hi);
        fast_two_sum(v.hi, t.lo + v.lo)
    }

    /// Algorithm 10, DWTimesDW1.
    #[inline(always)]
    const fn times(self, other: Self) -> Self {
        let c = two_prod(self.hi, other.hi);
        fast_two_sum(c.hi, c.lo + (self.hi * other.lo + self.lo * other.hi))
    }

    /// Algorithm 7, DWTimesFP1, with a relative error of at most 3/2 u² + 4u³.
    #[inline(always)]
    const fn times_f64(self, y: f64) -> Self {
        let c = two_prod(self.hi, y);
        let t = fast_two_sum(c.hi, self.lo * y);
        fast_two_sum(t.hi, t.lo + c.lo)
    }

    /// Algorithm 17, DWDivDW2.
    #[inline(always)]
    const fn over(self, other: Self) -> Self {
        let quotient = self.hi / other.hi;
        let r = other.times_f64(quotient);
        let rest = (self.hi - r.hi) + (self.lo - r.lo);
        fast_two_sum(quotient, rest / other.hi)
    }

    #[inline(always)]
    const fn negated(self) -> Self {
        TwoFloat { hi: -self.hi, lo: -self.lo }
    }

    /// `(sin, cos)`: reduction modulo π/2, then both Taylor polynomials.
    fn sin_cos(self) -> (Self, Self) {
        // Adding and subtracting 1.5·2⁵² rounds to an integer; it stays below 2⁵⁰ in magnitude.
        const ROUND: f64 = 6_755_399_441_055_744.0;
        let quarters = self.hi * core::f64::consts::FRAC_2_PI + ROUND - ROUND;
        // The products are exact, and a sum keeps its relative accuracy when it cancels.
        let r = HALF_PI.iter().fold(self, |r, &part| r + two_prod(-quarters, part));
        let square = r * r;
        let horner = |first: usize| {
            (0..TERMS).rev().fold(TwoFloat::constant(0.0), |sum, i| {
                INVERSE_FACTORIAL[2 * i + first] - square * sum
            })
        };
        let (sin, cos) = (r * horner(1), horner(0));
        if self.hi.abs() > LARGEST_ANGLE {
            return (TwoFloat::constant(f64::NAN), TwoFloat::constant(f64::NAN));
        }
        match quarters.rem_euclid(4.0) as u8 {
            0 => (sin, cos),
            1 => (cos, -sin),
            2 => (-sin, -cos),
            _ => (-cos, sin),
        }
    }
}

/// π/2 to 160 bits: with up to 2⁵⁰ quarter turns the error stays below 2⁻¹¹⁰.
const HALF_PI: [f64; 3] =
    [core::f64::consts::FRAC_PI_2, 6.123_233_995_736_766e-17, -1.497_384_904_859_169_8e-33];

/// 2⁵⁰.
const LARGEST_ANGLE: f64 = 1_125_899_906_842_624.0;

/// Terms of each Taylor series: the first one left out, 0.79³⁰/30!, is below 10⁻³⁵.
const TERMS: usize = 15;

/// `1/n!`.
const INVERSE_FACTORIAL: [TwoFloat; 2 * TERMS] = {
    let mut table = [TwoFloat::constant(1.0); 2 * TERMS];
    let mut n = 1;
    while n < table.len() {
        table[n] = table[n - 1].over(TwoFloat::constant(n as f64));
        n += 1;
    }
    table
};

impl Add for TwoFloat {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.plus(other)
    }
}

impl Sub for TwoFloat {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.plus(other.negated())
    }
}

impl Mul for TwoFloat {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.times(other)
    }
}

impl Div for TwoFloat {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.over(other)
    }
}

impl Neg for TwoFloat {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.negated()
    }
}

impl Scalar for TwoFloat {
    #[inline(always)]
    fn from_f64(c: f64) -> Self {
        TwoFloat::constant(c)
    }

    #[inline(always)]
    fn ratio(self, num: i32, den: i32) -> Self {
        if num == 1 && den.is_positive() && den.count_ones() == 1 {
            // Both parts are scaled without rounding.
            let part = 1.0 / f64::from(den);
            return TwoFloat { hi: self.hi * part, lo: self.lo * part };
        }
        self.times_f64(num.into()).over(TwoFloat::constant(den.into()))
    }
}

impl Float for TwoFloat {
    const NAME: &'static str = "twofloat";
    const UNIT_ROUNDOFF: f64 = f64::EPSILON * f64::EPSILON / 4.0;

    #[inline(always)]
    fn to_f64(self) -> f64 {
        self.hi
    }

    #[inline(always)]
    fn is_finite(self) -> bool {
        self.hi.is_finite() && self.lo.is_finite()
    }
}
