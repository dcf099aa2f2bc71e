//! The positive roots of a polynomial, isolated exactly.

mod dyadic;
mod integer_poly;

pub(crate) use dyadic::Dyadic;
pub(crate) use integer_poly::IntegerPoly;

use crate::number::Wide;

/// Bits to which a root is narrowed, beside its leading one.
const PRECISION: i64 = 320;

/// One positive root of a polynomial, in an interval that holds no other.
#[derive(Clone, Debug)]
pub(crate) struct Root {
    /// The root lies above this, or at it if both ends are the same.
    pub(crate) low: Dyadic,
    /// The root does not lie above this.
    pub(crate) high: Dyadic,
}

impl Root {
    /// The root to 96 decimal digits.
    pub(crate) fn value(&self) -> Wide {
        self.low.middle(&self.high).to_wide()
    }
}

/// The positive roots of `p`, each once, rising; none of the zero polynomial.
///
/// Roots are counted by Sturm's theorem (Basu, Pollack, Roy: Algorithms in Real Algebraic Geometry,
/// 2nd ed., §2.2.2) on whole numbers of any size, so that none is missed, however close two are.
pub(crate) fn positive_roots(p: &IntegerPoly) -> Vec<Root> {
    let p = p.without_roots_at_zero();
    let Some((lowest, highest)) = p.octaves_of_positive_roots() else { return Vec::new() };
    let chain = SturmChain::new(p);
    let mut roots = Vec::new();
    chain.split_octaves(lowest, highest, &mut roots);
    roots
}

/// A Sturm sequence; the variations of its signs count roots.
struct SturmChain {
    members: Vec<IntegerPoly>,
}

impl SturmChain {
    /// The chain of a polynomial, with each of its roots once.
    fn new(p: IntegerPoly) -> Self {
        let chain = SturmChain::of_remainders(p);
        // The last member is the greatest common divisor of the polynomial and its derivative.
        match chain.members.as_slice() {
            [p, .., common] if !common.is_constant() => {
                SturmChain::of_remainders(p.quotient(common))
            }
            _ => chain,
        }
    }

    fn of_remainders(p: IntegerPoly) -> Self {
        let derivative = p.derivative();
        let mut members = vec![p, derivative];
        while let [.., a, b] = members.as_slice() {
            if b.is_zero() {
                members.pop();
                break;
            }
            let next = a.remainder(b).negated();
            members.push(next);
        }
        SturmChain { members }
    }

    fn variations(&self, x: &Dyadic) -> usize {
        let signs: Vec<i32> =
            self.members.iter().map(|p| p.sign_at(x)).filter(|&s| s != 0).collect();
        signs.windows(2).filter(|pair| pair[0] != pair[1]).count()
    }

    /// The number of roots above `low` and not above `high`.
    fn count(&self, low: &Dyadic, high: &Dyadic) -> usize {
        self.variations(low).saturating_sub(self.variations(high))
    }

    /// Collects the roots in `(2^low, 2^high]`, halving the range of exponents.
    fn split_octaves(&self, low: i64, high: i64, roots: &mut Vec<Root>) {
        let ends = (Dyadic::power_of_two(low), Dyadic::power_of_two(high));
        match self.count(&ends.0, &ends.1) {
            0 => {}
            _ if high - low > 1 => {
                let middle = low + (high - low) / 2;
                self.split_octaves(low, middle, roots);
                self.split_octaves(middle, high, roots);
            }
            _ => self.split(ends.0, ends.1, roots),
        }
    }

    /// Collects the roots in `(low, high]`, halving the interval.
    fn split(&self, low: Dyadic, high: Dyadic, roots: &mut Vec<Root>) {
        match self.count(&low, &high) {
            0 => {}
            1 => roots.push(self.narrow(low, high)),
            _ => {
                let middle = low.middle(&high);
                self.split(low, middle.clone(), roots);
                self.split(middle, high, roots);
            }
        }
    }

    /// Narrows an interval with one root by bisection on the sign, which changes there.
    fn narrow(&self, mut low: Dyadic, mut high: Dyadic) -> Root {
        let p = &self.members[0];
        let above = p.sign_at(&high);
        if above == 0 {
            return Root { low: high.clone(), high };
        }
        while low.middle(&high).bits() <= PRECISION {
            let middle = low.middle(&high);
            match p.sign_at(&middle) {
                0 => return Root { low: middle.clone(), high: middle },
                sign if sign == above => high = middle,
                _ => low = middle,
            }
        }
        Root { low, high }
    }
}

impl IntegerPoly {
    /// Whether this has a root in the interval of `root`.
    pub(crate) fn vanishes_within(&self, root: &Root) -> bool {
        self.sign_at(&root.high) == 0
            || SturmChain::new(self.clone()).count(&root.low, &root.high) > 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn poly(coefficients: &[i64]) -> IntegerPoly {
        IntegerPoly::new(coefficients.iter().map(|&c| c.into()).collect())
    }

    fn roots(coefficients: &[i64]) -> Vec<f64> {
        positive_roots(&poly(coefficients)).iter().map(|r| r.value().to_f64()).collect()
    }

    #[test]
    fn roots_are_found_once_each_and_rising() {
        // (x − 1)²(x − 2)(x + 3)x
        assert_eq!(roots(&[0, -6, 13, -7, -1, 1]), [1.0, 2.0]);
        assert_eq!(roots(&[-2, 0, 1]), [2.0_f64.sqrt()]);
        assert!(roots(&[1, 0, 1]).is_empty());
        assert!(roots(&[5]).is_empty());
        assert!(roots(&[]).is_empty());
    }

    #[test]
    fn roots_a_part_in_10_to_the_16_apart_are_told_apart() {
        // (10¹⁶x − 10¹⁶)(10¹⁶x − 10¹⁶ − 1)
        let n = num_bigint::BigInt::from(10_u64.pow(16));
        let factor = |root: &num_bigint::BigInt| IntegerPoly::new(vec![-root, n.clone()]);
        let p = factor(&n).times(&factor(&(&n + 1)));
        assert_eq!(positive_roots(&p).len(), 2);
    }

    #[test]
    fn roots_of_any_size_are_reached() {
        // 2⁶²x − 1 and x − 2⁶².
        assert_eq!(roots(&[-1, 1 << 62]), [2.0_f64.powi(-62)]);
        assert_eq!(roots(&[-(1 << 62), 1]), [2.0_f64.powi(62)]);
    }
}
