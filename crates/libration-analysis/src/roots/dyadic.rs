//! Dyadic rationals: integers times powers of two.

use core::cmp::Ordering;

use libration_core::Scalar;
use libration_core::number::Wide;
use num_bigint::BigInt;

/// `significand · 2^exponent`, exactly.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Dyadic {
    pub(super) significand: BigInt,
    pub(super) exponent: i64,
}

impl Dyadic {
    /// `2^exponent`.
    pub(crate) fn power_of_two(exponent: i64) -> Self {
        Dyadic { significand: 1.into(), exponent }
    }

    /// `self · 2^power`.
    pub(crate) fn scaled(&self, power: i64) -> Self {
        Dyadic { significand: self.significand.clone(), exponent: self.exponent + power }
    }

    /// The number half way between two.
    pub(crate) fn middle(&self, other: &Self) -> Self {
        let exponent = self.exponent.min(other.exponent);
        let aligned = |x: &Self| &x.significand << (x.exponent - exponent) as u64;
        Dyadic { significand: aligned(self) + aligned(other), exponent: exponent - 1 }.reduced()
    }

    /// Whether this is less than `other`, the same or more.
    pub(super) fn order(&self, other: &Self) -> Ordering {
        let exponent = self.exponent.min(other.exponent);
        let aligned = |x: &Self| &x.significand << (x.exponent - exponent) as u64;
        aligned(self).cmp(&aligned(other))
    }

    /// The same number with an odd significand.
    fn reduced(self) -> Self {
        let twos = self.significand.trailing_zeros().unwrap_or(0);
        Dyadic { significand: self.significand >> twos, exponent: self.exponent + twos as i64 }
    }

    /// Bits of the significand.
    pub(super) fn bits(&self) -> i64 {
        self.significand.bits() as i64
    }

    /// The value, rounded to 1024 bits.
    pub(crate) fn to_wide(&self) -> Wide {
        let (sign, words) = self.significand.to_u64_digits();
        let word = |w: u64| {
            let half = |x: u64| Wide::from_f64(x as f64);
            half(w >> 32).scaled(32) + half(w & 0xffff_ffff)
        };
        let size = words.iter().rev().fold(Wide::ZERO, |sum, &w| sum.scaled(64) + word(w));
        let value = size.scaled(self.exponent);
        if sign == num_bigint::Sign::Minus { -value } else { value }
    }
}
