//! How well laws fit.

use serde::Serialize;

use super::law::{Law, LawKind};

/// Values that a fit uses; of more, every so many-th.
const MOST: usize = 1 << 18;

/// A law and how well it fits.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fit {
    /// The name of the law.
    pub name: &'static str,
    /// The law, fitted to all values.
    #[serde(flatten)]
    pub law: Law,
    /// Akaike's criterion over that of the best law (H. Akaike, *A new look at the statistical model identification*, IEEE
    /// Transactions on Automatic Control 19, 1974).
    pub aic_above_best: f64,
    /// The largest difference of probabilities between every second value and the law that is fitted to the others.
    pub distance: f64,
    /// The probability of such a distance, if the law holds and the values are independent.
    pub p_value: f64,
}

/// How well the best law fits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum LawVerdict {
    /// All values are equal.
    Constant,
    /// The best law is not rejected.
    Fits,
    /// The best law is rejected, but no probability is wrong by more than 2 %.
    Close,
    /// No law fits.
    None,
    /// There are too few values.
    TooFew,
    /// Values change over time: a law would be that of one record.
    DependsOnTime,
    /// Neighbouring values resemble each other, so that no test of a law holds.
    Correlated,
}

/// The laws, the best first.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LawFit {
    /// The verdict about the first law.
    pub verdict: LawVerdict,
    /// The laws by Akaike's criterion.
    pub fits: Vec<Fit>,
}

/// Smallest p-value of a law that is not rejected.
const REJECTED: f64 = 0.01;
/// Largest distance of a law that is close.
const CLOSE: f64 = 0.02;
/// Fewest values.
const FEWEST: usize = 32;

impl LawFit {
    /// That of values that are equal.
    pub(crate) fn constant() -> Self {
        LawFit::without(LawVerdict::Constant)
    }

    /// No law, for this reason.
    pub(crate) fn without(verdict: LawVerdict) -> Self {
        LawFit { verdict, fits: Vec::new() }
    }

    /// Fits all laws to values in any order.
    ///
    /// The parameters of the tested law are fitted to every second value, and its distance is that of the others: a test on the values
    /// of the fit would be too kind.
    pub fn of(values: &[f64]) -> Self {
        let stride = values.len().div_ceil(MOST).max(1);
        let values: Vec<f64> =
            values.iter().copied().step_by(stride).filter(|x| x.is_finite()).collect();
        if values.len() < FEWEST {
            return LawFit::without(LawVerdict::TooFew);
        }
        let sorted = |values: &mut dyn Iterator<Item = f64>| {
            let mut values: Vec<f64> = values.collect();
            values.sort_unstable_by(f64::total_cmp);
            values
        };
        let all = sorted(&mut values.iter().copied());
        let fitted = sorted(&mut values.iter().copied().step_by(2));
        let tested = sorted(&mut values.iter().copied().skip(1).step_by(2));
        if all[0] == all[all.len() - 1] {
            return LawFit::constant();
        }
        let fit = |kind: LawKind| {
            let law = kind.fit(&all)?;
            let likelihood: f64 = all.iter().map(|&x| law.log_density(x)).sum();
            let distance = distance(&kind.fit(&fitted)?, &tested);
            let aic = 2.0 * kind.parameters() as f64 - 2.0 * likelihood;
            let p_value = p_value(distance, tested.len());
            aic.is_finite().then_some(Fit {
                name: kind.name(),
                law,
                aic_above_best: aic,
                distance,
                p_value,
            })
        };
        let mut fits: Vec<Fit> = LawKind::ALL.into_iter().filter_map(fit).collect();
        fits.sort_by(|a, b| a.aic_above_best.total_cmp(&b.aic_above_best));
        let best = fits.first().map_or(0.0, |fit| fit.aic_above_best);
        fits.iter_mut().for_each(|fit| fit.aic_above_best -= best);
        let verdict = match fits.first() {
            Some(fit) if fit.p_value >= REJECTED => LawVerdict::Fits,
            Some(fit) if fit.distance <= CLOSE => LawVerdict::Close,
            _ => LawVerdict::None,
        };
        LawFit { verdict, fits }
    }

    /// The best law.
    pub fn best(&self) -> Option<&Fit> {
        self.fits.first()
    }
}

/// The distance of Kolmogorov and Smirnov between a law and sorted values.
fn distance(law: &Law, sorted: &[f64]) -> f64 {
    let count = sorted.len() as f64;
    let mut largest: f64 = 0.0;
    let mut start = 0;
    // Equal values are one step.
    for group in sorted.chunk_by(|a, b| a == b) {
        let end = start + group.len();
        let probability = law.probability(group[0]);
        let (below, above) = (start as f64 / count, end as f64 / count);
        largest = largest.max((probability - below).abs()).max((probability - above).abs());
        start = end;
    }
    largest
}

/// The probability of at least this distance (M. A. Stephens, *Use of the Kolmogorov-Smirnov, Cramér-von Mises and related statistics
/// without extensive tables*, Journal of the Royal Statistical Society B 32, 1970).
fn p_value(distance: f64, count: usize) -> f64 {
    let root = (count as f64).sqrt();
    let x = (root + 0.12 + 0.11 / root) * distance;
    // Below, the series converges slowly, and the probability is one but for 1e-13.
    if x < 0.2 {
        return 1.0;
    }
    let term = |k: i32| {
        let k = f64::from(k);
        (-2.0 * k * k * x * x).exp()
    };
    let sum: f64 = (1..=100).map(|k| if k % 2 == 1 { term(k) } else { -term(k) }).sum();
    (2.0 * sum).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use libration::random::{Address, Purpose};

    use super::*;

    fn address(n: u64) -> Address {
        Address { seed: 7, trajectory: 0, step: n, purpose: Purpose::StepTime }
    }

    fn gaussian(n: u64) -> f64 {
        address(n).gaussian()[0]
    }

    /// Uniform on 0 to 1, by the law of a Gaussian.
    fn uniform(n: u64) -> f64 {
        Law::Gaussian { mean: 0.0, deviation: 1.0 }.probability(gaussian(n))
    }

    fn best(value: impl Fn(u64) -> f64) -> (&'static str, LawVerdict) {
        let values: Vec<f64> = (0..4000).map(value).collect();
        let fit = LawFit::of(&values);
        (fit.best().map_or("", |fit| fit.name), fit.verdict)
    }

    #[test]
    fn each_law_is_recognised_in_its_own_numbers() {
        assert_eq!(best(|n| 1.0 + 0.1 * gaussian(n)), ("gaussian", LawVerdict::Fits));
        assert_eq!(best(|n| 1.0 + 0.1 * uniform(n)), ("uniform", LawVerdict::Fits));
        assert_eq!(best(|n| 1.0 - 0.1 * uniform(n).ln()), ("exponential tail", LawVerdict::Fits));
        let two = |n: u64| if n.is_multiple_of(3) { 2.0 } else { 1.0 } + 0.01 * gaussian(n);
        assert_eq!(best(two), ("two-valued", LawVerdict::Fits));
        let laplace = |n: u64| {
            let u = uniform(n) - 0.5;
            1.0 - 0.1 * u.signum() * (1.0 - 2.0 * u.abs()).ln()
        };
        assert_eq!(best(laplace), ("exponential tails on both sides", LawVerdict::Fits));
    }

    #[test]
    fn that_no_law_fits_is_said() {
        // Three values, and rare ones far away.
        let three = |n: u64| {
            [1.0, 1.5, 3.0][(n % 3) as usize] + if n.is_multiple_of(97) { 20.0 } else { 0.0 }
        };
        assert_eq!(best(three).1, LawVerdict::None);
        assert_eq!(best(|_| 1.0).1, LawVerdict::Constant);
        assert_eq!(LawFit::of(&[1.0, 2.0]).verdict, LawVerdict::TooFew);
    }

    #[test]
    fn the_p_value_is_that_of_tables() {
        // scipy.special.kolmogorov(1.0) and of 1.36, the usual limit of 5 %.
        let x = |x: f64| p_value(x / (1e4 + 0.12 + 0.11e-4), 100_000_000);
        assert!((x(1.0) - 0.269_999_671_677).abs() < 1e-9);
        assert!((x(1.36) - 0.049_485_8).abs() < 1e-6);
    }
}
