//! Division of polynomials.

use super::{Poly, Ratio};

impl<const N: usize> Poly<N> {
    /// The same polynomial with room for degrees below `M`; undefined where that is too little.
    pub fn with_room<const M: usize>(&self) -> Poly<M> {
        let terms = self.coefficients.iter().enumerate().filter(|(_, c)| !c.is_zero());
        terms.fold(Poly::ZERO, |sum, (k, &c)| sum + Poly::monomial(c, k))
    }

    /// The lowest power with a coefficient other than zero, and that; none for zero.
    pub(in crate::number) fn lowest(&self) -> Option<(usize, Ratio)> {
        self.coefficients.iter().position(|c| !c.is_zero()).map(|k| (k, self.coefficients[k]))
    }

    /// The quotient, if it is a polynomial.
    ///
    /// Terms are divided from the lowest one, since the denominators of steps begin with 1.
    pub fn divided_exactly_by(&self, divisor: &Self) -> Option<Self> {
        let (lowest, c) = divisor.lowest()?;
        let (inverse, degree) = (c.recip().checked()?, divisor.degree()?);
        let (mut rest, mut quotient) = (*self, Poly::ZERO);
        while let Some((k, c)) = rest.lowest() {
            let k = k.checked_sub(lowest).filter(|k| k + degree < N)?;
            let factor = (c * inverse).checked()?;
            quotient.coefficients[k] = factor;
            if !rest.accumulate(&-factor, k, divisor) {
                return None;
            }
        }
        Some(quotient)
    }

    /// The remainder of the division by a polynomial other than zero; none if it does not fit.
    pub fn remainder(&self, divisor: &Self) -> Option<Self> {
        let degree = divisor.degree()?;
        let inverse = divisor.coefficients[degree].recip().checked()?;
        let mut rest = self.checked()?;
        while let Some(k) = rest.degree().and_then(|k| k.checked_sub(degree)) {
            let factor = (rest.coefficients[k + degree] * inverse).checked()?;
            if !rest.accumulate(&-factor, k, divisor) {
                return None;
            }
        }
        Some(rest)
    }
}
