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

/// Sets growth rates and eigenvalues to zero that roundings of the entries of the plant may cause.
pub(super) fn remove_rounding(plant: &LinearPlant, details: &mut [ModeDetails]) {
    // The eigenvalues of a sampled plant are factors per period.
    let factor = |rate: Complex64| match plant.sampling_period {
        None => rate,
        Some(period) => (rate * period).exp(),
    };
    let upper = details.iter().map(|mode| factor(mode.value));
    let all: Vec<Complex64> = upper
        .flat_map(|value| match value.im {
            0.0 => vec![value],
            _ => vec![value, value.conj()],
        })
        .collect();
    for mode in details {
        let value = factor(mode.value);
        let mut rounding = eigenvalue_rounding(&plant.a, value, &all);
        if let Some(period) = plant.sampling_period {
            rounding /= value.norm() * period;
        }
        if mode.value.norm() <= rounding {
            mode.value = Complex64::ZERO;
        } else if mode.value.re.abs() <= rounding {
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
    let fastest = modes.iter().map(|mode| mode.natural_frequency).fold(0.0, f64::max);
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
