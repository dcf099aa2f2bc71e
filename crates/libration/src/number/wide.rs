//! Binary floating point with 1024 bits.

use core::cmp::Ordering;
use core::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::OnceLock;

use bnum::Uint;
use bnum::cast::As;
use bnum::types::{U1024, U2048};

use super::{Ratio, TwoFloat};
use crate::{Elementary, Scalar};

/// Bits of the significand.
const BITS: u32 = U1024::BITS;

/// A significand with 127 guard bits below it and one bit for the carry above.
type Guarded = Uint<144>;
const GUARD: u32 = Guarded::BITS - BITS - 1;

/// Exponents stay within `±LIMIT`, so that the sum of two of them fits its type.
const LIMIT: i64 = 1 << 61;

/// The largest angle, as a power of two, that `sin` and `cos` reduce.
const LARGEST_ANGLE: i64 = 512;

/// A floating-point number with a 1024-bit significand and an `i64` exponent.
///
/// It is for what vanishes in `f64`: a determinant that misses 1 by 10⁻¹⁷, a phase error of
/// 10⁻⁶⁰, or the millionth power of an update matrix, 10⁶⁹⁸⁹⁷⁰.
///
/// `+`, `-` and `*` round to nearest and have a relative error of at most 2⁻¹⁰²³, also when terms
/// nearly cancel; `/`, `sqrt` and the conversion from [`Ratio`] at most 2⁻¹⁰²¹; the functions
/// state their own. There is no infinity: what has no value (`1/0`, `√−1`, an exponent beyond
/// ±2⁶¹) is NaN, which propagates and compares with nothing.
#[derive(Clone, Copy)]
pub struct Wide {
    negative: bool,
    /// The value is `±significand · 2^exponent`. The top bit of the significand is set, but in
    /// zero (exponent 0) and in NaN (exponent 1), where the significand is 0.
    exponent: i64,
    significand: U1024,
}

/// `±top · 2^exponent` rounded to nearest, ties to even, where `top` has its highest bit set, and
/// `sticky` tells that the value lies a little further from zero.
pub(super) fn nearest_f64(negative: bool, top: u64, sticky: bool, exponent: i64) -> f64 {
    let leading = exponent.saturating_add(63);
    // Bits that an f64 of this size has: 53, fewer among the subnormals.
    let keep = (leading + 1075).clamp(-1, 53);
    let magnitude = if leading > 1023 {
        f64::INFINITY
    } else if keep < 0 {
        0.0
    } else {
        let drop = 64 - keep as u32;
        let kept = top.unbounded_shr(drop);
        let (half, rest) = (1 << (drop - 1), top & (u64::MAX >> (64 - drop)));
        let up = rest > half || rest == half && (sticky || kept & 1 == 1);
        // A carry out of the significand runs into the exponent field, where it belongs.
        let field = ((leading + 1022).max(0) as u64) << 52;
        f64::from_bits(field + kept + u64::from(up))
    };
    if negative { -magnitude } else { magnitude }
}

/// `Σ (±1)ᵏ / ((2k+1) n^(2k+1))`, which is `atan(1/n)` or `atanh(1/n)`, in units of 2⁻¹¹⁴⁴.
fn inverse_series(n: u64, alternate: bool) -> Guarded {
    let square: Guarded = (n * n).as_();
    let mut power = Guarded::power_of_two(1144) / n.as_::<Guarded>();
    let mut sum = power;
    for k in 1_u64.. {
        power /= square;
        let term = power / (2 * k + 1).as_::<Guarded>();
        if term.is_zero() {
            break;
        }
        sum = if alternate && k % 2 == 1 { sum - term } else { sum + term };
    }
    sum
}

/// `ln 2`, with an error below 2⁻¹⁰²⁴.
fn ln_2() -> Wide {
    static LN_2: OnceLock<Wide> = OnceLock::new();
    *LN_2.get_or_init(|| Wide::rounded(false, inverse_series(3, false), -1143))
}

impl Wide {
    /// Zero.
    pub const ZERO: Self = Wide { negative: false, exponent: 0, significand: U1024::MIN };

    /// What has no value.
    pub const NAN: Self = Wide { negative: false, exponent: 1, significand: U1024::MIN };

    /// `±magnitude · 2^exponent`, rounded to nearest.
    fn rounded<const N: usize>(negative: bool, magnitude: Uint<N>, exponent: i64) -> Self {
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

    /// π, rounded to nearest: `16 atan(1/5) − 4 atan(1/239)` (Machin).
    pub fn pi() -> Self {
        static PI: OnceLock<Wide> = OnceLock::new();
        *PI.get_or_init(|| {
            let quarter = (inverse_series(5, true) << 2) - inverse_series(239, true);
            Wide::rounded(false, quarter, 2 - 1144)
        })
    }

    /// Whether this is zero.
    pub fn is_zero(self) -> bool {
        self.significand.is_zero() && !self.is_nan()
    }

    /// Whether there is no value here.
    pub fn is_nan(self) -> bool {
        self.significand.is_zero() && self.exponent != 0
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
        (!self.significand.is_zero()).then(|| self.leading())
    }

    fn leading(self) -> i64 {
        self.exponent + i64::from(BITS - 1)
    }

    /// `self · 2^power`, exactly.
    pub fn scaled(self, power: i64) -> Self {
        if self.significand.is_zero() {
            return self;
        }
        let exponent = self.exponent.saturating_add(power);
        Wide::normal(self.negative, self.significand, false, exponent.clamp(-2 * LIMIT, 2 * LIMIT))
    }

    /// The value rounded to nearest, ties to even; infinite above the range of `f64`.
    pub fn to_f64(self) -> f64 {
        if self.significand.is_zero() {
            return if self.is_nan() { f64::NAN } else { 0.0 };
        }
        let top = (self.significand >> (BITS - 64)).as_();
        let sticky = self.significand.trailing_zeros() < BITS - 64;
        nearest_f64(self.negative, top, sticky, self.exponent + i64::from(BITS - 64))
    }

    /// The magnitude rounded to an integer, half up; none if that does not fit.
    fn nearest_integer(self) -> Option<U1024> {
        match u32::try_from(-self.exponent) {
            _ if self.significand.is_zero() => (!self.is_nan()).then_some(U1024::MIN),
            Ok(0) => Some(self.significand),
            Ok(shift) if shift <= BITS => {
                let up: U1024 = self.significand.bit(shift - 1).as_();
                Some(self.significand.unbounded_shr(shift) + up)
            }
            _ if self.exponent < 0 => Some(U1024::MIN),
            _ => None,
        }
    }

    fn over_integer(self, divisor: u64) -> Self {
        if self.significand.is_zero() {
            return self;
        }
        let quotient = (self.significand.as_::<Guarded>() << GUARD) / divisor.as_::<Guarded>();
        Wide::rounded(self.negative, quotient, self.exponent - i64::from(GUARD))
    }

    /// `first + Σ tₖ` with `tₖ₊₁ = next(tₖ, k)`, until the terms no longer count.
    fn series(first: Self, mut next: impl FnMut(u64) -> Self) -> Self {
        let mut sum = first;
        for k in 1_u64.. {
            let term = next(k);
            if term.significand.is_zero() || term.leading() < sum.leading() - i64::from(BITS) - 8 {
                break;
            }
            sum = sum + term;
        }
        sum
    }

    /// `(sin, cos)`, with an absolute error of at most `2⁻¹⁰¹⁵·max(1, |self|)`.
    ///
    /// NaN beyond `|self| = 2⁵¹²`, where half of the digits would be lost.
    pub fn sin_cos(self) -> (Self, Self) {
        let quarters = (self.exponent().is_none_or(|e| e < LARGEST_ANGLE))
            .then(|| (self * Wide::pi().recip()).scaled(1))
            .and_then(Self::nearest_integer);
        let Some(quarters) = quarters else { return (Wide::NAN, Wide::NAN) };
        let r = self - Wide::rounded(self.negative, quarters, 0) * Wide::pi().scaled(-1);
        let square = -(r * r);
        let taylor = |first: Wide, n: u64| {
            let mut term = first;
            Wide::series(first, |k| {
                term = (term * square).over_integer((2 * k - 1 + n) * (2 * k + n));
                term
            })
        };
        let (sin, cos) = (taylor(r, 1), taylor(Wide::one(), 0));
        let turn = quarters.as_::<u64>() % 4;
        match if self.negative { (4 - turn) % 4 } else { turn } {
            0 => (sin, cos),
            1 => (cos, -sin),
            2 => (-sin, -cos),
            _ => (-cos, sin),
        }
    }

    /// `atan` of a number of magnitude at most 1.
    fn atan(self) -> Self {
        // atan t = 2 atan(t / (1 + √(1 + t²))): three times leaves |t| < 0.1.
        let mut t = self;
        for _ in 0..3 {
            t = t / (Wide::one() + (Wide::one() + t * t).sqrt());
        }
        let square = -(t * t);
        t.odd_series(square).scaled(3)
    }

    /// `Σ self·squareᵏ/(2k+1)`.
    fn odd_series(self, square: Self) -> Self {
        let mut power = self;
        Wide::series(self, |k| {
            power = power * square;
            power.over_integer(2 * k + 1)
        })
    }

    /// The angle of the vector `(x, self)` in `(−π, π]`, with a relative error of at most 2⁻¹⁰¹⁵.
    ///
    /// The angle of the zero vector is 0.
    pub fn atan2(self, x: Self) -> Self {
        let y = self;
        if y.is_zero() && !x.is_negative() {
            return if x.is_nan() { x } else { y };
        }
        let half_turn = if y.negative { -Wide::pi() } else { Wide::pi() };
        if y.abs() > x.abs() {
            half_turn.scaled(-1) - (x / y).atan()
        } else if x.negative {
            half_turn + (y / x).atan()
        } else {
            (y / x).atan()
        }
    }

    /// The natural logarithm, with a relative error of at most 2⁻¹⁰¹⁵; NaN unless positive.
    pub fn ln(self) -> Self {
        if self.negative || self.significand.is_zero() {
            return Wide::NAN;
        }
        // A mantissa between about √½ and √2, so that a number close to 1 has exponent 0.
        let leading = self.leading();
        let mantissa = self.scaled(-leading);
        let halve = i64::from(mantissa.to_f64() > core::f64::consts::SQRT_2);
        let m = mantissa.scaled(-halve);
        let t = (m - Wide::one()) / (m + Wide::one());
        let doublings = leading + halve;
        let count: U1024 = doublings.unsigned_abs().as_();
        Wide::rounded(doublings < 0, count, 0) * ln_2() + t.odd_series(t * t).scaled(1)
    }

    /// The decimal logarithm, with a relative error of at most 2⁻¹⁰¹⁴; NaN unless positive.
    pub fn log10(self) -> Self {
        self.ln() / Wide::from_f64(10.0).ln()
    }

    /// `self^n` by repeated squaring, with a relative error of at most `2n·2⁻¹⁰²³`.
    pub fn powi(self, mut n: u64) -> Self {
        let (mut power, mut square) = (Wide::one(), self);
        while n > 0 {
            if n & 1 == 1 {
                power = power * square;
            }
            n >>= 1;
            if n > 0 {
                square = square * square;
            }
        }
        power
    }

    /// The value in decimal scientific notation with 1 to 300 digits, as `1.25e434`.
    ///
    /// The digits are those of the nearest decimal, up to the error of [`powi`](Self::powi) for the
    /// power of ten.
    pub fn to_decimal(self, digits: usize) -> String {
        let digits = digits.clamp(1, 300);
        if self.significand.is_zero() {
            return if self.is_nan() { "NaN".into() } else { "0".into() };
        }
        let ten = Wide::from_f64(10.0);
        let mut power = (self.leading() as f64 * core::f64::consts::LOG10_2).floor() as i64;
        let scale = ten.powi(power.unsigned_abs());
        let mut m = if power < 0 { self.abs() * scale } else { self.abs() / scale };
        while m >= ten {
            (m, power) = (m / ten, power + 1);
        }
        while m < Wide::one() {
            (m, power) = (m * ten, power - 1);
        }
        let integer = m * ten.powi(digits as u64 - 1);
        let Some(integer) = integer.nearest_integer() else { return "NaN".into() };
        let mut text = integer.to_string();
        if text.len() > digits {
            power += 1;
        }
        text.truncate(digits);
        if digits > 1 {
            text.insert(1, '.');
        }
        format!("{}{text}e{power}", if self.negative { "-" } else { "" })
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
        if self.significand.is_zero() || other.significand.is_zero() {
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
        if self.is_nan() || other.significand.is_zero() {
            return Wide::NAN;
        }
        if self.is_zero() {
            return self;
        }
        let dividend = self.significand.as_::<U2048>() << BITS;
        let quotient = dividend / other.significand.as_::<U2048>();
        let exponent = self.exponent - other.exponent - i64::from(BITS);
        Wide::rounded(self.negative != other.negative, quotient, exponent)
    }
}

impl Neg for Wide {
    type Output = Self;
    fn neg(self) -> Self {
        Wide { negative: !self.negative && !self.significand.is_zero(), ..self }
    }
}

impl From<Ratio> for Wide {
    fn from(ratio: Ratio) -> Self {
        let Some((negative, num, den, exponent)) = ratio.parts() else { return Wide::NAN };
        let den = Wide::rounded(false, den, 0);
        Wide::rounded(negative, num, 0).scaled(exponent.into()) / den
    }
}

impl From<TwoFloat> for Wide {
    /// Exact.
    fn from(x: TwoFloat) -> Self {
        Wide::from_f64(x.hi()) + Wide::from_f64(x.lo())
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

/// `|c| = magnitude · 2^exponent` of a finite `c`.
pub(super) fn decode(c: f64) -> (u64, i32) {
    let field = (c.to_bits() >> 52 & 0x7ff) as i32;
    let fraction = c.to_bits() & ((1 << 52) - 1);
    if field == 0 { (fraction, -1074) } else { (fraction | 1 << 52, field - 1075) }
}

impl Elementary for Wide {
    /// Newton's iteration from the `f64` root; five steps reach 1600 bits.
    fn sqrt(self) -> Self {
        if self.negative || self.significand.is_zero() {
            return if self.is_zero() { self } else { Wide::NAN };
        }
        let even = self.leading() & !1;
        let x = self.scaled(-even);
        let seed = Wide::from_f64(x.to_f64().sqrt());
        (0..5).fold(seed, |y, _| (y + x / y).scaled(-1)).scaled(even / 2)
    }

    fn recip(self) -> Self {
        Wide::one() / self
    }

    fn sin(self) -> Self {
        self.sin_cos().0
    }

    fn cos(self) -> Self {
        self.sin_cos().1
    }
}
