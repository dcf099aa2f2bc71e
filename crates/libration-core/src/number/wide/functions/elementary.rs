//! The trait [`Elementary`] of 1024-bit numbers.

use crate::number::Wide;
use crate::{Elementary, Scalar};

impl Wide {
    /// `√(1 − self²)`.
    fn leg(self) -> Self {
        ((Wide::one() - self) * (Wide::one() + self)).sqrt()
    }

    /// The hyperbolic sine and cosine of a number of magnitude below 2¹¹, with a relative error of at most 2⁻⁹⁹⁹;
    /// NaN beyond.
    pub fn sinh_cosh(self) -> (Self, Self) {
        let up = self.exp();
        let down = up.recip();
        let cosh = (up + down).scaled(-1);
        // Below 1 the difference of the exponentials would cancel.
        if self.exponent().is_some_and(|e| e >= 0) {
            return ((up - down).scaled(-1), cosh);
        }
        let square = self * self;
        let mut term = self;
        let sinh = Wide::series(self, |k| {
            term = (term * square).over_integer(2 * k * (2 * k + 1));
            term
        });
        (sinh, cosh)
    }

    /// NaN if one of two numbers is, else the one that is chosen.
    fn choose(self, other: Self, choose_other: bool) -> Self {
        match (self.is_nan() || other.is_nan(), choose_other) {
            (true, _) => Wide::NAN,
            (false, true) => other,
            (false, false) => self,
        }
    }
}

/// `asin`, `acos` and `atan` have relative errors of at most 2⁻¹⁰¹³ and are NaN where they are undefined. `tan` has
/// the absolute errors of [`sin_cos`](Wide::sin_cos); `exp`, `ln` and `atan2` are the methods of these names.
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

    fn tan(self) -> Self {
        let (sin, cos) = self.sin_cos();
        sin / cos
    }

    fn asin(self) -> Self {
        self.atan2(self.leg())
    }

    fn acos(self) -> Self {
        self.leg().atan2(self)
    }

    fn atan(self) -> Self {
        self.atan2(Wide::one())
    }

    fn atan2(self, x: Self) -> Self {
        self.atan2(x)
    }

    fn exp(self) -> Self {
        self.exp()
    }

    fn ln(self) -> Self {
        self.ln()
    }

    fn sinh(self) -> Self {
        self.sinh_cosh().0
    }

    fn cosh(self) -> Self {
        self.sinh_cosh().1
    }

    fn tanh(self) -> Self {
        let (sinh, cosh) = self.sinh_cosh();
        sinh / cosh
    }

    fn abs(self) -> Self {
        self.abs()
    }

    fn min(self, other: Self) -> Self {
        self.choose(other, other < self)
    }

    fn max(self, other: Self) -> Self {
        self.choose(other, other > self)
    }

    fn signum(self) -> Self {
        match (self.exponent(), self.is_negative()) {
            (None, _) => self,
            (Some(_), true) => -Wide::one(),
            (Some(_), false) => Wide::one(),
        }
    }

    fn select_less(self, other: Self, then: Self, otherwise: Self) -> Self {
        if self < other { then } else { otherwise }
    }

    fn select_equal(self, other: Self, then: Self, otherwise: Self) -> Self {
        if self == other { then } else { otherwise }
    }
}
