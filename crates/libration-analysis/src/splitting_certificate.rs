//! The certificate of a splitting method, from its step alone.

use libration_core::number::Wide;
use libration_core::{Elementary, Integrator, Scalar};

use super::order_certificate::path_of;
use super::{Letter, NystromCertificate, OrderCertificate, Tableau};

/// Properties of a splitting method, read off the step that simulates.
#[derive(Clone, Debug)]
pub struct SplittingCertificate {
    /// The letters of a step, in the order of time.
    pub word: Vec<Letter>,
    /// Force evaluations of a step, where a kick at the end shares its force with the next.
    pub stages: usize,
    /// The order for any two parts.
    pub order: usize,
    /// The order for forces of positions and a kinetic energy that is quadratic in the velocities.
    pub nystrom_order: usize,
    /// The order of the errors that are linear in the strength of the kicks: that of the quadrature of the kicks.
    pub weak_order: usize,
    /// Whether the word is the same forwards and backwards, so that a step back undoes a step.
    pub is_symmetric: bool,
    /// The norm of the leading error for forces of positions.
    pub error_constant: f64,
}

/// The highest order of a quadrature that is looked for.
const MOST_WEAK: usize = 16;

impl SplittingCertificate {
    /// The certificate of a method of at most this order; none if it is no splitting method.
    ///
    /// The time doubles with each order.
    pub fn new(integrator: impl Integrator, most: usize) -> Option<Self> {
        let word = Tableau::new(integrator)?.word()?;
        let nystrom = NystromCertificate::new(integrator, most + 2)?;
        let nystrom_order = nystrom.order();
        Some(SplittingCertificate {
            stages: stages(&word),
            order: OrderCertificate::new(integrator, nystrom_order.min(most) + 1)?.order(),
            nystrom_order,
            weak_order: quadrature_order(&word),
            is_symmetric: word.iter().eq(word.iter().rev()),
            error_constant: nystrom.error_constant().unwrap_or(f64::NAN),
            word,
        })
    }

    /// The error per force evaluation in one number, `stages · error_constant^(1/order)`: a method with half of it takes half of the
    /// evaluations for the same error, as far as the leading error counts (McLachlan, SIAM J. Sci. Comput. 16, 151 (1995)).
    pub fn effective_error(&self) -> f64 {
        self.stages as f64 * self.error_constant.powf(1.0 / self.nystrom_order as f64)
    }
}

/// The number of kicks, without one of two that neighbouring steps have at the same time.
fn stages(word: &[Letter]) -> usize {
    let kicks = word.iter().filter(|letter| is_kick(letter)).count();
    let shared = kicks > 1 && [word.first(), word.last()].into_iter().flatten().all(is_kick);
    kicks - usize::from(shared)
}

fn is_kick(letter: &Letter) -> bool {
    matches!(letter, Letter::Kick(_))
}

/// The order of the quadrature with the weights of the kicks at their times.
fn quadrature_order(word: &[Letter]) -> usize {
    let (mut time, mut nodes) = (Wide::ZERO, Vec::new());
    for letter in word {
        match letter {
            Letter::Drift(w) => time = time + Wide::from(*w),
            Letter::Kick(w) => nodes.push((time, Wide::from(*w))),
        }
    }
    let path = path_of(word);
    let weights: f64 = nodes.iter().map(|(_, weight)| weight.to_f64().abs()).sum();
    let latest = nodes.iter().map(|(time, _)| time.to_f64().abs()).fold(1.0, f64::max);
    let is_exact = |power: &usize| {
        let value =
            |&(time, weight): &(Wide, Wide)| (1..*power).fold(weight, |product, _| product * time);
        let sum = nodes.iter().map(value).fold(Wide::ZERO, |sum, x| sum + x);
        let exact = Wide::from_f64(*power as f64).recip();
        // A time is a sum of drifts, each of which is rounded: it is off by at most the path times a rounding.
        let largest = weights * path * latest.powi(*power as i32);
        (sum - exact).abs().to_f64() <= *power as f64 * largest * f64::EPSILON
    };
    (1..=MOST_WEAK).take_while(is_exact).count()
}

#[cfg(test)]
#[allow(clippy::excessive_precision, reason = "digits as printed")]
mod tests {
    use std::collections::BTreeSet;

    use libration_core::Method;
    use libration_core::integrator::{SplittingCoefficients, SplittingScope, SplittingTable};
    use libration_core::system::DampedOscillator;

    use super::*;
    use crate::oscillator_windows;

    fn tables() -> impl Iterator<Item = &'static SplittingTable> {
        SplittingTable::ALL.into_iter().flatten()
    }

    /// A table with these coefficients.
    fn table(coefficients: SplittingCoefficients) -> &'static SplittingTable {
        let (name, scope) = ("test", SplittingScope::General);
        let table = SplittingTable {
            name,
            title: "",
            summary: "",
            source: "",
            order: 0,
            scope,
            coefficients,
        };
        Box::leak(Box::new(table))
    }

    fn leaked(numbers: Vec<f64>) -> &'static [f64] {
        numbers.leak()
    }

    #[test]
    fn every_published_method_has_the_order_scope_and_symmetry_of_its_table() {
        for table in tables() {
            let (name, order) = (table.name, table.order as usize);
            let own = SplittingCertificate::new(table, order + 1).expect(name);
            match table.scope {
                SplittingScope::General => assert_eq!(own.order, order, "{name}"),
                SplittingScope::Nystrom => assert!(own.order < order, "{name}: {}", own.order),
                SplittingScope::NearlyIntegrable { weak } => {
                    assert_eq!((own.order, own.weak_order), (order, weak as usize), "{name}");
                }
            }
            if !matches!(table.scope, SplittingScope::NearlyIntegrable { .. }) {
                assert_eq!(own.weak_order, order, "{name}");
            }
            assert_eq!(own.nystrom_order, order, "{name}");
            assert_eq!(own.is_symmetric, table.coefficients.is_symmetric(), "{name}");
            assert_eq!(own.stages, table.coefficients.stages(), "{name}");
        }
    }

    #[test]
    fn summaries_say_what_the_certificates_say() {
        for table in tables() {
            let SplittingTable { order, coefficients, .. } = table;
            let reversible = if coefficients.is_symmetric() { ", time-reversible" } else { "" };
            let scope = match table.scope {
                SplittingScope::General => String::new(),
                SplittingScope::Nystrom => "; forces of positions".to_owned(),
                SplittingScope::NearlyIntegrable { weak } => {
                    format!("; order {weak} in weak kicks")
                }
            };
            let stages = coefficients.stages();
            let wanted =
                format!("order {order}; symplectic{reversible}; {stages} evaluations{scope}");
            assert_eq!(table.summary, wanted, "{}", table.name);
        }
        let names: BTreeSet<&str> = Method::all().map(Method::name).collect();
        assert_eq!(names.len(), Method::all().count());
    }

    #[test]
    fn a_wrong_digit_in_any_coefficient_of_any_table_is_found() {
        for published in tables() {
            let numbers = published.coefficients.numbers();
            for i in 0..numbers.len() {
                let mut wrong = numbers.to_vec();
                wrong[i] += 1e-12;
                let coefficients = published.coefficients.with_numbers(leaked(wrong));
                let own = NystromCertificate::new(table(coefficients), 1).unwrap();
                assert_eq!(own.order(), 0, "{}, coefficient {i}", published.name);
            }
        }
    }

    #[test]
    fn the_most_efficient_tables_are_those_of_their_certificates() {
        let of_order = |order: usize| -> Vec<(&str, f64)> {
            let certified = tables().filter(|table| table.order as usize == order);
            let effective = certified.map(|table| {
                let certificate = SplittingCertificate::new(table, order).unwrap();
                (table.name, certificate.effective_error())
            });
            effective.collect()
        };
        let best = [2, 4, 6, 8, 10]
            .map(|order| of_order(order).into_iter().min_by(|a, b| a.1.total_cmp(&b.1)).unwrap().0);
        assert!(SplittingTable::most_efficient().map(|table| table.name).eq(best));
    }

    #[test]
    fn two_wrong_digits_that_cancel_in_the_sums_are_found() {
        for published in tables().filter(|table| table.order < 9) {
            let numbers = published.coefficients.numbers();
            let every =
                if matches!(published.coefficients, SplittingCoefficients::SymmetricLeapfrogs(_)) {
                    1
                } else {
                    2
                };
            let Some(second) = (every..numbers.len() - 1).next() else { continue };
            let mut wrong = numbers.to_vec();
            wrong[0] += 1e-5;
            wrong[second] -= 1e-5;
            let coefficients = published.coefficients.with_numbers(leaked(wrong));
            let own =
                NystromCertificate::new(table(coefficients), published.order as usize).unwrap();
            assert!(
                published.order == 2 || own.order() < published.order as usize,
                "{}",
                published.name
            );
        }
    }

    #[test]
    fn tables_that_libraries_shipped_by_mistake_have_the_order_that_they_really_have() {
        use SplittingCoefficients::{DriftFirst, SymmetricDriftFirst, SymmetricLeapfrogs};
        let order = |coefficients| SplittingCertificate::new(table(coefficients), 6).unwrap().order;
        // McAte42 of OrdinaryDiffEq.jl (issue 85): the two drifts in the middle of McLachlan's SB3A are one.
        let [a1, a2] = [0.405_188_618_395_252_27, -0.287_144_040_816_524_1];
        let [b1, b2] = [-3.0 / 73.0, 17.0 / 59.0];
        let (a3, b3) = (1.0 - 2.0 * (a1 + a2), 1.0 - 2.0 * (b1 + b2));
        let shipped = leaked(vec![a1, b1, a2, b2, a3, b3, a2, b2, a1, b1]);
        assert_eq!(order(DriftFirst(shipped)), 1);
        let half = 0.5 - a1 - a2;
        assert_eq!(order(SymmetricDriftFirst(leaked(vec![a1, b1, a2, b2, half, b3]))), 4);
        // Suzuki and Yoshida's weights in GROMACS (coupling.cpp): 2^(−1/3) in place of 2^(1/3).
        let jump = |root: f64| leaked(vec![1.0 / (2.0 - root), 1.0 - 2.0 / (2.0 - root)]);
        assert_eq!(order(SymmetricLeapfrogs(jump(0.5_f64.cbrt()))), 2);
        assert_eq!(order(SymmetricLeapfrogs(jump(2.0_f64.cbrt()))), 4);
        // A program's Blanes–Moan of order four with the first digits of their order six.
        let [d1, d2, d3] =
            [0.050_262_764_400_392_2, 0.413_465_122_417_432_8, 0.036_272_113_182_175];
        let [k1, k2, k3] =
            [0.148_817_742_479_655_9, 0.527_753_876_542_476, -0.353_143_238_044_263_8];
        assert_eq!(order(SymmetricDriftFirst(leaked(vec![d1, k1, d2, k2, d3, k3]))), 2);
        // TSSM's sqrt(2.0/prec) with the kind 8, where sqrt(2.0_prec) was meant.
        assert_eq!(order(DriftFirst(&[0.75, 0.25, 0.25, 0.75])), 1);
        // Yoshida's order six with its weights in the order of the paper's indices: sums of powers do not see it.
        let [w1, w2, w3] =
            [-1.177_679_984_178_871, 0.235_573_213_359_358_13, 0.784_513_610_477_557_3];
        let w0 = 1.0 - 2.0 * (w1 + w2 + w3);
        assert_eq!(order(SymmetricLeapfrogs(leaked(vec![w1, w2, w3, w0]))), 4);
        assert_eq!(order(SymmetricLeapfrogs(leaked(vec![w3, w2, w1, w0]))), 6);
    }

    /// First ends of stability by an independent program (mpmath, 40 digits: bisection on the trace of the product of shears).
    #[test]
    fn the_first_window_of_stability_agrees_with_an_independent_program() {
        let known = [
            ("yoshida-6a", 2.2690579963976594),
            ("mclachlan-ss9-6", 2.7031006120817376),
            ("suzuki-umeno-8-15", 3.3932342684641493),
            ("mclachlan-atela-3", 4.5200895183984135),
            ("pefrl-4", 2.9894495459067289),
            ("blanes-moan-s6-4-kdk", 3.1328233983908748),
            ("calvo-sanz-serna-4", 3.0558572644643382),
            ("blanes-moan-srkn-11-6", 3.1414310877528073),
            ("okunbor-skeel-6-13", 3.0674008285101554),
            ("aba-10-6-4", 3.1461073359932822),
        ];
        for (name, limit) in known {
            let method = Method::from_name(name).unwrap();
            let oscillator = DampedOscillator { omega2: 1.0, gamma: 0.0 };
            let windows = oscillator_windows(method, &oscillator).unwrap();
            let end = windows[0].to.unwrap().to_f64();
            // Weights that are rounded to `f64` move the end by several of its roundings.
            assert!((end - limit).abs() < 2e-14 * limit, "{name}: {end:?} {limit:?}");
        }
    }
}
