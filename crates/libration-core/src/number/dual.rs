//! First-order forward differentiation.

use core::ops::{Add, Mul, Neg, Sub};

use crate::{Elementary, Scalar};

/// The dual number `re + du·ε` with `ε² = 0`: a value and its derivative along one direction.
///
/// A step run on dual numbers returns, beside the new state, one column of its own Jacobian: seed
/// the coordinate of interest with [`Dual::variable`] and the others with [`Dual::constant`]. The
/// derivative is that of the arithmetic as written, free of truncation error; each part is rounded
/// as `S` rounds (Griewank and Walther, *Evaluating Derivatives*, 2nd ed., section 3.1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<S> {
    /// The value.
    pub re: S,
    /// Its derivative along the seeded direction.
    pub du: S,
}

impl<S: Scalar> Dual<S> {
    /// A value that does not depend on the seeded direction.
    #[inline(always)]
    pub fn constant(re: S) -> Self {
        Dual { re, du: S::zero() }
    }

    /// The quantity with respect to which everything is differentiated.
    #[inline(always)]
    pub fn variable(re: S) -> Self {
        Dual { re, du: S::one() }
    }

    /// `f(self)`, from the value and the slope of `f` at `self.re`.
    #[inline(always)]
    fn chain(self, value: S, slope: S) -> Self {
        Dual { re: value, du: slope * self.du }
    }
}

impl<S: Scalar> Add for Dual<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Dual { re: self.re + other.re, du: self.du + other.du }
    }
}

impl<S: Scalar> Sub for Dual<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Dual { re: self.re - other.re, du: self.du - other.du }
    }
}

impl<S: Scalar> Mul for Dual<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Dual { re: self.re * other.re, du: self.re * other.du + self.du * other.re }
    }
}

impl<S: Scalar> Neg for Dual<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Dual { re: -self.re, du: -self.du }
    }
}

impl<S: Scalar> Scalar for Dual<S> {
    #[inline(always)]
    fn from_f64(c: f64) -> Self {
        Dual::constant(S::from_f64(c))
    }

    #[inline(always)]
    fn ratio(self, num: i32, den: i32) -> Self {
        Dual { re: self.re.ratio(num, den), du: self.du.ratio(num, den) }
    }
}

impl<S: Elementary> Elementary for Dual<S> {
    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.re.sqrt();
        self.chain(root, root.recip().ratio(1, 2))
    }

    #[inline(always)]
    fn recip(self) -> Self {
        let inverse = self.re.recip();
        self.chain(inverse, -(inverse * inverse))
    }

    #[inline(always)]
    fn quotient(self, divisor: Self) -> Self {
        let quotient = self.re.quotient(divisor.re);
        Dual { re: quotient, du: (self.du - quotient * divisor.du).quotient(divisor.re) }
    }

    #[inline(always)]
    fn sin(self) -> Self {
        self.chain(self.re.sin(), self.re.cos())
    }

    #[inline(always)]
    fn cos(self) -> Self {
        self.chain(self.re.cos(), -self.re.sin())
    }

    #[inline(always)]
    fn tan(self) -> Self {
        let tangent = self.re.tan();
        self.chain(tangent, S::one() + tangent * tangent)
    }

    #[inline(always)]
    fn asin(self) -> Self {
        self.chain_from_end(self.re.asin(), self.arcsine_slope())
    }

    #[inline(always)]
    fn acos(self) -> Self {
        self.chain_from_end(self.re.acos(), -self.arcsine_slope())
    }

    #[inline(always)]
    fn atan(self) -> Self {
        self.chain(self.re.atan(), (S::one() + self.re * self.re).recip())
    }

    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        let inverse = (x.re * x.re + self.re * self.re).recip();
        Dual { re: self.re.atan2(x.re), du: (x.re * self.du - self.re * x.du) * inverse }
    }

    #[inline(always)]
    fn exp(self) -> Self {
        let exponential = self.re.exp();
        self.chain(exponential, exponential)
    }

    #[inline(always)]
    fn ln(self) -> Self {
        self.chain(self.re.ln(), self.re.recip())
    }

    #[inline(always)]
    fn sinh(self) -> Self {
        self.chain(self.re.sinh(), self.re.cosh())
    }

    #[inline(always)]
    fn cosh(self) -> Self {
        self.chain(self.re.cosh(), self.re.sinh())
    }

    /// Its slope is `1/cosh²`: `1 − tanh²` would lose its digits far from zero.
    #[inline(always)]
    fn tanh(self) -> Self {
        let inverse = self.re.cosh().recip();
        self.chain(self.re.tanh(), inverse * inverse)
    }

    /// Its slope at 0 is 0, the middle of the slopes on both sides.
    #[inline(always)]
    fn abs(self) -> Self {
        self.chain(self.re.abs(), self.re.signum())
    }

    /// Of equal values it has the derivative of `self`.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        let du = other.re.select_less(self.re, other.du, self.du);
        Dual { re: self.re.min(other.re), du }
    }

    /// Of equal values it has the derivative of `self`.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        let du = self.re.select_less(other.re, other.du, self.du);
        Dual { re: self.re.max(other.re), du }
    }

    /// Its slope is 0, also at the jump.
    #[inline(always)]
    fn signum(self) -> Self {
        Dual::constant(self.re.signum())
    }

    #[inline(always)]
    fn select_less(self, other: Self, then: Self, otherwise: Self) -> Self {
        Dual {
            re: self.re.select_less(other.re, then.re, otherwise.re),
            du: self.re.select_less(other.re, then.du, otherwise.du),
        }
    }

    #[inline(always)]
    fn select_equal(self, other: Self, then: Self, otherwise: Self) -> Self {
        Dual {
            re: self.re.select_equal(other.re, then.re, otherwise.re),
            du: self.re.select_equal(other.re, then.du, otherwise.du),
        }
    }
}

impl<S: Elementary> Dual<S> {
    /// `1/√(1 − re²)`, infinite at ±1.
    #[inline(always)]
    fn arcsine_slope(self) -> S {
        ((S::one() - self.re) * (S::one() + self.re)).sqrt().recip()
    }

    /// [`chain`](Self::chain) for a slope that may be infinite: a constant has the derivative 0 nevertheless.
    #[inline(always)]
    fn chain_from_end(self, value: S, slope: S) -> Self {
        let du = self.du.select_equal(S::zero(), self.du, slope * self.du);
        Dual { re: value, du }
    }
}
