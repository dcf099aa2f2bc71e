//! Binary floating point with 1024 bits.

use core::cmp::Ordering;
use core::ops::{Add, Div, Mul, Neg, Sub};

use bnum::Uint;
use bnum::cast::As;
use bnum::types::{U1024, U2048};

use super::bits::{decode, nearest_f64};
use crate::Scalar;

mod functions;

/// Bits of the significand.
const BITS: u32 = U1024::BITS;

/// A significand with 127 guard bits below it and one bit for the carry above.
type Guarded = Uint<144>;
const GUARD: u32 = Guarded::BITS - BITS - 1;

/// Bits of the divisors that take the short way.
const DIGIT: u32 = 64;

/// Exponents stay within `±LIMIT`, so that the sum of two of them fits its type.
const LIMIT: i64 = 1 << 61;

/// A floating-point number with a 1024-bit significand and an `i64` exponent.
///
/// It is for what vanishes in `f64`: a determinant that misses 1 by 10⁻¹⁷, a phase error of
/// 10⁻⁶⁰, or the millionth power of an update matrix, 10⁶⁹⁸⁹⁷⁰.
///
/// `+`, `-` and `*` round to nearest: their relative error is at most 2⁻¹⁰²⁴(1 + 2⁻¹²⁵), also when
/// terms nearly cancel; the last factor is for sums of terms more than 127 bits apart. `/`, `sqrt`
/// and the conversion from [`Ratio`](super::Ratio) err by at most 2⁻¹⁰²²; the functions state their own bounds.
/// There is no infinity: what has no value (`1/0`, `√−1`, an exponent beyond
/// ±2⁶¹) is NaN, which propagates and compares with nothing.
#[derive(Clone, Copy)]
pub struct Wide {
    negative: bool,
    /// The value is `±significand · 2^exponent`. The top bit of the significand is set, but in
    /// zero (exponent 0) and in NaN (exponent 1), where the significand is 0.
    exponent: i64,
    significand: U1024,
}

impl Wide {
    /// Zero.
    pub const ZERO: Self = Wide { negative: false, exponent: 0, significand: U1024::MIN };

    /// Not a number.
    pub const NAN: Self = Wide { negative: false, exponent: 1, significand: U1024::MIN };

    /// `±magnitude · 2^exponent`, rounded to nearest.
    pub(super) fn rounded<const N: usize>(
        negative: bool,
        magnitude: Uint<N>,
        exponent: i64,
    ) -> Self {
        let width = magnitude.bit_width();
        if width == 0 {
            return Wide::ZERO;
        }
        if width <= BITS {
            let shift = BITS - width;
            let significand = magnitude.as_::<U1024>() << shift;
            return Wide::normal(negative, significand, false, exponent - i64::from(shift));
        }
        let shift = width - BITS;
        let up = magnitude.bit(shift - 1);
        Wide::normal(negative, (magnitude >> shift).as_(), up, exponent + i64::from(shift))
    }

    /// `±(significand + up) · 2^exponent`, where the significand has its highest bit set.
    #[inline]
    fn normal(negative: bool, mut significand: U1024, up: bool, mut exponent: i64) -> Self {
        if up {
            significand = significand.wrapping_add(U1024::power_of_two(0));
            if significand.is_zero() {
                significand = U1024::power_of_two(BITS - 1);
                exponent += 1;
            }
        }
        if exponent.abs() > LIMIT {
            return Wide::NAN;
        }
        Wide { negative, exponent, significand }
    }

    /// Sign, significand and power of two; none of NaN.
    pub(super) fn parts(self) -> Option<(bool, U1024, i64)> {
        (!self.is_nan()).then_some((self.negative, self.significand, self.exponent))
    }

    /// Whether this is neither zero nor NaN. One bit tells it; a comparison with zero would read all 1024.
    #[inline]
    fn is_normal(&self) -> bool {
        self.significand.bit(BITS - 1)
    }

    /// Whether this is zero.
    pub fn is_zero(self) -> bool {
        !self.is_normal() && self.exponent == 0
    }

    /// Whether this is NaN.
    #[inline]
    pub fn is_nan(self) -> bool {
        !self.is_normal() && self.exponent != 0
    }

    /// Whether this is less than zero.
    pub fn is_negative(self) -> bool {
        self.negative
    }

    /// The absolute value.
    pub fn abs(self) -> Self {
        Wide { negative: false, ..self }
    }

    /// `⌊log₂|self|⌋`; none for zero and NaN.
    pub fn exponent(self) -> Option<i64> {
        self.is_normal().then(|| self.leading())
    }

    fn leading(self) -> i64 {
        self.exponent + i64::from(BITS - 1)
    }

    /// `self · 2^power`, exactly.
    pub fn scaled(self, power: i64) -> Self {
        if !self.is_normal() {
            return self;
        }
        let exponent = self.exponent.saturating_add(power);
        Wide::normal(self.negative, self.significand, false, exponent.clamp(-2 * LIMIT, 2 * LIMIT))
    }

    /// The value rounded to nearest, ties to even; infinite above the range of `f64`.
    pub fn to_f64(self) -> f64 {
        if !self.is_normal() {
            return if self.is_nan() { f64::NAN } else { 0.0 };
        }
        let top = (self.significand >> (BITS - 64)).as_();
        let sticky = self.significand.trailing_zeros() < BITS - 64;
        nearest_f64(self.negative, top, sticky, self.exponent + i64::from(BITS - 64))
    }

    /// The magnitude rounded to an integer, half up; none if that does not fit.
    fn nearest_integer(self) -> Option<U1024> {
        match u32::try_from(-self.exponent) {
            _ if !self.is_normal() => (!self.is_nan()).then_some(U1024::MIN),
            Ok(0) => Some(self.significand),
            Ok(shift) if shift <= BITS => {
                let up: U1024 = self.significand.bit(shift - 1).as_();
                Some(self.significand.unbounded_shr(shift) + up)
            }
            _ if self.exponent < 0 => Some(U1024::MIN),
            _ => None,
        }
    }
}

/// In scientific notation, with 16 decimals or as many as the precision says.
impl core::fmt::Display for Wide {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(&self.to_decimal(f.precision().map_or(17, |p| p.saturating_add(1))))
    }
}

impl core::fmt::Debug for Wide {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(&self.to_decimal(40))
    }
}

impl PartialEq for Wide {
    fn eq(&self, other: &Self) -> bool {
        self.partial_cmp(other) == Some(Ordering::Equal)
    }
}

impl PartialOrd for Wide {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        if self.is_nan() || other.is_nan() {
            return None;
        }
        let key = |x: &Self| (x.exponent().unwrap_or(i64::MIN), x.significand);
        Some(match (self.negative, other.negative) {
            (false, false) => key(self).cmp(&key(other)),
            (true, true) => key(other).cmp(&key(self)),
            (negative, _) => {
                if negative {
                    Ordering::Less
                } else {
                    Ordering::Greater
                }
            }
        })
    }
}

impl Add for Wide {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        if self.is_nan() || other.is_zero() {
            return self;
        }
        if other.is_nan() || self.is_zero() {
            return other;
        }
        let (big, small) =
            if self.exponent >= other.exponent { (self, other) } else { (other, self) };
        let Ok(shift) = u32::try_from(big.exponent - small.exponent) else { return big };
        // A shift of up to 127 bits loses nothing. Behind a longer one the sum cannot cancel by
        // more than a bit, and what the shift cuts off is 2⁻¹²⁶ of the last place.
        let a = big.significand.as_::<Guarded>() << GUARD;
        let b = (small.significand.as_::<Guarded>() << GUARD).unbounded_shr(shift);
        let exponent = big.exponent - i64::from(GUARD);
        if big.negative == small.negative {
            Wide::rounded(big.negative, a.wrapping_add(b), exponent)
        } else if a >= b {
            Wide::rounded(big.negative, a.wrapping_sub(b), exponent)
        } else {
            Wide::rounded(small.negative, b.wrapping_sub(a), exponent)
        }
    }
}

impl Sub for Wide {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Wide {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        if !self.is_normal() || !other.is_normal() {
            return if self.is_nan() || other.is_nan() { Wide::NAN } else { Wide::ZERO };
        }
        let negative = self.negative != other.negative;
        let (low, high) = self.significand.widening_mul(other.significand);
        let exponent = self.exponent + other.exponent + i64::from(BITS);
        if high.bit(BITS - 1) {
            Wide::normal(negative, high, low.bit(BITS - 1), exponent)
        } else {
            let significand = (high << 1_u32) | (low >> (BITS - 1));
            Wide::normal(negative, significand, low.bit(BITS - 2), exponent - 1)
        }
    }
}

impl Div for Wide {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        if self.is_nan() || !other.is_normal() {
            return Wide::NAN;
        }
        if self.is_zero() {
            return self;
        }
        let negative = self.negative != other.negative;
        let exponent = self.exponent - other.exponent - i64::from(BITS);
        // Zeros below the divisor's 64 bits cancel against those of the dividend: the same quotient from a shorter division.
        if other.significand.trailing_zeros() >= BITS - DIGIT {
            let dividend = self.significand.as_::<Guarded>() << DIGIT;
            let divisor = (other.significand >> (BITS - DIGIT)).as_::<Guarded>();
            return Wide::rounded(negative, dividend / divisor, exponent);
        }
        let dividend = self.significand.as_::<U2048>() << BITS;
        let quotient = dividend / other.significand.as_::<U2048>();
        Wide::rounded(negative, quotient, exponent)
    }
}

impl Neg for Wide {
    type Output = Self;
    fn neg(self) -> Self {
        Wide { negative: !self.negative && self.is_normal(), ..self }
    }
}

impl Scalar for Wide {
    /// Exact; NaN if `c` is not finite.
    fn from_f64(c: f64) -> Self {
        if !c.is_finite() {
            return Wide::NAN;
        }
        let (magnitude, exponent) = decode(c);
        let magnitude: U1024 = magnitude.as_();
        Wide::rounded(c < 0.0, magnitude, exponent.into())
    }

    fn ratio(self, num: i32, den: i32) -> Self {
        self * Wide::from_f64(num.into()) / Wide::from_f64(den.into())
    }
}
