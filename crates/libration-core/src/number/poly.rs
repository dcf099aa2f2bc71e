//! Polynomials in one unknown.

use core::fmt;
use core::ops::{Add, Mul, Neg, Sub};

use super::{Ratio, Wide};
use crate::Scalar;

mod division;
mod functions;

/// A polynomial in `z` of degree below `N`, with exact coefficients.
///
/// A step run with `z` as its time step yields its own update matrix as a function of the time
/// step: derived from the code that ships rather than from a textbook.
///
/// A product of degree `N` or more, or a coefficient that does not fit a [`Ratio`], makes the
/// whole polynomial undefined, and everything computed from it.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Poly<const N: usize> {
    coefficients: [Ratio; N],
}

impl<const N: usize> Poly<N> {
    /// Zero.
    pub const ZERO: Self = Poly::filled(Ratio::ZERO);

    /// The result of an overflow.
    pub const UNDEFINED: Self = Poly::filled(Ratio::UNDEFINED);

    const fn filled(c: Ratio) -> Self {
        const { assert!(N > 0, "a polynomial needs room for a constant") };
        Poly { coefficients: [c; N] }
    }

    /// The polynomial with the given coefficients, that of `z⁰` first.
    pub fn new(coefficients: [Ratio; N]) -> Self {
        let poly = Poly { coefficients };
        if poly.is_valid() { poly } else { Poly::UNDEFINED }
    }

    /// The constant polynomial `c`.
    pub fn constant(c: Ratio) -> Self {
        Poly::monomial(c, 0)
    }

    /// The unknown `z` itself.
    pub fn unknown() -> Self {
        Poly::monomial(Ratio::ONE, 1)
    }

    /// `c·zᵏ`.
    pub fn monomial(c: Ratio, k: usize) -> Self {
        let mut p = Poly::ZERO;
        match p.coefficients.get_mut(k) {
            Some(place) if c.is_valid() => *place = c,
            None if c.is_zero() => {}
            _ => return Poly::UNDEFINED,
        }
        p
    }

    /// Whether the polynomial is known: nothing overflowed on the way to it.
    pub fn is_valid(&self) -> bool {
        self.coefficients.iter().all(Ratio::is_valid)
    }

    /// The polynomial, if it is known.
    pub fn checked(self) -> Option<Self> {
        self.is_valid().then_some(self)
    }

    /// The coefficient of `zᵏ`, zero beyond the degree.
    pub fn coefficient(&self, k: usize) -> Ratio {
        match self.coefficients.get(k) {
            Some(&c) => c,
            None if self.is_valid() => Ratio::ZERO,
            None => Ratio::UNDEFINED,
        }
    }

    /// The highest power with a coefficient other than zero; none for zero, `N − 1` if undefined.
    pub fn degree(&self) -> Option<usize> {
        self.coefficients.iter().rposition(|c| !c.is_zero())
    }

    /// The value at `z`, exactly.
    pub fn eval(&self, z: Ratio) -> Ratio {
        self.coefficients.iter().rev().fold(Ratio::ZERO, |sum, &c| sum * z + c)
    }

    /// The value at `z` by Horner's rule on the correctly rounded coefficients.
    ///
    /// The error is at most `2·N·u·Σ|cₖ zᵏ|`, where `u = 2⁻⁵³` (Higham, *Accuracy and Stability
    /// of Numerical Algorithms*, section 5.1).
    pub fn eval_f64(&self, z: f64) -> f64 {
        self.terms().fold(0.0, |sum, c| sum * z + c.to_f64())
    }

    /// The value at `z` in 1024 bits.
    pub fn eval_wide(&self, z: Wide) -> Wide {
        self.terms().fold(Wide::ZERO, |sum, &c| sum * z + Wide::from(c))
    }

    /// The coefficients from that of the degree downwards.
    pub(super) fn terms(&self) -> impl Iterator<Item = &Ratio> {
        let length = self.degree().map_or(0, |degree| degree + 1);
        self.coefficients[..length].iter().rev()
    }

    /// The polynomial in `−z`.
    pub fn reflected(mut self) -> Self {
        for c in self.coefficients.iter_mut().skip(1).step_by(2) {
            *c = -*c;
        }
        self
    }

    /// The derivative with respect to `z`.
    pub fn derivative(&self) -> Self {
        let mut p = Poly::ZERO;
        for (k, c) in self.coefficients.iter().enumerate().skip(1) {
            p.coefficients[k - 1] = *c * Ratio::from(k as i64);
        }
        if self.is_valid() && p.is_valid() { p } else { Poly::UNDEFINED }
    }

    /// `self += factor · zᵏ · other`; false if something does not fit.
    fn accumulate(&mut self, factor: &Ratio, k: usize, other: &Self) -> bool {
        for (j, c) in other.coefficients.iter().enumerate().filter(|(_, c)| !c.is_zero()) {
            let sum =
                self.coefficients.get(k + j).zip(factor.times(c)).and_then(|(a, b)| a.plus(&b));
            match sum {
                Some(sum) => self.coefficients[k + j] = sum,
                None => return false,
            }
        }
        true
    }
}

impl<const N: usize> Add for Poly<N> {
    type Output = Self;
    fn add(mut self, other: Self) -> Self {
        let fits = self.is_valid() && self.accumulate(&Ratio::ONE, 0, &other);
        if fits { self } else { Poly::UNDEFINED }
    }
}

impl<const N: usize> Sub for Poly<N> {
    type Output = Self;
    fn sub(mut self, other: Self) -> Self {
        let fits = self.is_valid() && self.accumulate(&-Ratio::ONE, 0, &other);
        if fits { self } else { Poly::UNDEFINED }
    }
}

impl<const N: usize> Mul for Poly<N> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let mut product = Poly::ZERO;
        let mut fits = self.is_valid() && other.is_valid();
        for (k, c) in self.coefficients.iter().enumerate().filter(|(_, c)| !c.is_zero()) {
            fits = fits && product.accumulate(c, k, &other);
        }
        if fits { product } else { Poly::UNDEFINED }
    }
}

impl<const N: usize> Neg for Poly<N> {
    type Output = Self;
    fn neg(mut self) -> Self {
        for c in &mut self.coefficients {
            *c = -*c;
        }
        self
    }
}

impl<const N: usize> Scalar for Poly<N> {
    fn from_f64(c: f64) -> Self {
        Poly::constant(Ratio::from_f64(c))
    }

    fn ratio(mut self, num: i32, den: i32) -> Self {
        let factor = Ratio::new(num.into(), den.into());
        for c in &mut self.coefficients {
            *c = *c * factor;
        }
        if self.is_valid() { self } else { Poly::UNDEFINED }
    }
}

/// `1 − z²/2 + z⁴/24`. A coefficient with over 64 bits is shown with 12 digits, as
/// `≈1.35120719196·z`.
impl<const N: usize> fmt::Display for Poly<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.is_valid() {
            return f.write_str("undefined");
        }
        let mut first = true;
        for (k, c) in self.coefficients.iter().enumerate().filter(|(_, c)| !c.is_zero()) {
            f.write_str(match (first, c.sign() < 0) {
                (true, true) => "−",
                (true, false) => "",
                (false, true) => " − ",
                (false, false) => " + ",
            })?;
            first = false;
            write_term(f, c.abs(), k)?;
        }
        if first { f.write_str("0") } else { Ok(()) }
    }
}

/// `c·zᵏ` for a positive `c`.
fn write_term(f: &mut fmt::Formatter<'_>, c: Ratio, k: usize) -> fmt::Result {
    let power = match k {
        0 => String::new(),
        1 => "z".into(),
        _ => format!("z{}", superscript(k)),
    };
    let Some((num, den)) = c.integers(64) else {
        let dot = if k == 0 { "" } else { "·" };
        return write!(f, "≈{}{dot}{power}", plain(&Wide::from(c).to_decimal(12)));
    };
    if k == 0 || !num.is_one() {
        write!(f, "{num}")?;
    }
    f.write_str(&power)?;
    if den.is_one() { Ok(()) } else { write!(f, "/{den}") }
}

/// `d.dddekk` without its exponent, where that reads better.
fn plain(scientific: &str) -> String {
    let power = scientific.split_once('e').and_then(|(m, e)| Some((m, e.parse::<i32>().ok()?)));
    match power {
        Some((mantissa, 0)) => mantissa.into(),
        Some((mantissa, power @ -4..0)) => {
            let zeros = "0".repeat(power.unsigned_abs() as usize - 1);
            format!("0.{zeros}{}", mantissa.replace('.', ""))
        }
        Some((mantissa, power @ 1..6)) => {
            let mut digits = mantissa.replace('.', "");
            digits.insert(power as usize + 1, '.');
            digits
        }
        _ => scientific.into(),
    }
}

fn superscript(k: usize) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    k.to_string().bytes().map(|digit| DIGITS[usize::from(digit - b'0')]).collect()
}

impl<const N: usize> fmt::Debug for Poly<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}
