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
    fn sin(self) -> Self {
        self.chain(self.re.sin(), self.re.cos())
    }

    #[inline(always)]
    fn cos(self) -> Self {
        self.chain(self.re.cos(), -self.re.sin())
    }
}
