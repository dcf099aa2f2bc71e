//! Quotients of polynomials in one unknown.

use core::fmt;
use core::ops::{Add, Mul, Neg, Sub};

use super::{Poly, Ratio};
use crate::{Elementary, Scalar};

/// A quotient of two polynomials in `z` of degrees below `N`, with exact coefficients.
///
/// An implicit step run with `z` as its time step yields its own update matrix as quotients. Sums and products are put over a denominator
/// that one of the two has, where it is a multiple of the other, so that steps that solve the same equations several times keep their
/// degrees; [`RationalFunction::in_lowest_terms`] removes all common factors.
///
/// Operations are not inlined: numbers are kilobytes long, and the stack is short.
///
/// A degree of `N` or more, a coefficient that does not fit a [`Ratio`] and a division by zero make the quotient undefined, and everything
/// computed from it.
#[derive(Clone, Copy)]
pub struct RationalFunction<const N: usize> {
    numerator: Poly<N>,
    /// Zero if and only if the quotient is undefined.
    denominator: Poly<N>,
}

impl<const N: usize> RationalFunction<N> {
    /// The result of an overflow or of a division by zero.
    pub const UNDEFINED: Self =
        RationalFunction { numerator: Poly::UNDEFINED, denominator: Poly::ZERO };

    /// `numerator/denominator`.
    #[inline(never)]
    pub fn new(numerator: Poly<N>, denominator: Poly<N>) -> Self {
        if !numerator.is_valid() || !denominator.is_valid() || denominator == Poly::ZERO {
            return RationalFunction::UNDEFINED;
        }
        match numerator.divided_exactly_by(&denominator) {
            Some(quotient) => RationalFunction { numerator: quotient, denominator: Poly::one() },
            None => RationalFunction { numerator, denominator },
        }
    }

    /// The unknown `z` itself.
    pub fn unknown() -> Self {
        RationalFunction::from(Poly::unknown())
    }

    /// Whether the quotient is known: nothing overflowed on the way to it.
    pub fn is_valid(&self) -> bool {
        self.denominator != Poly::ZERO
    }

    /// The quotient, if it is known.
    pub fn checked(self) -> Option<Self> {
        self.is_valid().then_some(self)
    }

    /// The numerator.
    pub fn numerator(&self) -> &Poly<N> {
        &self.numerator
    }

    /// The denominator.
    pub fn denominator(&self) -> &Poly<N> {
        &self.denominator
    }

    /// The value at `z`, exactly; undefined at a pole.
    pub fn eval(&self, z: Ratio) -> Ratio {
        self.numerator.eval(z) * self.denominator.eval(z).recip()
    }

    /// The same quotient without common factors and with 1 as the lowest coefficient of the denominator, by Euclid's algorithm; as it is
    /// where that outgrows exact arithmetic.
    pub fn in_lowest_terms(self) -> Self {
        let reduced = self.checked().and_then(|own| {
            let (mut a, mut b) = (own.denominator, own.numerator);
            while b != Poly::ZERO {
                (a, b) = (b, a.remainder(&b)?);
            }
            let numerator = own.numerator.divided_exactly_by(&a)?;
            let denominator = own.denominator.divided_exactly_by(&a)?;
            let lowest = Poly::constant(denominator.lowest()?.1.recip());
            RationalFunction::new(numerator * lowest, denominator * lowest).checked()
        });
        reduced.unwrap_or(self)
    }

    /// Both numerators over one denominator.
    fn over_one_denominator(self, other: Self) -> (Poly<N>, Poly<N>, Poly<N>) {
        let (a, b) = (self.denominator, other.denominator);
        if let Some(factor) = b.divided_exactly_by(&a) {
            (self.numerator * factor, other.numerator, b)
        } else if let Some(factor) = a.divided_exactly_by(&b) {
            (self.numerator, other.numerator * factor, a)
        } else {
            (self.numerator * b, other.numerator * a, a * b)
        }
    }

    /// Whether both are known.
    fn are_valid(&self, other: &Self) -> bool {
        self.is_valid() && other.is_valid()
    }

    /// The value of a polynomial.
    fn polynomial(self) -> Poly<N> {
        if self.denominator == Poly::one() { self.numerator } else { Poly::UNDEFINED }
    }
}

impl<const N: usize> From<Poly<N>> for RationalFunction<N> {
    fn from(numerator: Poly<N>) -> Self {
        RationalFunction::new(numerator, Poly::one())
    }
}

/// Quotients are equal if their values are; undefined ones equal each other.
impl<const N: usize> PartialEq for RationalFunction<N> {
    fn eq(&self, other: &Self) -> bool {
        match (self.is_valid(), other.is_valid()) {
            (true, true) => {
                let (a, b, _) = self.over_one_denominator(*other);
                a == b
            }
            (own, other) => own == other,
        }
    }
}

impl<const N: usize> Add for RationalFunction<N> {
    type Output = Self;
    #[inline(never)]
    fn add(self, other: Self) -> Self {
        if !self.are_valid(&other) {
            return RationalFunction::UNDEFINED;
        }
        let (a, b, denominator) = self.over_one_denominator(other);
        RationalFunction::new(a + b, denominator)
    }
}

impl<const N: usize> Sub for RationalFunction<N> {
    type Output = Self;
    #[inline(never)]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl<const N: usize> Mul for RationalFunction<N> {
    type Output = Self;
    #[inline(never)]
    fn mul(self, other: Self) -> Self {
        if !self.are_valid(&other) {
            return RationalFunction::UNDEFINED;
        }
        // What cancels across needs no room.
        let left = RationalFunction::new(self.numerator, other.denominator);
        let right = RationalFunction::new(other.numerator, self.denominator);
        let numerator = left.numerator * right.numerator;
        RationalFunction::new(numerator, left.denominator * right.denominator)
    }
}

impl<const N: usize> Neg for RationalFunction<N> {
    type Output = Self;
    fn neg(self) -> Self {
        RationalFunction { numerator: -self.numerator, ..self }
    }
}

impl<const N: usize> Scalar for RationalFunction<N> {
    fn from_f64(c: f64) -> Self {
        RationalFunction::from(Poly::from_f64(c))
    }

    fn ratio(self, num: i32, den: i32) -> Self {
        if !self.is_valid() {
            return RationalFunction::UNDEFINED;
        }
        RationalFunction::new(self.numerator.ratio(num, den), self.denominator)
    }
}

macro_rules! of_polynomials {
    ($($function:ident($($other:ident)*))*) => {$(
        fn $function(self $(, $other: Self)*) -> Self {
            RationalFunction::from(self.polynomial().$function($($other.polynomial()),*))
        }
    )*};
}

/// Division, and what [polynomials](Poly) have: no transcendental function of a quotient is one.
impl<const N: usize> Elementary for RationalFunction<N> {
    #[inline(never)]
    fn recip(self) -> Self {
        RationalFunction::new(self.denominator, self.numerator)
    }

    of_polynomials! {
        sqrt() sin() cos() tan() asin() acos() atan() atan2(x) exp() ln() sinh() cosh() tanh() abs() signum()
        min(other) max(other) select_less(other then otherwise) select_equal(other then otherwise)
    }
}

/// `(1 − z²/4)/(1 + z²/4)`, and a polynomial where the denominator is 1.
impl<const N: usize> fmt::Display for RationalFunction<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.is_valid() {
            return f.write_str("undefined");
        }
        if self.denominator == Poly::one() {
            return fmt::Display::fmt(&self.numerator, f);
        }
        let bracketed = |p: &Poly<N>| match p.terms().filter(|c| !c.is_zero()).count() {
            0 | 1 => p.to_string(),
            _ => format!("({p})"),
        };
        // A quotient of a term would be read as one of its coefficient.
        write!(f, "{}/({})", bracketed(&self.numerator), self.denominator)
    }
}

impl<const N: usize> fmt::Debug for RationalFunction<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type Quotient = RationalFunction<8>;

    fn z() -> Quotient {
        Quotient::unknown()
    }

    #[test]
    fn arithmetic_agrees_with_that_of_fractions_at_a_point() {
        let (one, at) = (Quotient::one(), Ratio::new(3, 7));
        let f = (one + z()).quotient(one - z() * z());
        let g = (z() * z() + one).ratio(2, 3).recip();
        let value = |x: Quotient| x.eval(at);
        let quotient = |a: Ratio, b: Ratio| a * b.recip();
        assert_eq!(value(f), quotient(Ratio::new(10, 7), Ratio::new(40, 49)));
        assert_eq!(value(f + g), value(f) + value(g));
        assert_eq!(value(f - g), value(f) - value(g));
        assert_eq!(value(f * g), value(f) * value(g));
        assert_eq!(value(f.quotient(g)), quotient(value(f), value(g)));
        assert_eq!(f.quotient(g) * g, f);
        assert_ne!(f, g);
    }

    #[test]
    fn lowest_terms_are_shown() {
        let one = Quotient::one();
        let f = (one + z()).quotient(one - z() * z());
        assert_eq!(f.in_lowest_terms().to_string(), "1/(1 − z)");
        let g = (one - z() * z().ratio(1, 4)).quotient(one + z() * z().ratio(1, 4));
        assert_eq!(g.to_string(), "(1 − z²/4)/(1 + z²/4)");
        assert_eq!((g - g).to_string(), "0");
    }

    #[test]
    fn what_has_no_value_is_undefined() {
        let zero = Quotient::zero();
        assert!(!zero.recip().is_valid());
        assert!(!(zero.recip() * zero + Quotient::one()).is_valid());
        assert!(!z().sin().is_valid());
        let large = z() * z() * z() * z();
        assert!(!(large * large).is_valid() && !(large.recip() * large.recip()).is_valid());
    }
}
