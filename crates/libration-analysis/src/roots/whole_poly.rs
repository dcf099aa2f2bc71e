//! Polynomials with integer coefficients of any size, and their values.

use core::ops::{Add, Mul, Sub};

use libration_core::number::{Poly, Ratio};
use num_bigint::BigInt;
use num_integer::Integer;

use super::IntegerPoly;

/// A polynomial with whole coefficients, that of `x⁰` first.
#[derive(Clone, Debug)]
pub(crate) struct WholePoly {
    coefficients: Vec<BigInt>,
}

impl WholePoly {
    /// Polynomials as numerators over one positive denominator, which comes last; none if one of them is undefined.
    pub(crate) fn over_one_denominator<const N: usize, const K: usize>(
        polynomials: [&Poly<N>; K],
    ) -> Option<([Self; K], Self)> {
        let mut parts: Vec<(BigInt, BigInt, i32)> = Vec::with_capacity(K * N);
        for p in polynomials {
            for k in 0..N {
                parts.push(Ratio::to_big(p.coefficient(k))?);
            }
        }
        let odd = parts.iter().fold(BigInt::from(1), |lcm, (_, den, _)| lcm.lcm(den));
        let lowest = parts.iter().map(|part| part.2).min()?.min(0);
        let scaled = |(num, den, exponent): &(BigInt, BigInt, i32)| {
            (num * (&odd / den)) << exponent.abs_diff(lowest)
        };
        let numerators = core::array::from_fn(|i| {
            let own = &parts[i * N..(i + 1) * N];
            WholePoly { coefficients: own.iter().map(scaled).collect() }
        });
        let denominator = odd << lowest.unsigned_abs();
        Some((numerators, WholePoly { coefficients: vec![denominator] }))
    }

    /// A primitive polynomial, of which this is a positive multiple.
    pub(crate) fn primitive(self) -> IntegerPoly {
        IntegerPoly::new(self.coefficients)
    }

    fn termwise(&self, other: &Self, of: impl Fn(&BigInt, &BigInt) -> BigInt) -> Self {
        let length = self.coefficients.len().max(other.coefficients.len());
        let zero = BigInt::ZERO;
        let at = |p: &Self, k: usize| p.coefficients.get(k).unwrap_or(&zero).clone();
        WholePoly { coefficients: (0..length).map(|k| of(&at(self, k), &at(other, k))).collect() }
    }
}

impl Add for &WholePoly {
    type Output = WholePoly;
    fn add(self, other: Self) -> WholePoly {
        self.termwise(other, |a, b| a + b)
    }
}

impl Sub for &WholePoly {
    type Output = WholePoly;
    fn sub(self, other: Self) -> WholePoly {
        self.termwise(other, |a, b| a - b)
    }
}

impl Mul for &WholePoly {
    type Output = WholePoly;
    fn mul(self, other: Self) -> WholePoly {
        let (a, b) = (&self.coefficients, &other.coefficients);
        let mut product = vec![BigInt::ZERO; (a.len() + b.len()).saturating_sub(1)];
        for (i, a) in a.iter().enumerate().filter(|(_, a)| **a != BigInt::ZERO) {
            for (j, b) in b.iter().enumerate() {
                product[i + j] += a * b;
            }
        }
        WholePoly { coefficients: product }
    }
}
