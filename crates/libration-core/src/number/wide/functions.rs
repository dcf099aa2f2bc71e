//! Elementary functions of 1024-bit numbers, by series.

use std::sync::OnceLock;

use bnum::cast::As;
use bnum::types::U1024;

use super::{BITS, GUARD, Guarded, Wide};
use crate::{Elementary, Scalar};

mod elementary;

/// The largest angle, as a power of two, that `sin` and `cos` reduce.
const LARGEST_ANGLE: i64 = 512;

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
    /// π, rounded to nearest: `16 atan(1/5) − 4 atan(1/239)` (Machin).
    pub fn pi() -> Self {
        static PI: OnceLock<Wide> = OnceLock::new();
        *PI.get_or_init(|| {
            let quarter = (inverse_series(5, true) << 2) - inverse_series(239, true);
            Wide::rounded(false, quarter, 2 - 1144)
        })
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
    fn atan_of_fraction(self) -> Self {
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
            half_turn.scaled(-1) - (x / y).atan_of_fraction()
        } else if x.negative {
            half_turn + (y / x).atan_of_fraction()
        } else {
            (y / x).atan_of_fraction()
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

    /// The exponential of a number of magnitude below 2¹¹, with a relative error of at most 2⁻¹⁰⁰⁰; NaN beyond.
    pub fn exp(self) -> Self {
        if self.exponent().is_some_and(|e| e > 10) || self.is_nan() {
            return Wide::NAN;
        }
        // A small part of it, whose exponential is squared again and again.
        const HALVINGS: u32 = 18;
        let part = self.scaled(-i64::from(HALVINGS));
        let mut term = Wide::one();
        let sum = Wide::series(Wide::one(), |k| {
            term = (term * part).over_integer(k);
            term
        });
        (0..HALVINGS).fold(sum, |power, _| power * power)
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
