//! The verdict of the modes of a plant.

use libration::analysis::eigenvalue_rounding;
use libration::linear::{Complex64, LinearPlant, ModeDetails};
use libration_report::verdict::{Outcome, Verdict};
use libration_settings::linear_loop::OperatingPoint;

use super::Mode;

/// Growth of a mode that counts as none, relative to the fastest rate: the rounding of a sampled period or of unequal units.
const ROUNDING: f64 = 1e-12;

/// A number with four digits.
fn significant(x: f64) -> String {
    let rounded: f64 = format!("{x:.3e}").parse().unwrap_or(x);
    let text = format!("{rounded:?}");
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}

/// Roundings of an eigenvalue that may move the mean of a cluster of eigenvalues, whose projector is not orthogonal.
const OF_MEAN: f64 = 1e3;

/// Sets growth rates and eigenvalues to zero that roundings of the entries of the plant may cause.
///
/// Roundings part a multiple eigenvalue by a root of their size, but hardly move the mean of its parts (T. Kato, *Perturbation Theory for Linear
/// Operators*, section II.2). A cluster is therefore zero only if its mean is: `(s + 1)¹⁰` decays.
pub(super) fn remove_rounding(plant: &LinearPlant, details: &mut [ModeDetails]) {
    // The eigenvalues of a sampled plant are factors per period.
    let factor = |rate: Complex64| match plant.sampling_period {
        None => rate,
        Some(period) => (rate * period).exp(),
    };
    let rate = |factor: Complex64| match plant.sampling_period {
        None => factor,
        Some(period) => factor.ln() / period,
    };
    let upper = details.iter().map(|mode| factor(mode.value));
    let all: Vec<Complex64> = upper
        .flat_map(|value| match value.im {
            0.0 => vec![value],
            _ => vec![value, value.conj()],
        })
        .collect();
    // A factor of zero decays at once.
    for mode in details.iter_mut().filter(|mode| mode.value.is_finite()) {
        let value = factor(mode.value);
        let per_rate = plant.sampling_period.map_or(1.0, |period| value.norm() * period);
        let own = eigenvalue_rounding(&plant.a, value, &all);
        let cluster: Vec<Complex64> =
            all.iter().filter(|other| (*other - value).norm() <= 2.0 * own).copied().collect();
        let mean = rate(cluster.iter().sum::<Complex64>() / cluster.len() as f64);
        let rounding = own / per_rate;
        let of_mean = match cluster.len() {
            1 => rounding,
            _ => rounding.min(OF_MEAN * eigenvalue_rounding(&plant.a, value, &[value]) / per_rate),
        };
        if mode.value.norm() <= rounding && mean.norm() <= of_mean {
            mode.value = Complex64::ZERO;
        } else if mode.value.re.abs() <= rounding && mean.re.abs() <= of_mean {
            mode.value.re = 0.0;
        }
    }
}

/// Whether the linearisation at an operating point is zero in all directions that it leaves open, so that it decides nothing.
pub(super) fn decides_nothing(modes: &[Mode], point: Option<&OperatingPoint>) -> bool {
    let is_zero = modes.iter().all(|mode| mode.natural_frequency == 0.0);
    is_zero && point.is_some_and(|point| point.undecided > 0)
}

/// The verdict of modes, the one that grows fastest first.
pub(super) fn of_modes(modes: &[Mode], point: Option<&OperatingPoint>) -> Verdict {
    // Of a sampled plant, a mode of factor zero is infinitely fast.
    let sizes = modes.iter().map(|mode| mode.natural_frequency).filter(|size| size.is_finite());
    let fastest = sizes.fold(0.0, f64::max);
    let Some(first) = modes.first() else { return Verdict::unknown("there are no modes") };
    let least = ROUNDING * fastest;
    let moved =
        first.states.first().map_or_else(String::new, |(name, _)| format!(", most in {name}"));
    let verdict = match first.growth_rate {
        rate if rate > least => {
            let evidence = match modes.iter().filter(|mode| mode.growth_rate > least).count() {
                1 => format!("a mode grows at {} 1/s{moved}", significant(rate)),
                more => {
                    format!("{more} modes grow, the fastest at {} 1/s{moved}", significant(rate))
                }
            };
            return Verdict::new(Outcome::Unstable, evidence);
        }
        _ if decides_nothing(modes, point) => Verdict::unknown(
            "the linearisation is zero to rounding: nothing grows linearly, and it decides nothing",
        ),
        rate if rate < -least => {
            let evidence = format!("its slowest mode decays at {} 1/s{moved}", significant(-rate));
            Verdict::new(Outcome::Stable, evidence)
        }
        _ => match modes.iter().filter(|mode| mode.growth_rate.abs() <= least).count() {
            1 => Verdict::unknown("a mode neither grows nor decays"),
            more => Verdict::unknown(format!("{more} modes neither grow nor decay")),
        },
    };
    match point {
        Some(point) if point.undecided > 0 => {
            verdict.without("directions in which the linearisation is zero")
        }
        _ => verdict,
    }
}
