//! Changes that stabilise an unstable loop.

use libration::Model;
use libration::analysis::{Imperfections, Plant};
use libration::control::Feedback;
use serde::Serialize;

use super::loops::Loop;

/// The smallest changes, each alone, that stabilise a loop; none where no change of that kind was found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Remedies {
    /// The factor of all gains that is nearest to 1.
    pub gain_factor: Option<f64>,
    /// That factor in few digits, with which the loop is stable as well.
    #[serde(skip)]
    pub(super) shown_factor: Option<f64>,
    /// The gains of position and velocity with the factor that is shown, in the units of the loop.
    pub gains: Option<[f64; 2]>,
    /// The largest latency, in s, up to which it is stable with everything else as it is stated.
    pub latency: Option<f64>,
}

/// Factors in each octave that are tried.
const PER_OCTAVE: i32 = 8;

/// Octaves of smaller and of larger gains that are tried.
const OCTAVES: [i32; 2] = [10, 5];

/// Shares of the latency that are tried.
const SHARES: u32 = 64;

/// The least rate of growth or decay in a period that is no rounding of the arithmetic.
pub(super) const NEUTRAL: f64 = 1e-12;

/// Halvings of the interval that holds an end: ends are printed to six digits.
const HALVINGS: u32 = 30;

impl<M: Model<1>> Loop<M> {
    /// What stabilises the loop with `stated`, with which it is unstable.
    pub(super) fn remedies(&self, plant: &Plant<'_>, stated: &Imperfections) -> Remedies {
        let amplified = |factor: f64| -> bool {
            let amplified = self.amplified(factor);
            // What the stated latency alone stabilises is no remedy.
            amplified.settles(plant, stated) && amplified.settles(plant, &Imperfections::NONE)
        };
        let octaves = |count: i32, sign: f64| {
            let factor = move |i: i32| (sign * f64::from(i) / f64::from(PER_OCTAVE)).exp2();
            (1..=count * PER_OCTAVE).map(factor)
        };
        let [down, up] = OCTAVES;
        let gain_factor = change(1.0, octaves(down, -1.0), amplified)
            .or_else(|| change(1.0, octaves(up, 1.0), amplified))
            .map(|[_, stable]| stable);
        let step = self.control.period * (1.0 + stated.skew);
        let late = step * stated.latency.steps();
        let with = |latency: f64| -> bool {
            let Ok(latency) = self.latency(latency / step) else { return false };
            self.settles(plant, &Imperfections { latency, ..*stated })
        };
        // From below: a window that is regained is no remedy.
        let shares = (1..=SHARES).map(|i| late * f64::from(i) / f64::from(SHARES));
        let latency = match late > 0.0 && with(0.0) {
            true => change(0.0, shares, |latency| !with(latency)).map(|[stable, _]| stable),
            false => None,
        };
        let shown_factor = gain_factor.map(|end| {
            let few = (4..8).map(|digits| rounded(end, digits, end > 1.0));
            few.into_iter().find(|factor| amplified(*factor)).unwrap_or(end)
        });
        let gains = shown_factor.map(|factor| {
            let Feedback { position, velocity } = self.given_gains();
            [factor * position, factor * velocity]
        });
        Remedies { gain_factor, shown_factor, gains, latency }
    }

    /// Whether second moments decay by more than a rounding. A loop that is too large to be judged is not one to recommend.
    pub(super) fn settles(&self, plant: &Plant<'_>, with: &Imperfections) -> bool {
        self.decays(plant, with) == Ok(true)
            && self.growth(plant, with).is_ok_and(|growth| growth < -NEUTRAL)
    }

    /// The longest period, shorter than that of the loop, with which the loop is stable with what is stated, and the ideal one.
    pub(super) fn stable_period(&self) -> Option<f64> {
        let stable = |period: f64| -> bool {
            let Ok(other) = self.sampled_every(period) else { return false };
            let plant = other.plant();
            other.stated().is_ok_and(|stated| other.settles(&plant, &stated))
                && other.settles(&plant, &Imperfections::NONE)
        };
        let period = self.control.period;
        let shorter = (1..=SHARES).map(|i| period * (-f64::from(i) / 4.0).exp2());
        change(period, shorter, stable).map(|[_, stable]| stable)
    }
}

/// The two sides of the place where `holds` begins to, between `from` and the first of `values` for which it does.
fn change(
    from: f64,
    values: impl Iterator<Item = f64>,
    holds: impl Fn(f64) -> bool,
) -> Option<[f64; 2]> {
    let mut outside = from;
    for value in values {
        if !holds(value) {
            outside = value;
            continue;
        }
        let mut inside = value;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (inside + outside);
            if holds(middle) { inside = middle } else { outside = middle }
        }
        return Some([outside, inside]);
    }
    None
}

/// A positive number in so many significant digits, not below it if `up`, else not above it.
fn rounded(x: f64, digits: i32, up: bool) -> f64 {
    let exponent = x.log10().floor() as i32 + 1 - digits;
    let number = x / 10.0_f64.powi(exponent);
    let number = if up { number.ceil() } else { number.floor() };
    // By way of a decimal, whose digits are these and no more.
    format!("{number}e{exponent}").parse().unwrap_or(x)
}

/// Four digits of a positive number, not above it.
pub(super) fn rounded_down(x: f64) -> f64 {
    rounded(x, 4, false)
}

impl Remedies {
    /// A sentence about them.
    pub(super) fn sentence(&self, gain_units: [&str; 2]) -> String {
        let gains = self.shown_factor.zip(self.gains).map(|(factor, [position, velocity])| {
            format!(
                "all gains times {factor} (K_p = {position:.6} {}, K_d = {velocity:.6} {})",
                gain_units[0], gain_units[1]
            )
        });
        let latency =
            self.latency.map(|latency| format!("a latency of at most {} s", rounded_down(latency)));
        let all: Vec<String> = gains.into_iter().chain(latency).collect();
        match all.is_empty() {
            true => format!(
                "No multiple of its gains from 2^-{} to 2^{}, and no smaller latency, stabilises it at this period.",
                OCTAVES[0], OCTAVES[1]
            ),
            false => format!("It is stable with {}.", all.join(", or with ")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_place_nearest_to_the_start_is_found_and_none_where_none_holds() {
        let down = || (1..=8).map(|i| 1.0 - f64::from(i) / 8.0);
        // Holds between 0.2 and 0.6, whose upper end is nearer.
        let [outside, inside] = change(1.0, down(), |x| (0.2..=0.6).contains(&x)).unwrap();
        assert!(inside <= 0.6 && 0.6 < outside);
        // An eighth, halved thirty times.
        assert!(outside - inside < 2e-10, "{inside} {outside}");
        assert_eq!(change(1.0, down(), |_| false), None);
    }
}
