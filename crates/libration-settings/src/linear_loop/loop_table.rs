//! The table of a loop around a linear plant.

use serde::Deserialize;

use super::weights_table::{Weights, WeightsTable};
use crate::latency_presets::LatencyValues;
use crate::{Fault, Number, duration};

/// The table `[loop]` of a loop around a linear plant.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct LinearLoopTable {
    /// The sampling period, in s, or with a unit (default: that of a sampled plant, or 0.01).
    #[serde(deserialize_with = "duration::optional_period")]
    pub period: Option<Number>,
    /// The latency of all inputs, or of each, in s.
    pub latency: Channels,
    /// The latency of all outputs, or of each, in s.
    pub output_latency: Channels,
    /// The relative rms of the period.
    pub jitter: Number,
    /// The law of the period: `gaussian` or `uniform`.
    pub law: String,
    /// The relative error of the period: positive for a slow clock.
    pub skew: Number,
    /// The probability that the commands that arrive in a period are lost.
    pub loss: Number,
    /// What acts where a command is missing: `hold`, the command that acts already, or `zero`.
    pub missing: String,
    /// The length of a period that the controller uses: `nominal`, or `measured`, that of the last one.
    pub clock: String,
    /// How many deadlines are missed at worst: `2 of 5` or `2 consecutive`; empty if none.
    pub deadline_misses: String,
    /// What happens to a job that overruns its period: `kill`, `skip` or `queue`.
    pub overrun: String,
    /// The probability that a job overruns.
    pub overrun_probability: Number,
    /// The path of time stamps that replace jitter and skew.
    pub time_stamps: String,
    /// The weights of the cost (default: those of the design, or the squares of the outputs).
    pub cost: Option<WeightsTable>,
    /// The variances of the noise of the measurements (default: those of the design, or zero).
    pub measurement_noise: Option<Weights>,
}

/// One number for all channels, or one for each.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(from = "LatencyValues")]
pub enum Channels {
    /// For all.
    All(Number),
    /// For each.
    Each(Vec<Number>),
}

impl From<LatencyValues> for Channels {
    fn from(values: LatencyValues) -> Self {
        match values {
            LatencyValues::All(seconds) => Channels::All(Number(seconds)),
            LatencyValues::Each(all) => Channels::Each(all.into_iter().map(Number).collect()),
        }
    }
}

impl Default for LinearLoopTable {
    fn default() -> Self {
        LinearLoopTable {
            period: None,
            latency: Channels::All(Number(0.0)),
            output_latency: Channels::All(Number(0.0)),
            jitter: Number(0.0),
            law: "gaussian".into(),
            skew: Number(0.0),
            loss: Number(0.0),
            missing: "hold".into(),
            clock: "nominal".into(),
            deadline_misses: String::new(),
            overrun: "kill".into(),
            overrun_probability: Number(0.0),
            time_stamps: String::new(),
            cost: None,
            measurement_noise: None,
        }
    }
}

impl Channels {
    /// A number for each of `count` channels, which are `of`.
    ///
    /// # Errors
    /// [`Fault`]: a wrong number of values, or one that is not finite or below zero.
    pub fn each(&self, key: &'static str, of: &str, count: usize) -> Result<Vec<f64>, Fault> {
        let values: Vec<f64> = match self {
            Channels::All(Number(value)) => vec![*value; count],
            Channels::Each(values) => values.iter().map(|x| x.0).collect(),
        };
        let name = key.rsplit('.').next().unwrap_or(key);
        if values.len() != count {
            let given = values.len();
            let message = format!(
                "`{name}` has {given} values; expected one, or one for each of {count} {of}"
            );
            return Err(Fault::new(key, message));
        }
        match values.iter().position(|x| !(x.is_finite() && *x >= 0.0)) {
            None => Ok(values),
            Some(i) => {
                let message =
                    format!("`{name}` is {:?}; expected a finite number of at least 0", values[i]);
                Err(Fault::at(key, i, message))
            }
        }
    }
}
