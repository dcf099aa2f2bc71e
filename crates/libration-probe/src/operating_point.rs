//! Where an equilibrium is from the point for which it was searched.

use libration_report::notation::number;
use serde::{Deserialize, Serialize};

/// Part of the largest change of a near equilibrium up to which the first sentence does not mention it.
const SMALL: f64 = 0.02;

/// An equilibrium that was searched for, beside the requested point.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OperatingPoint {
    /// How it was found.
    pub method: String,
    /// The change of each position from the request.
    pub changes: Vec<f64>,
    /// The largest change.
    pub largest: LargestChange,
    /// The largest change in parts of that of a point which is near: above 1 the equilibrium is far from the request.
    pub relative_change: f64,
    /// The largest sum of forces relative to their sizes.
    pub residual: f64,
    /// Contacts, limits and constraints that act at the equilibrium, but not at the request.
    pub gained: Vec<String>,
    /// Those that act at the request only.
    pub lost: Vec<String>,
    /// A run from the request.
    pub run: StandingRun,
}

/// The largest change of a position.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LargestChange {
    /// The position.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// The change.
    pub change: f64,
}

/// A run from rest at the request, under its commands.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StandingRun {
    /// Its length in s.
    pub seconds: f64,
    /// Whether it stays near the request.
    pub stands: bool,
    /// The least factor of all gains of position with which it does; none if it stands, or if no factor was found.
    pub least_factor: Option<f64>,
    /// The largest factor that was tried; 1 if the model has no servos.
    pub tried_up_to: f64,
}

impl OperatingPoint {
    /// Whether the equilibrium is far from the request.
    pub fn is_far(&self) -> bool {
        self.relative_change.is_nan() || self.relative_change > 1.0
    }

    /// Whether the equilibrium is the request, for all that a reader needs to know.
    pub fn is_small(&self) -> bool {
        self.relative_change <= SMALL && self.gained.is_empty() && self.lost.is_empty()
    }

    /// Distance and changed constraints, as a part of a sentence.
    pub fn distance(&self) -> String {
        let LargestChange { name, unit, change } = &self.largest;
        let mut text = format!("{} {unit} from the request in {name}", number(change.abs(), 3));
        for (what, all) in [("it has", &self.gained), ("it lacks", &self.lost)] {
            if !all.is_empty() {
                let shown: Vec<&str> = all.iter().take(4).map(String::as_str).collect();
                let more = match all.len() - shown.len() {
                    0 => String::new(),
                    more => format!(" and {more} more"),
                };
                text += &format!(", {what} {}{more}", shown.join(", "));
            }
        }
        text
    }

    /// The first sentence about an equilibrium that is not quite the request; none if it is.
    pub fn sentence(&self) -> Option<String> {
        let residual = number(self.residual, 1);
        (!self.is_small())
            .then(|| format!("The equilibrium is {} (residual force {residual}).", self.distance()))
    }

    /// What stands, in a part of a sentence; empty if the run stands.
    pub fn remedy(&self) -> String {
        let run = &self.run;
        let seconds = number(run.seconds, 2);
        if run.stands {
            return String::new();
        }
        let left = format!("; a run of {seconds} s from the request leaves its surroundings");
        left + &match run.least_factor {
            Some(factor) => format!(
                ": the servos are too weak; with all gains of position times {} such a run stays",
                number(rounded_up(factor), 3)
            ),
            None if run.tried_up_to > 1.0 => format!(
                ", and with all gains of position times 1.5 to {} as well",
                number(run.tried_up_to, 3)
            ),
            None => ", and no servo holds a position".into(),
        }
    }
}

/// A factor from which a run stays, rounded to three digits so that it still does.
fn rounded_up(x: f64) -> f64 {
    let unit = 10.0_f64.powf(x.log10().floor() - 2.0);
    (x / unit).ceil() * unit
}
