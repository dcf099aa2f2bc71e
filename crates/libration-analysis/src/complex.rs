//! Complex numbers with 1024 bits.

use libration_core::number::Wide;
use libration_core::{Elementary, Scalar};

/// A complex number.
#[derive(Clone, Copy, Debug)]
pub struct Complex {
    /// Real part.
    pub re: Wide,
    /// Imaginary part.
    pub im: Wide,
}

impl Complex {
    /// The absolute value.
    pub fn abs(self) -> Wide {
        (self.re * self.re + self.im * self.im).sqrt()
    }

    /// The angle in `(−π, π]` rad.
    pub fn arg(self) -> Wide {
        self.im.atan2(self.re)
    }

    pub(super) fn plus(self, o: Self) -> Self {
        Complex { re: self.re + o.re, im: self.im + o.im }
    }

    pub(super) fn minus(self, o: Self) -> Self {
        Complex { re: self.re - o.re, im: self.im - o.im }
    }

    pub(super) fn times(self, o: Self) -> Self {
        Complex { re: self.re * o.re - self.im * o.im, im: self.re * o.im + self.im * o.re }
    }

    pub(super) fn over(self, o: Self) -> Self {
        let scale = (o.re * o.re + o.im * o.im).recip();
        let conjugate = Complex { re: o.re * scale, im: -o.im * scale };
        self.times(conjugate)
    }

    /// `re + 0·i`.
    pub(super) fn real(re: Wide) -> Self {
        Complex { re, im: Wide::ZERO }
    }

    /// The complex conjugate.
    pub(super) fn conjugate(self) -> Self {
        Complex { im: -self.im, ..self }
    }

    /// `selfⁿ`, by repeated squaring.
    pub(super) fn powi(self, n: u64) -> Self {
        let (mut result, mut square) = (Complex::real(Wide::one()), self);
        for bit in 0..u64::BITS - n.leading_zeros() {
            if n >> bit & 1 == 1 {
                result = result.times(square);
            }
            square = square.times(square);
        }
        result
    }
}
