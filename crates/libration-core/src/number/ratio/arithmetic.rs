//! Sums and products of fractions that stay in lowest terms.

use core::cmp::Ordering;
use core::ops::{Add, Mul, Neg, Sub};

use bnum::cast::As;
use bnum::types::{U1024, U2048};

use super::{Ratio, in_range, shifted};

/// The greatest common divisor of two odd numbers (binary algorithm).
fn gcd(mut a: U1024, mut b: U1024) -> U1024 {
    while a != b {
        if a < b {
            (a, b) = (b, a);
        }
        a -= b;
        a >>= a.trailing_zeros();
    }
    a
}

/// The greatest common divisor of an odd `num` and an odd `den`.
fn gcd_wide(num: U2048, den: U1024) -> U1024 {
    if den.is_one() {
        return den;
    }
    let rest: U1024 = (num % den.as_::<U2048>()).as_();
    if rest.is_zero() { den } else { gcd(rest >> rest.trailing_zeros(), den) }
}

impl Ratio {
    /// `a/b + c/d` over the least common multiple of `b` and `d` (Knuth, *The Art of Computer
    /// Programming*, vol. 2, 4.5.1).
    pub(in crate::number) fn plus(&self, other: &Self) -> Option<Self> {
        if !self.is_valid() || !other.is_valid() {
            return None;
        }
        if self.num.is_zero() || other.num.is_zero() {
            return Some(if self.num.is_zero() { *other } else { *self });
        }
        let (low, high) =
            if self.exponent <= other.exponent { (self, other) } else { (other, self) };
        let shift = high.exponent.checked_sub(low.exponent)?.unsigned_abs();
        let (mut a, mut c, mut den) = (low.num, shifted(high.num, shift)?, low.den);
        let mut common = low.den;
        if low.den != high.den {
            common = if low.den.is_one() || high.den.is_one() {
                U1024::power_of_two(0)
            } else {
                gcd(low.den, high.den)
            };
            let extra = high.den / common;
            a = a.checked_mul(extra.as_())?;
            c = c.checked_mul((low.den / common).as_())?;
            den = den.checked_mul(extra)?;
        }
        let (negative, num) = match a.cmp(&c) {
            _ if low.negative == high.negative => (low.negative, a.checked_add(c)?),
            Ordering::Less => (high.negative, c.wrapping_sub(a)),
            _ => (low.negative, a.wrapping_sub(c)),
        };
        if num.is_zero() {
            return Some(Ratio::ZERO);
        }
        let twos = num.trailing_zeros();
        let exponent = low.exponent.checked_add_unsigned(twos).and_then(in_range)?;
        let num = num >> twos;
        let g = gcd_wide(num, common);
        let (num, den) = if g.is_one() { (num, den) } else { (num / g.as_::<U2048>(), den / g) };
        Some(Ratio { negative, exponent, num, den })
    }

    /// `a/b · c/d`, reduced crosswise before multiplying so that nothing grows in vain.
    pub(in crate::number) fn times(&self, other: &Self) -> Option<Self> {
        if !self.is_valid() || !other.is_valid() {
            return None;
        }
        if self.num.is_zero() || other.num.is_zero() {
            return Some(Ratio::ZERO);
        }
        let (g, h) = (gcd_wide(self.num, other.den), gcd_wide(other.num, self.den));
        let reduced = |num: U2048, g: U1024| if g.is_one() { num } else { num / g.as_::<U2048>() };
        let divided = |den: U1024, g: U1024| if g.is_one() { den } else { den / g };
        let num = reduced(self.num, g).checked_mul(reduced(other.num, h))?;
        let den = divided(self.den, h).checked_mul(divided(other.den, g))?;
        let exponent = self.exponent.checked_add(other.exponent).and_then(in_range)?;
        Some(Ratio { negative: self.negative != other.negative, exponent, num, den })
    }
}

impl Add for Ratio {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.plus(&other).unwrap_or(Ratio::UNDEFINED)
    }
}

impl Sub for Ratio {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Ratio {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        self.times(&other).unwrap_or(Ratio::UNDEFINED)
    }
}

impl Neg for Ratio {
    type Output = Self;
    fn neg(self) -> Self {
        Ratio { negative: !self.negative && !self.num.is_zero(), ..self }
    }
}
