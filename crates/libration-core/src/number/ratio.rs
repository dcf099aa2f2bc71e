//! Exact rational arithmetic in lowest terms.

use core::cmp::Ordering;
use core::fmt;

use bnum::Uint;
use bnum::cast::As;
use bnum::types::{U1024, U2048};
use num_bigint::{BigInt, Sign};

use super::Wide;
use super::bits::{decode, nearest_f64};
use crate::Scalar;

mod arithmetic;

/// Room for the products that a comparison or a quotient needs.
type Product = Uint<512>;

/// An exact fraction `±num/den · 2^exponent` with odd `num` and `den` in lowest terms.
///
/// The odd numerator has up to 2048 bits, the odd denominator up to 1024. The power of two stands
/// apart because the constants of an integrator are `f64`: their sums and products then need no
/// common denominator and no reduction, and every finite `f64` is exact.
///
/// What does not fit is never wrapped or rounded: the result is [`Ratio::UNDEFINED`], as is `1/0`,
/// and so is everything computed from it. It equals itself and is less than every number, as
/// `None` is less than `Some`.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Ratio {
    negative: bool,
    exponent: i32,
    num: U2048,
    /// Zero if and only if the fraction is undefined.
    den: U1024,
}

/// The exponent, if it is one that can be negated and compared without care.
fn in_range(exponent: i32) -> Option<i32> {
    (exponent.unsigned_abs() <= 1 << 30).then_some(exponent)
}

/// `x · 2^shift`, if it fits.
fn shifted(x: U2048, shift: u32) -> Option<U2048> {
    (shift <= x.leading_zeros()).then(|| x.unbounded_shl(shift))
}

impl Ratio {
    /// Zero.
    pub const ZERO: Self = Ratio::odd(U2048::MIN);

    /// One.
    pub const ONE: Self = Ratio::odd(U2048::power_of_two(0));

    /// The result of an overflow or of a division by zero.
    pub const UNDEFINED: Self = Ratio { den: U1024::MIN, ..Ratio::ZERO };

    const fn odd(num: U2048) -> Self {
        Ratio { negative: false, exponent: 0, num, den: U1024::power_of_two(0) }
    }

    /// The fraction `num/den`, undefined if `den` is 0.
    pub fn new(num: i64, den: i64) -> Self {
        Ratio::from(num) * Ratio::from(den).recip()
    }

    /// `±num/den · 2^exponent` from coprime `num` and odd `den`.
    fn normal(negative: bool, num: U2048, den: U1024, exponent: i32) -> Option<Self> {
        if num.is_zero() {
            return Some(Ratio::ZERO);
        }
        let twos = num.trailing_zeros();
        let exponent = exponent.checked_add_unsigned(twos).and_then(in_range)?;
        Some(Ratio { negative, exponent, num: num >> twos, den })
    }

    /// Whether the value is known: nothing overflowed on the way to it.
    pub fn is_valid(&self) -> bool {
        !self.den.is_zero()
    }

    /// The value, if it is known.
    pub fn checked(self) -> Option<Self> {
        self.is_valid().then_some(self)
    }

    /// Whether this is zero.
    pub fn is_zero(&self) -> bool {
        self.num.is_zero() && self.is_valid()
    }

    /// −1, 0 or 1; 0 if undefined.
    pub fn sign(&self) -> i32 {
        match (self.num.is_zero(), self.negative) {
            (true, _) => 0,
            (_, true) => -1,
            (_, false) => 1,
        }
    }

    /// The absolute value.
    pub fn abs(self) -> Self {
        Ratio { negative: false, ..self }
    }

    /// The numerator in lowest terms, with the sign of the fraction.
    pub fn numerator(self) -> Self {
        match self.is_valid() {
            true => Ratio { exponent: self.exponent.max(0), den: Ratio::ONE.den, ..self },
            false => self,
        }
    }

    /// The denominator in lowest terms, positive.
    pub fn denominator(self) -> Self {
        match self.is_valid() {
            true => Ratio { exponent: (-self.exponent).max(0), ..Ratio::odd(self.den.as_()) },
            false => self,
        }
    }

    /// The reciprocal; undefined for zero, or if the numerator has more than 1024 bits.
    pub fn recip(self) -> Self {
        if !self.is_valid() || self.num.is_zero() || self.num.bit_width() > U1024::BITS {
            return Ratio::UNDEFINED;
        }
        let (num, den) = (self.den.as_(), self.num.as_());
        Ratio { num, den, exponent: -self.exponent, ..self }
    }

    /// The exact value of `x`; none if it does not fit.
    pub fn from_wide(x: Wide) -> Option<Self> {
        let (negative, significand, exponent) = x.parts()?;
        Ratio::normal(negative, significand.as_(), Ratio::ONE.den, exponent.try_into().ok()?)
    }

    /// `self / other`; none if `other` has no [`recip`](Self::recip) or the quotient does not fit.
    pub fn checked_div(self, other: Self) -> Option<Self> {
        (self * other.recip()).checked()
    }

    /// The nearest `f64`, ties to even; NaN if undefined.
    pub fn to_f64(self) -> f64 {
        let Some((negative, num, den, exponent)) = self.parts() else { return f64::NAN };
        if num.is_zero() {
            return 0.0;
        }
        // At least 64 bits of quotient; the remainder only tells on which side of a tie we are.
        let shift = (66 + den.bit_width()).saturating_sub(num.bit_width());
        let (num, den) = (num.as_::<Product>() << shift, den.as_::<Product>());
        let quotient = num / den;
        let low = quotient.bit_width() - 64;
        let sticky = quotient.trailing_zeros() < low || quotient * den != num;
        let exponent = i64::from(exponent) - i64::from(shift) + i64::from(low);
        nearest_f64(negative, (quotient >> low).as_(), sticky, exponent)
    }

    /// Sign, odd numerator, odd denominator and power of two.
    pub(super) fn parts(self) -> Option<(bool, U2048, U1024, i32)> {
        self.is_valid().then_some((self.negative, self.num, self.den, self.exponent))
    }

    /// Numerator with the sign of the fraction, odd denominator, and power of two.
    pub fn to_big(self) -> Option<(BigInt, BigInt, i32)> {
        let (negative, num, den, exponent) = self.parts()?;
        let sign = if negative { Sign::Minus } else { Sign::Plus };
        let num = BigInt::from_bytes_le(sign, &num.to_le_bytes());
        Some((num, BigInt::from_bytes_le(Sign::Plus, &den.to_le_bytes()), exponent))
    }

    /// Numerator and denominator as integers, if both have at most `bits` bits.
    pub(super) fn integers(self, bits: u32) -> Option<(U2048, U2048)> {
        let num = shifted(self.num, self.exponent.max(0).unsigned_abs())?;
        let den = shifted(self.den.as_(), self.exponent.min(0).unsigned_abs())?;
        (self.is_valid() && num.bit_width().max(den.bit_width()) <= bits).then_some((num, den))
    }
}

impl From<i64> for Ratio {
    fn from(n: i64) -> Self {
        Ratio::normal(n < 0, n.unsigned_abs().as_(), Ratio::ONE.den, 0).unwrap_or(Ratio::UNDEFINED)
    }
}

impl Ord for Ratio {
    fn cmp(&self, other: &Self) -> Ordering {
        let by_sign = self.is_valid().cmp(&other.is_valid()).then(self.sign().cmp(&other.sign()));
        if by_sign.is_ne() || self.num.is_zero() {
            return by_sign;
        }
        let left = self.num.as_::<Product>() * other.den.as_::<Product>();
        let right = other.num.as_::<Product>() * self.den.as_::<Product>();
        let length = |x: Product, exponent: i32| i64::from(x.bit_width()) + i64::from(exponent);
        // Of the same length, the one with the larger exponent has the fewer bits: the shift fits.
        let shift = self.exponent.abs_diff(other.exponent);
        let magnitude = length(left, self.exponent).cmp(&length(right, other.exponent)).then_with(
            || match self.exponent >= other.exponent {
                true => left.unbounded_shl(shift).cmp(&right),
                false => left.cmp(&right.unbounded_shl(shift)),
            },
        );
        if self.negative { magnitude.reverse() } else { magnitude }
    }
}

impl PartialOrd for Ratio {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// `-1/24`; a decimal with 12 digits and a `≈` if numerator or denominator have over 2048 bits.
impl fmt::Display for Ratio {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sign = if self.negative { "-" } else { "" };
        match self.integers(U2048::BITS) {
            _ if !self.is_valid() => f.write_str("undefined"),
            Some((num, den)) if den.is_one() => write!(f, "{sign}{num}"),
            Some((num, den)) => write!(f, "{sign}{num}/{den}"),
            None => write!(f, "≈{}", Wide::from(*self).to_decimal(12)),
        }
    }
}

impl fmt::Debug for Ratio {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

impl Scalar for Ratio {
    /// Exact; undefined if `c` is not finite.
    fn from_f64(c: f64) -> Self {
        let (magnitude, exponent) = decode(c);
        Some(c)
            .filter(|c| c.is_finite())
            .and_then(|c| Ratio::normal(c < 0.0, magnitude.as_(), Ratio::ONE.den, exponent))
            .unwrap_or(Ratio::UNDEFINED)
    }

    fn ratio(self, num: i32, den: i32) -> Self {
        self * Ratio::new(num.into(), den.into())
    }
}
