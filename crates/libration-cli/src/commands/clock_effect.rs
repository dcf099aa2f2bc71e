//! What a recorded clock and a measured latency do to a loop.

use std::path::Path;

use libration_advise::Budget;
use libration_logs::clock::Latency;
use serde::Serialize;

use super::advise::{self, Verdict};
use super::measure_jitter::time;
use crate::args::{AdviseArgs, ClockArgs, quoted};
use crate::error::Failure;

/// Largest skew of a topic that is the clock of a loop.
const OTHER_RATE: f64 = 0.05;

/// What a clock and a latency do to a loop.
#[derive(Debug, Serialize)]
pub(super) struct Effect {
    /// The case in words.
    pub(super) case: String,
    /// The latency of commands in s; none for that of the file.
    pub(super) latency: Option<f64>,
    /// Whether the loop is stable and within its tolerance.
    pub(super) holds: bool,
    /// The answer of `advise`.
    pub(super) answer: String,
    pub(super) warnings: Vec<String>,
    /// The budgets of latency, jitter and skew.
    pub(super) budgets: Vec<Budget>,
    /// The command that repeats the computation.
    pub(super) command: String,
}

/// The loop with the recorded clock of mean interval `mean`, in s: with its own latency, or with the median and the 99 % quantile of the measured one.
pub(super) fn effects(
    args: &ClockArgs,
    config: &Path,
    topic: Option<&str>,
    mean: f64,
    latency: Option<&Latency>,
    quiet: bool,
) -> Result<Vec<Effect>, Failure> {
    let cases = match latency {
        None => vec![("recorded clock, latency of the file".to_owned(), None)],
        Some(latency) => {
            let case = |name: &str, part| {
                (format!("recorded clock, {name} latency"), Some(latency.quantile(part).max(0.0)))
            };
            vec![case("median", 0.5), case("99 %", 0.99)]
        }
    };
    let effect = |(case, latency): (String, Option<f64>)| {
        let words = advise_words(args, config, topic, latency);
        let command = quoted(words.clone());
        let advise_args = AdviseArgs::parse_words(words)?;
        let Verdict { answer, mut warnings, budgets, period, holds } =
            advise::verdict(&advise_args, &command, quiet)?;
        warnings.splice(0..0, period.and_then(|period| other_rate(period, mean)));
        Ok(Effect { case, latency, holds, answer, warnings, budgets, command })
    };
    cases.into_iter().map(effect).collect()
}

/// A warning if the mean interval of a topic is not the period of the loop.
fn other_rate(period: f64, mean: f64) -> Option<String> {
    let is_other = (mean / period - 1.0).abs() > OTHER_RATE;
    is_other.then(|| {
        format!(
            "the mean interval of the topic is {}, the period of the loop {}: the topic is not the clock of this loop; \
             help: choose a --topic with one message per period",
            time(mean),
            time(period)
        )
    })
}

/// The command line of `advise` with the clock of a topic and a latency in s.
pub(super) fn advise_words(
    args: &ClockArgs,
    config: &Path,
    topic: Option<&str>,
    latency: Option<f64>,
) -> Vec<String> {
    let mut words: Vec<String> = ["libration", "advise", "--config"].map(str::to_owned).into();
    words.push(config.display().to_string());
    words.extend(["--jitter-file".to_owned(), args.file.display().to_string()]);
    words.extend(args.topic.words(topic));
    if let Some(latency) = latency {
        words.extend(["--latency".to_owned(), format!("{:.6}", latency.max(0.0))]);
    }
    words
}
