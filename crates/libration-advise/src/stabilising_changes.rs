//! Changes that stabilise an unstable loop.

use libration::control::{Feedback, Latency};
use libration::linear::LoopTiming;
use serde::Serialize;

use super::loops::{Loop, PlantModel};
use super::timed_loop::TimedLoop;

/// The smallest single changes that stabilise a loop; none if no change of the kind was found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct StabilisingChanges {
    /// The factor of all gains below zero that is nearest to −1; −1 if the opposite sign alone stabilises the loop.
    pub opposite_factor: Option<f64>,
    /// The gains of position and velocity with that factor, in the units of the loop.
    pub opposite_gains: Option<[f64; 2]>,
    /// The factor of all gains nearest to 1.
    pub gain_factor: Option<f64>,
    /// That factor in few digits, with which the loop is stable too.
    #[serde(skip)]
    pub(super) shown_factor: Option<f64>,
    /// The gains of position and velocity with the shown factor, in the units of the loop.
    pub gains: Option<[f64; 2]>,
    /// Whether the factor is that of the inner controller of a cascade.
    #[serde(skip)]
    pub(super) inner: bool,
    /// The largest latency, in s, up to which the loop is stable with the other stated imperfections: of several, the longest one, with all
    /// times `latency_factor`.
    pub latency: Option<f64>,
    /// The factor of all latencies, where there are several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub latency_factor: Option<f64>,
    /// Whether the changes are those of the loop without imperfections.
    #[serde(skip)]
    pub(super) of_ideal: bool,
}

/// Tried factors per octave.
const PER_OCTAVE: i32 = 8;

/// Tried octaves of smaller and of larger gains.
const OCTAVES: [i32; 2] = [10, 5];

/// Octaves of gains of the opposite sign that are tried: its size is right more often than its sign.
const SIGN_OCTAVES: i32 = 4;

/// Number of tried latencies.
const SHARES: u32 = 64;

/// Smallest rate of growth or decay per period above rounding.
pub(super) const NEUTRAL: f64 = 1e-12;

/// Number of bisections of an end, which is printed to six digits.
const HALVINGS: u32 = 30;

impl TimedLoop {
    /// The changes that stabilise the loop with the imperfections `stated`.
    pub(super) fn stabilising_changes(&self, stated: &LoopTiming) -> StabilisingChanges {
        let amplified = |factor: f64| -> bool {
            let Ok(amplified) = self.amplified(factor) else { return false };
            // The ideal loop must be stable too.
            amplified.settles(stated) && amplified.settles(&self.ideal())
        };
        let octaves = |count: i32, sign: f64| {
            let factor = move |i: i32| (sign * f64::from(i) / f64::from(PER_OCTAVE)).exp2();
            (1..=count * PER_OCTAVE).map(factor)
        };
        let [down, up] = OCTAVES;
        let gain_factor = change(1.0, octaves(down, -1.0), amplified)
            .or_else(|| change(1.0, octaves(up, 1.0), amplified))
            .map(|[_, stable]| stable);
        // The commonest error of a loop that is unstable without imperfections is the sign of its feedback.
        let signs = match (self.settles(&self.ideal()), gain_factor) {
            (true, _) => 0,
            (false, Some(_)) => 1,
            (false, None) => SIGN_OCTAVES,
        };
        let opposite_factor = (0..signs)
            .flat_map(|octave| [-octave, octave])
            .map(|octave| -f64::from(octave).exp2())
            .find(|factor| amplified(*factor));
        let step = self.period() * (1.0 + stated.skew);
        let channels = || stated.input_latency.iter().chain(&stated.output_latency);
        let longest = channels().map(|latency| latency.steps()).fold(0.0, f64::max);
        // All latencies in proportion; the longest is told.
        let with = |seconds: f64| -> bool {
            let share = seconds / (step * longest);
            let shorter = |latency: &Latency| self.latency(share * latency.steps());
            let all = |channels: &[Latency]| channels.iter().map(shorter).collect::<Result<_, _>>();
            let latencies = (all(&stated.input_latency), all(&stated.output_latency));
            let (Ok(input_latency), Ok(output_latency)) = latencies else { return false };
            self.settles(&LoopTiming { input_latency, output_latency, ..stated.clone() })
        };
        // From below: a separate stability window is no remedy.
        let shares = (1..=SHARES).map(|i| step * longest * f64::from(i) / f64::from(SHARES));
        let latency = match longest > 0.0 && with(0.0) {
            true => change(0.0, shares, |latency| !with(latency)).map(|[stable, _]| stable),
            false => None,
        };
        let shown_factor = gain_factor.map(|end| {
            let few = (4..8).map(|digits| rounded(end, digits, end > 1.0));
            few.into_iter().find(|factor| amplified(*factor)).unwrap_or(end)
        });
        let inner = self.linear.controllers().periods() > 1;
        let first = stated.input_latency.first().map(|latency| latency.steps());
        let is_one = stated.output_latency.iter().all(|latency| latency.steps() == 0.0)
            && stated.input_latency.iter().all(|latency| Some(latency.steps()) == first);
        StabilisingChanges {
            opposite_factor,
            opposite_gains: None,
            gain_factor,
            shown_factor,
            gains: None,
            inner,
            latency,
            latency_factor: latency.filter(|_| !is_one).map(|latency| latency / (step * longest)),
            of_ideal: self.stated().is_ok_and(|own| own != *stated),
        }
    }

    /// Whether second moments decay by more than rounding; false if the loop is too large to analyse.
    pub(super) fn settles(&self, with: &LoopTiming) -> bool {
        self.decays(with) == Ok(true) && self.growth(with).is_ok_and(|growth| growth < -NEUTRAL)
    }
}

impl<M: PlantModel> Loop<M> {
    /// The changes that stabilise the loop with the imperfections `stated`, with the gains in the units of the request.
    pub(super) fn stabilising_changes(&self, stated: &LoopTiming) -> StabilisingChanges {
        let changes = self.timed.stabilising_changes(stated);
        let times = |factor: f64| {
            let Feedback { position, velocity } = self.given_gains();
            [factor * position, factor * velocity]
        };
        let opposite_gains = changes.opposite_factor.map(times);
        StabilisingChanges { gains: changes.shown_factor.map(times), opposite_gains, ..changes }
    }

    /// The longest shorter period with which the loop and the ideal loop are stable.
    pub(super) fn stable_period(&self) -> Option<f64> {
        let stable = |period: f64| -> bool {
            let Ok(other) = self.with_period(period) else { return false };
            other.stated().is_ok_and(|stated| other.settles(&stated))
                && other.settles(&other.ideal())
        };
        let period = self.control.period;
        let shorter = (1..=SHARES).map(|i| period * (-f64::from(i) / 4.0).exp2());
        change(period, shorter, stable).map(|[_, stable]| stable)
    }
}

/// The bracket of the place where `holds` becomes true, between `from` and the first of `values` for which it is.
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

/// A positive number rounded up or down to `digits` significant digits.
fn rounded(x: f64, digits: i32, up: bool) -> f64 {
    let exponent = x.log10().floor() as i32 + 1 - digits;
    let number = x / 10.0_f64.powi(exponent);
    let number = if up { number.ceil() } else { number.floor() };
    // Parsing the decimal keeps its digits.
    format!("{number}e{exponent}").parse().unwrap_or(x)
}

/// A positive number rounded down to four digits.
pub(super) fn rounded_down(x: f64) -> f64 {
    rounded(x, 4, false)
}

impl StabilisingChanges {
    /// The changes in words: of the gains, and of the latency.
    pub(super) fn changes(&self, gain_units: [&str; 2]) -> Vec<String> {
        let of = if self.inner { " of the inner controller" } else { "" };
        let shown = |gains: Option<[f64; 2]>| {
            gains.map_or_else(String::new, |[position, velocity]| {
                let [of_position, of_velocity] = gain_units;
                format!(" (K_p = {position:.6} {of_position}, K_d = {velocity:.6} {of_velocity})")
            })
        };
        let opposite = self.opposite_factor.map(|factor| {
            let times = if factor == -1.0 { String::new() } else { format!(", times {}", -factor) };
            format!("the opposite sign of all gains{of}{times}{}", shown(self.opposite_gains))
        });
        let gains = self
            .shown_factor
            .map(|factor| format!("all gains{of} times {factor}{}", shown(self.gains)));
        let latency = self.latency.map(|latency| match self.latency_factor {
            Some(factor) => format!("all latencies times at most {}", rounded_down(factor)),
            None => format!("a latency of at most {} s", rounded_down(latency)),
        });
        opposite.into_iter().chain(gains).chain(latency).collect()
    }

    /// How many of the changes are limits, at which the loop has no margin.
    fn limits(&self) -> usize {
        usize::from(self.shown_factor.is_some()) + usize::from(self.latency.is_some())
    }

    /// What the changes leave of the loop's margin, as the end of a sentence.
    pub(super) fn caveat(&self) -> &'static str {
        match (self.limits(), self.opposite_factor) {
            (0, _) => "",
            (1, None) => "; at this limit it has no margin",
            (1, Some(_)) => "; at the last it has no margin",
            _ => "; at these limits it has no margin",
        }
    }

    /// The changes in a sentence.
    pub(super) fn sentence(&self, gain_units: [&str; 2]) -> String {
        let all = self.changes(gain_units);
        match all.is_empty() {
            true => format!(
                "No multiple of {} from 2^-{} to 2^{}, no opposite sign, and no smaller latency, stabilises it at this period.",
                if self.inner { "the gains of the inner controller" } else { "its gains" },
                OCTAVES[0],
                OCTAVES[1]
            ),
            false => {
                let of = if self.of_ideal { "Without imperfections it" } else { "It" };
                format!("{of} is stable with {}{}.", all.join(", or with "), self.caveat())
            }
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
