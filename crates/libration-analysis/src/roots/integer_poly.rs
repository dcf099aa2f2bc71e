//! Primitive polynomials with integer coefficients.

use libration_core::number::Poly;
use num_bigint::{BigInt, Sign};
use num_integer::Integer;

use super::{Dyadic, WholePoly};

/// A primitive polynomial: whole coefficients without a common factor.
///
/// It stands for all its positive multiples: signs and roots are those of the polynomial that it
/// was made from, values are not; where those count there is [`WholePoly`].
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct IntegerPoly {
    /// That of `x⁰` first; the last is not zero.
    coefficients: Vec<BigInt>,
}

/// The prime of residues, 2⁶¹ − 1.
const PRIME: u64 = (1 << 61) - 1;

fn residues(coefficients: &[BigInt]) -> Vec<u64> {
    let residue = |c: &BigInt| c.mod_floor(&PRIME.into()).iter_u64_digits().next().unwrap_or(0);
    coefficients.iter().map(residue).collect()
}

fn times(a: u64, b: u64) -> u64 {
    (u128::from(a) * u128::from(b) % u128::from(PRIME)) as u64
}

/// The inverse of a residue that is not zero, by Fermat's theorem.
fn inverse(a: u64) -> u64 {
    let (mut power, mut square, mut exponent) = (1, a, PRIME - 2);
    while exponent > 0 {
        if exponent & 1 == 1 {
            power = times(power, square);
        }
        square = times(square, square);
        exponent >>= 1;
    }
    power
}

/// The remainder of a division of polynomials of residues; the leading one of `divisor` is not zero.
fn remainder_of_residues(mut rest: Vec<u64>, divisor: &[u64]) -> Vec<u64> {
    let unit = divisor.last().map_or(0, |leading| inverse(*leading));
    while rest.len() >= divisor.len() {
        let shift = rest.len() - divisor.len();
        let factor = rest.pop().map_or(0, |leading| times(leading, unit));
        for (r, d) in rest[shift..].iter_mut().zip(divisor) {
            *r = (*r + PRIME - times(factor, *d)) % PRIME;
        }
    }
    while rest.last() == Some(&0) {
        rest.pop();
    }
    rest
}

impl IntegerPoly {
    /// The polynomial with these coefficients, that of `x⁰` first, divided by their content.
    pub(crate) fn new(mut coefficients: Vec<BigInt>) -> Self {
        while coefficients.last().is_some_and(|c| c.sign() == Sign::NoSign) {
            coefficients.pop();
        }
        // The first two already have nearly all of it; the remainders of the others are then small, and most are zero.
        let reduced = |g: &BigInt, c: &BigInt| if g == &BigInt::ZERO { c.clone() } else { c % g };
        let content = coefficients.iter().fold(BigInt::ZERO, |g, c| g.gcd(&reduced(&g, c)));
        for c in &mut coefficients {
            *c = &*c / &content;
        }
        IntegerPoly { coefficients }
    }

    /// The primitive multiple of `p`; none if `p` is undefined.
    pub(crate) fn of<const N: usize>(p: &Poly<N>) -> Option<Self> {
        let ([numerator], _) = WholePoly::over_one_denominator([p])?;
        Some(numerator.primitive())
    }

    /// Whether this is the zero polynomial.
    pub(crate) fn is_zero(&self) -> bool {
        self.coefficients.is_empty()
    }

    /// The sign at `x`: −1, 0 or 1.
    pub(crate) fn sign_at(&self, x: &Dyadic) -> i32 {
        let (up, down) = (x.exponent.max(0) as u64, (-x.exponent).max(0) as u64);
        let x = &x.significand << up;
        // Horner's rule on 2^(k·down)·c: all terms have the same denominator.
        let mut shift = 0;
        let value = self.coefficients.iter().rev().fold(BigInt::ZERO, |sum, c| {
            let next = sum * &x + (c << shift);
            shift += down;
            next
        });
        match value.sign() {
            Sign::Minus => -1,
            Sign::NoSign => 0,
            Sign::Plus => 1,
        }
    }

    pub(super) fn derivative(&self) -> Self {
        let terms = self.coefficients.iter().enumerate().skip(1);
        IntegerPoly::new(terms.map(|(k, c)| c * k).collect())
    }

    pub(super) fn negated(self) -> Self {
        IntegerPoly { coefficients: self.coefficients.into_iter().map(|c| -c).collect() }
    }

    /// A positive multiple of the remainder of the division by `divisor`, which is not zero.
    pub(super) fn remainder(&self, divisor: &Self) -> Self {
        let mut rest = self.coefficients.clone();
        self.eliminate(divisor, &mut rest);
        IntegerPoly::new(rest)
    }

    /// A multiple of the quotient of the division by `divisor`, which is not zero.
    pub(super) fn quotient(&self, divisor: &Self) -> Self {
        let mut rest = self.coefficients.clone();
        IntegerPoly::new(self.eliminate(divisor, &mut rest))
    }

    /// Divides `rest` by `divisor`, multiplying it by positive numbers so that it stays whole, and
    /// gives the quotient.
    fn eliminate(&self, divisor: &Self, rest: &mut Vec<BigInt>) -> Vec<BigInt> {
        let divisor = &divisor.coefficients;
        let Some(leading) = divisor.last() else { return Vec::new() };
        let size = BigInt::from(leading.magnitude().clone());
        let mut quotient = vec![BigInt::ZERO; (rest.len() + 1).saturating_sub(divisor.len())];
        while rest.len() >= divisor.len() {
            let shift = rest.len() - divisor.len();
            let mut factor = rest.pop().unwrap_or_default();
            if leading.sign() == Sign::Minus {
                factor = -factor;
            }
            rest.iter_mut().chain(&mut quotient).for_each(|c| *c *= &size);
            quotient[shift] += &factor;
            for (k, c) in divisor[..divisor.len() - 1].iter().enumerate() {
                rest[k + shift] -= &factor * c;
            }
        }
        quotient
    }

    /// The polynomial with each of its roots once.
    pub(super) fn square_free(&self) -> Self {
        let common = self.gcd(&self.derivative());
        if common.is_constant() { self.clone() } else { self.quotient(&common) }
    }

    /// The greatest common divisor.
    pub(crate) fn gcd(&self, other: &Self) -> Self {
        if self.are_coprime_by_residues(other) {
            return IntegerPoly { coefficients: vec![BigInt::from(1)] };
        }
        let (mut a, mut b) = (self.clone(), other.clone());
        while !b.is_zero() {
            (a, b) = (b.clone(), a.remainder(&b));
        }
        a
    }

    /// Whether the residues of both modulo a prime have no common factor: then they have none either, as the leading coefficients
    /// stay (von zur Gathen, Gerhard: Modern Computer Algebra, 3rd ed., lemma 6.25). The remainders of whole numbers would take their
    /// digits for the same answer.
    fn are_coprime_by_residues(&self, other: &Self) -> bool {
        let [mut a, mut b] = [self, other].map(|p| residues(&p.coefficients));
        if [&a, &b].iter().any(|p| p.last().is_none_or(|leading| *leading == 0)) {
            return false;
        }
        while b.len() > 1 {
            (a, b) = (b.clone(), remainder_of_residues(a, &b));
        }
        !b.is_empty()
    }

    /// The polynomial divided by the highest power of `x` that divides it.
    pub(super) fn without_roots_at_zero(&self) -> Self {
        let zeros = self.coefficients.iter().take_while(|c| c.sign() == Sign::NoSign).count();
        IntegerPoly { coefficients: self.coefficients[zeros..].to_vec() }
    }

    /// The polynomials without their roots at zero, and in `x²` in place of `x` if all of them are
    /// even then: that halves their degrees. On the positive axis signs stay what they were.
    pub(crate) fn in_squares<const N: usize>(polynomials: [&Self; N]) -> ([Self; N], bool) {
        let stripped = polynomials.map(IntegerPoly::without_roots_at_zero);
        let odd = |p: &Self| p.coefficients.iter().skip(1).step_by(2).any(|c| c != &BigInt::ZERO);
        if stripped.iter().any(odd) {
            return (stripped, false);
        }
        let halved = |p: Self| p.coefficients.into_iter().step_by(2).collect();
        (stripped.map(|p| IntegerPoly { coefficients: halved(p) }), true)
    }

    /// Whether this is a constant.
    pub(super) fn is_constant(&self) -> bool {
        self.coefficients.len() <= 1
    }

    /// Exponents `a < b` such that every positive root lies in `(2^a, 2^b)`; none if there is no
    /// root. The constant term is not zero.
    ///
    /// Cauchy's bound on the roots, and on their reciprocals.
    pub(super) fn octaves_of_positive_roots(&self) -> Option<(i64, i64)> {
        let bits = |c: &BigInt| c.bits() as i64;
        let (first, last) = (self.coefficients.first()?, self.coefficients.last()?);
        let largest = self.coefficients.iter().map(bits).max()?;
        let bound = |end: &BigInt| (largest - bits(end)).max(0) + 2;
        (self.coefficients.len() > 1).then(|| (-bound(first), bound(last)))
    }
}
