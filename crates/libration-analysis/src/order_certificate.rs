//! The order of a splitting method, from its word alone.

use libration_core::number::Wide;
use libration_core::{Integrator, Scalar};

use super::{Letter, Tableau};

/// The error of a splitting method, degree by degree.
///
/// The step is a product of exponentials, `e^{b₁K} e^{c₁D} …`, in the free algebra on the kick `K`
/// and the drift `D`, and the flow is `e^{K + D}`, in which every word of `n` letters has the
/// coefficient `1/n!`. The order is `p` if all words of up to `p` letters agree: a statement about
/// every system at once. A test on an oscillator cannot give it, since there words that differ act
/// alike (Hairer, Lubich, Wanner: Geometric Numerical Integration, 2nd ed., §III.5.)
#[derive(Clone, Debug)]
pub struct OrderCertificate {
    /// The largest difference of a coefficient among the words of 1, 2, … letters, times `n!`.
    pub residuals: Vec<Wide>,
    /// What the rounding of weights to `f64` may leave of them.
    rounding: Vec<f64>,
}

/// The most that weights which are rounded to `f64` change coefficients of the words of `letters` letters, times `n!`, where the sizes of
/// all weights add up to `path`.
///
/// The sizes of all these coefficients add up to `pathⁿ/n!`, and each is a product of `n` weights.
pub(super) fn rounding_of_words(letters: usize, path: f64) -> f64 {
    letters as f64 * path.powi(letters as i32) * f64::EPSILON
}

/// The sum of the sizes of the weights.
pub(super) fn path_of(word: &[Letter]) -> f64 {
    word.iter().map(|letter| letter.weight().to_f64().abs()).sum()
}

impl OrderCertificate {
    /// Compares all words of up to `degree` letters; none if the method is not a splitting method.
    pub fn new(integrator: impl Integrator, degree: usize) -> Option<Self> {
        let word = Tableau::new(integrator)?.word()?;
        let series = word.iter().fold(Series::one(degree), |product, letter| product.then(*letter));
        let residuals = (1..=degree).map(|n| {
            let factorial = (1..=n).fold(Wide::one(), |f, k| f * Wide::from_f64(k as f64));
            let words = series.coefficients[n].iter();
            words.fold(Wide::ZERO, |worst, &c| larger(worst, (c * factorial - Wide::one()).abs()))
        });
        let path = path_of(&word);
        let rounding = (1..=degree).map(|letters| rounding_of_words(letters, path)).collect();
        Some(OrderCertificate { residuals: residuals.collect(), rounding })
    }

    /// The order: the number of leading degrees without a residual, up to the rounding of weights.
    pub fn order(&self) -> usize {
        let pairs = self.residuals.iter().zip(&self.rounding);
        pairs.take_while(|(residual, rounding)| residual.to_f64() <= **rounding).count()
    }
}

fn larger(a: Wide, b: Wide) -> Wide {
    if b > a { b } else { a }
}

/// A power series in two letters that do not commute.
struct Series {
    /// For each length, the coefficients of its words; a word is a number in binary, its first
    /// letter the highest bit, a drift a one.
    coefficients: Vec<Vec<Wide>>,
}

impl Series {
    fn one(degree: usize) -> Self {
        let mut coefficients: Vec<Vec<Wide>> =
            (0..=degree).map(|n| vec![Wide::ZERO; 1 << n]).collect();
        coefficients[0][0] = Wide::one();
        Series { coefficients }
    }

    /// `self · e^{w·letter}`.
    fn then(&self, letter: Letter) -> Series {
        let weight = Wide::from(letter.weight());
        let drift = matches!(letter, Letter::Drift(_));
        let degree = self.coefficients.len() - 1;
        let mut product = Series::one(degree);
        product.coefficients[0][0] = Wide::ZERO;
        // w^k/k! · letter^k, appended to every word that leaves room for it.
        let mut power = Wide::one();
        for k in 0..=degree {
            let run = if drift { (1 << k) - 1 } else { 0 };
            for (n, words) in self.coefficients[..=degree - k].iter().enumerate() {
                for (word, &c) in words.iter().enumerate().filter(|(_, c)| !c.is_zero()) {
                    let place = &mut product.coefficients[n + k][word << k | run];
                    *place = *place + c * power;
                }
            }
            power = power * weight / Wide::from_f64(k as f64 + 1.0);
        }
        product
    }
}

#[cfg(test)]
mod tests {
    use libration_core::integrator::{Composition, Splitting, VelocityVerlet};
    use libration_core::{Method, with_method};

    use super::*;
    use crate::{SymbolicStep, UnknownStep};

    fn order(integrator: impl Integrator) -> Option<usize> {
        OrderCertificate::new(integrator, 6).map(|c| c.order())
    }

    #[test]
    fn the_words_of_the_shipped_splitting_methods_have_the_orders_that_they_claim() {
        for method in Method::ALL {
            let claimed = match method {
                Method::ExplicitEuler | Method::Rk4 => None,
                _ => Some(method.order() as usize),
            };
            assert_eq!(with_method!(method, |m| order(m)), claimed, "{}", method.name());
        }
    }

    #[test]
    fn a_method_of_order_four_on_oscillators_and_three_elsewhere_is_seen_through() {
        // On one oscillator K² = D² = 0, so words with a repeated letter do not show. These weights
        // solve all conditions of four letters but KDDD and KKKD.
        let r = 105.0_f64.sqrt();
        let lookalike = Splitting {
            kicks: [0.5, -0.25, (3.0 + r) / 24.0, (15.0 - r) / 24.0],
            drifts: [(9.0 - r) / 12.0, (r - 3.0) / 12.0, 0.5, 0.0],
        };
        assert_eq!(order(lookalike), Some(3));
        let step = SymbolicStep::new(lookalike).unwrap().matrix;
        let differs = |p: UnknownStep, exact: [f64; 5]| {
            (0..5).any(|k| (p.coefficient(k).to_f64() - exact[k]).abs() > 1e-15)
        };
        assert!(!differs(step.entry(0, 0), [1.0, 0.0, -0.5, 0.0, 1.0 / 24.0]));
        assert!(!differs(step.entry(0, 1), [0.0, 1.0, 0.0, -1.0 / 6.0, 0.0]));
    }

    #[test]
    fn wrong_weights_lose_their_order() {
        let unequal = Composition { base: VelocityVerlet, weights: [0.4, 0.6] };
        assert_eq!(order(unequal), Some(2));
        // Weights that miss in their fifth digit sum to one, and are symmetric: order two is left.
        let wrong = Composition { base: VelocityVerlet, weights: [1.3512, -1.7024, 1.3512] };
        assert_eq!(order(wrong), Some(2));
    }
}
