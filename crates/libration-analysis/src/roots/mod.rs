//! The positive roots of a polynomial, isolated exactly.

mod dyadic;
mod integer_poly;
mod whole_poly;

pub(crate) use dyadic::Dyadic;
pub(crate) use integer_poly::IntegerPoly;
pub(crate) use whole_poly::WholePoly;

use libration_core::number::Wide;

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

/// The positive roots of several polynomials, each once, rising, in intervals that share no point; none of zero polynomials.
///
/// Roots are counted by Sturm's theorem (Basu, Pollack, Roy: Algorithms in Real Algebraic Geometry,
/// 2nd ed., §2.2.2) on whole numbers of any size, so that none is missed, however close two are.
pub(crate) fn positive_roots(polynomials: &[&IntegerPoly]) -> Vec<Root> {
    let chains: Vec<SturmChain> = coprime(polynomials).into_iter().map(SturmChain::new).collect();
    let roots =
        chains.iter().flat_map(|chain| chain.positive_roots().map(move |root| (root, chain)));
    let mut roots: Vec<(Root, &SturmChain)> = roots.collect();
    // Roots of different factors differ, so that their intervals part in the end.
    for precision in (2..).map(|times| times * PRECISION) {
        roots.sort_by(|(a, _), (b, _)| a.low.order(&b.low).then(a.high.order(&b.high)));
        let touching = |pair: &[(Root, &SturmChain)]| pair[0].0.high.order(&pair[1].0.low).is_ge();
        let near: Vec<usize> = (1..roots.len()).filter(|&i| touching(&roots[i - 1..=i])).collect();
        if near.is_empty() {
            break;
        }
        for i in near {
            for (root, chain) in &mut roots[i - 1..=i] {
                *root = chain.narrow(root.low.clone(), root.high.clone(), precision);
            }
        }
    }
    roots.into_iter().map(|(root, _)| root).collect()
}

/// Factors that have together the positive roots of all, each once, and no two of them the same: remainders of the product of all
/// would have many times as many digits.
fn coprime(polynomials: &[&IntegerPoly]) -> Vec<IntegerPoly> {
    let mut factors: Vec<IntegerPoly> = Vec::new();
    for p in polynomials.iter().filter(|p| !p.is_zero()) {
        let mut rest = p.without_roots_at_zero().square_free();
        for i in 0..factors.len() {
            let common = factors[i].gcd(&rest);
            if !common.is_constant() {
                rest = rest.quotient(&common);
                factors[i] = factors[i].quotient(&common);
                factors.push(common);
            }
        }
        factors.push(rest);
        factors.retain(|factor| !factor.is_constant());
    }
    factors
}

/// A Sturm sequence; the variations of its signs count roots.
struct SturmChain {
    members: Vec<IntegerPoly>,
}

impl SturmChain {
    /// The chain of a polynomial without double roots; of others, the last member is what it shares with its derivative.
    fn new(p: IntegerPoly) -> Self {
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

    /// The positive roots, rising.
    fn positive_roots(&self) -> impl Iterator<Item = Root> + use<> {
        let mut roots = Vec::new();
        if let Some((lowest, highest)) = self.members[0].octaves_of_positive_roots() {
            self.split_octaves(lowest, highest, &mut roots);
        }
        roots.into_iter()
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
            1 => roots.push(self.narrow(low, high, PRECISION)),
            _ => {
                let middle = low.middle(&high);
                self.split(low, middle.clone(), roots);
                self.split(middle, high, roots);
            }
        }
    }

    /// Narrows an interval with one root to `bits` bits by bisection on the sign.
    fn narrow(&self, mut low: Dyadic, mut high: Dyadic, precision: i64) -> Root {
        let p = &self.members[0];
        let above = p.sign_at(&high);
        if above == 0 {
            return Root { low: high.clone(), high };
        }
        while low.middle(&high).bits() <= precision {
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
    /// Whether this has a root in the interval of `root`, which has no more than one, and none at its lower end unless that is its
    /// upper one.
    pub(crate) fn vanishes_within(&self, root: &Root) -> bool {
        if self.sign_at(&root.high) == 0 {
            return true;
        }
        // A root without others is a change of sign.
        let p = self.square_free();
        p.sign_at(&root.low) * p.sign_at(&root.high) < 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn poly(coefficients: &[i64]) -> IntegerPoly {
        IntegerPoly::new(coefficients.iter().map(|&c| c.into()).collect())
    }

    fn roots(coefficients: &[i64]) -> Vec<f64> {
        positive_roots(&[&poly(coefficients)]).iter().map(|r| r.value().to_f64()).collect()
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
        // Its coefficients: n(n + 1), −n(2n + 1) and n².
        let p = IntegerPoly::new(vec![&n * (&n + 1), -&n * (2 * &n + 1), &n * &n]);
        assert_eq!(positive_roots(&[&p]).len(), 2);
    }

    #[test]
    fn roots_that_several_polynomials_share_are_found_once() {
        // (x − 1)²(x − 3), (x − 1)(x − 2) and zero.
        let [a, b, zero] = [poly(&[-3, 7, -5, 1]), poly(&[2, -3, 1]), poly(&[])];
        let found = positive_roots(&[&a, &zero, &b, &a]);
        let values: Vec<f64> = found.iter().map(|r| r.value().to_f64()).collect();
        assert_eq!(values, [1.0, 2.0, 3.0]);
        // Roots that 700 bits tell apart, and an interval that ends where another root is.
        let near = IntegerPoly::new(vec![
            -(num_bigint::BigInt::from(3) << 700_u32) - 1_u32,
            num_bigint::BigInt::from(1) << 700_u32,
        ]);
        let found = positive_roots(&[&near, &a]);
        assert_eq!(found.len(), 3);
        for pair in found.windows(2) {
            assert!(pair[0].high.order(&pair[1].low).is_lt(), "{pair:?}");
        }
    }

    #[test]
    fn factors_that_polynomials_share_are_found_and_those_of_their_residues_alone_are_none() {
        // (x − 1)(x − 2) and (x − 2)(x − 3); x − 1 and x − 2⁶¹, which have the same residues.
        let common = poly(&[2, -3, 1]).gcd(&poly(&[6, -5, 1]));
        assert!(common == poly(&[-2, 1]) || common == poly(&[2, -1]), "{common:?}");
        let same = poly(&[-1, 1]).gcd(&poly(&[-(1 << 61), 1]));
        assert!(same.is_constant() && !same.is_zero());
        let touched = poly(&[1, -2, 1]);
        let [root] = &positive_roots(&[&touched])[..] else { panic!() };
        assert!(touched.vanishes_within(root) && !poly(&[-2, 1]).vanishes_within(root));
        let [near] = &positive_roots(&[&poly(&[-2, 0, 1])])[..] else { panic!() };
        assert!(poly(&[4, 0, -4, 0, 1]).vanishes_within(near));
    }

    #[test]
    fn roots_of_any_size_are_reached() {
        // 2⁶²x − 1 and x − 2⁶².
        assert_eq!(roots(&[-1, 1 << 62]), [2.0_f64.powi(-62)]);
        assert_eq!(roots(&[-(1 << 62), 1]), [2.0_f64.powi(62)]);
    }
}
