//! Closed forms of the covariance of Langevin dynamics in a mode.

use libration_core::number::{Poly, Ratio, RationalFunction};
use libration_core::thermostat::{LangevinMethod, LangevinStep};

use super::langevin_mode::exact_covariance;

/// The most powers of `z²` in the numerator and in the denominator of a closed form.
const MOST_POWERS: usize = 3;

/// Values of `z²` beyond those that determine a closed form, at which it must be right, too.
const CHECKS: usize = 4;

/// Values of decay and damping without a relation, at which a closed form must be the same: a covariance is a quotient of polynomials of
/// both.
const FRICTIONS: [[(i64, i64); 2]; 3] = [[(1, 3), (2, 7)], [(5, 7), (1, 11)], [(11, 13), (9, 5)]];

/// A quotient of polynomials in `z`.
type Formula = RationalFunction<{ 2 * MOST_POWERS + 2 }>;

/// `⟨q²⟩` and `⟨v²⟩` as functions of `z = ωh`; none of one that depends on the friction, or is no quotient of short polynomials in `z²`.
///
/// By interpolation of exact covariances, which further ones check.
pub fn covariance_formulas(method: &LangevinMethod) -> [Option<String>; 2] {
    let count = 2 * MOST_POWERS + 1 + CHECKS;
    let points: Vec<Ratio> = (1..=count as i64).map(|k| Ratio::new(k, 8)).collect();
    let values: Vec<[Option<Ratio>; 2]> =
        points.iter().map(|z| common_values(method, *z)).collect();
    [0, 1].map(|i| {
        let values: Vec<Ratio> = values.iter().map(|both| both[i]).collect::<Option<_>>()?;
        let known: Vec<(Ratio, Ratio)> =
            points.iter().zip(values).map(|(z, value)| (*z * *z, value)).collect();
        let formula = (0..=MOST_POWERS).find_map(|powers| quotient(&known, powers))?;
        Some(formula.in_lowest_terms().to_string())
    })
}

/// `⟨q²⟩` and `⟨v²⟩` at `z`, each if it is the same for all frictions.
fn common_values(method: &LangevinMethod, z: Ratio) -> [Option<Ratio>; 2] {
    let all = FRICTIONS.map(|numbers| {
        let [decay, damping] = numbers.map(|(num, den)| Ratio::new(num, den));
        let implicit_factor = (Ratio::ONE + damping * Ratio::new(1, 2)).recip();
        exact_covariance(method, LangevinStep { dt: z, decay, damping, implicit_factor })
    });
    [0, 1].map(|i| {
        let first = all[0][i];
        all.iter().all(|other| other[i].is_valid() && other[i] == first).then_some(first)
    })
}

/// The quotient of polynomials with these powers of `x = z²` through all points; none if there is none.
fn quotient(points: &[(Ratio, Ratio)], powers: usize) -> Option<Formula> {
    let unknowns = 2 * powers + 1;
    let zero = Ratio::ZERO;
    let power = |x: Ratio, k: usize| (0..k).fold(Ratio::ONE, |product, _| product * x);
    // n(x) − y·(d(x) − 1) = y, where d(0) = 1: a covariance is finite for small steps.
    let rows = points.iter().take(unknowns).map(|&(x, y)| {
        let numerator = (0..=powers).map(|k| power(x, k));
        let denominator = (1..=powers).map(|k| (zero - y) * power(x, k));
        numerator.chain(denominator).chain([y]).collect()
    });
    let solution = solve_exactly(rows.collect())?;
    let (numerator, denominator) = solution.split_at(powers + 1);
    let of = |coefficients: &[Ratio], x: Ratio| {
        coefficients.iter().rev().fold(zero, |sum, c| sum * x + *c)
    };
    let is_right =
        |&(x, y): &(Ratio, Ratio)| of(numerator, x) == y * (Ratio::ONE + x * of(denominator, x));
    if !points.iter().all(is_right) {
        return None;
    }
    let polynomial = |coefficients: &[Ratio], first: usize| {
        let terms = coefficients.iter().enumerate();
        terms.fold(Poly::ZERO, |sum, (k, c)| sum + Poly::monomial(*c, 2 * (k + first)))
    };
    let denominator = polynomial(&[Ratio::ONE], 0) + polynomial(denominator, 1);
    RationalFunction::new(polynomial(numerator, 0), denominator).checked()
}

/// The solution of linear equations by elimination, the right side in the last column; none if they are singular.
fn solve_exactly(mut rows: Vec<Vec<Ratio>>) -> Option<Vec<Ratio>> {
    let n = rows.len();
    for k in 0..n {
        let pivot = (k..n).find(|&i| !rows[i][k].is_zero())?;
        rows.swap(k, pivot);
        let scale = rows[k][k].recip();
        let row: Vec<Ratio> = rows[k].iter().map(|x| *x * scale).collect();
        for (i, other) in rows.iter_mut().enumerate() {
            let factor = other[k];
            if i != k && !factor.is_zero() {
                other.iter_mut().zip(&row).for_each(|(x, y)| *x = *x - factor * *y);
            }
        }
        rows[k] = row;
    }
    Some(rows.iter().map(|row| row[n]).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closed_forms_are_derived_from_the_step() {
        let (exact, narrow, wide) = (Some("1"), Some("1 − z²/4"), Some("1/(1 − z²/4)"));
        for (name, qq, vv) in [
            ("BAOAB", exact, narrow),
            ("ABOBA", exact, wide),
            ("OBABO", wide, exact),
            ("OABAO", narrow, exact),
            ("BAOA", exact, exact),
            ("gjf", exact, narrow),
            // Two steps of half the length.
            ("BABOBAB", Some("1/(1 − z²/16)"), exact),
            // Friction after a symplectic Euler step.
            ("ABO", None, None),
            ("euler-maruyama", None, None),
        ] {
            let found = covariance_formulas(&name.parse().unwrap());
            assert_eq!(found.each_ref().map(Option::as_deref), [qq, vv], "{name}");
        }
    }
}
