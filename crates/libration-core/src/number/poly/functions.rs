//! Elementary functions of polynomials, of which few have a value.

use super::{Poly, Ratio};
use crate::Elementary;

impl<const N: usize> Poly<N> {
    /// The value of a constant polynomial.
    fn value(self) -> Option<Ratio> {
        let constant = self.is_valid() && self.coefficients.iter().skip(1).all(Ratio::is_zero);
        constant.then(|| self.coefficient(0))
    }

    /// A choice by the order of two constants; undefined if one of them is not.
    fn select(self, other: Self, choose: impl FnOnce(Ratio, Ratio) -> Self) -> Self {
        match (self.value(), other.value()) {
            (Some(a), Some(b)) => choose(a, b),
            _ => Poly::UNDEFINED,
        }
    }
}

macro_rules! undefined {
    ($($function:ident($($other:ident)?))*) => {$(
        fn $function(self $(, $other: Self)?) -> Self {
            Poly::UNDEFINED
        }
    )*};
}

/// No transcendental function of a polynomial is one: all are undefined. So a nonlinear system can be
/// put on polynomials, and a step on it says that it has no matrix. What chooses among numbers is
/// exact for constants.
impl<const N: usize> Elementary for Poly<N> {
    undefined! {
        sqrt() recip() sin() cos() tan() asin() acos() atan() atan2(_x) exp() ln() sinh() cosh() tanh()
    }

    fn abs(self) -> Self {
        self.value().map_or(Poly::UNDEFINED, |c| Poly::constant(c.abs()))
    }

    fn min(self, other: Self) -> Self {
        self.select(other, |a, b| if b < a { other } else { self })
    }

    fn max(self, other: Self) -> Self {
        self.select(other, |a, b| if b > a { other } else { self })
    }

    fn signum(self) -> Self {
        self.value().map_or(Poly::UNDEFINED, |c| Poly::constant(Ratio::from(i64::from(c.sign()))))
    }

    fn select_less(self, other: Self, then: Self, otherwise: Self) -> Self {
        self.select(other, |a, b| if a < b { then } else { otherwise })
    }

    fn select_equal(self, other: Self, then: Self, otherwise: Self) -> Self {
        self.select(other, |a, b| if a == b { then } else { otherwise })
    }
}
