//! What a recorded clock and a measured latency do to a loop.

use std::path::Path;

use libration_advise::Budget;
use libration_logs::clock::{Dependence, Latency};
use libration_report::Verdict;
use serde::Serialize;

use super::advise;
use crate::args::{AdviseArgs, ClockArgs, quoted};
use crate::error::Failure;

/// What a clock and a latency do to a loop.
#[derive(Debug, Serialize)]
pub(super) struct Effect {
    /// The case in words.
    pub(super) case: String,
    /// The latency of commands in s; none for that of the file.
    pub(super) latency: Option<f64>,
    /// Whether the loop is stable and within its tolerance.
    pub(super) holds: bool,
    /// The verdict of `advise`; unknown if the clock or the latency is not that of the loop.
    pub(super) verdict: Verdict,
    /// The answer of `advise`.
    pub(super) answer: String,
    pub(super) warnings: Vec<String>,
    /// The budgets of latency, jitter and skew.
    pub(super) budgets: Vec<Budget>,
    /// The command that repeats the computation.
    pub(super) command: String,
}

/// The loop with the recorded clock: with its own latency, or with the median and the 99 % quantile of the measured one.
pub(super) fn effects(
    args: &ClockArgs,
    config: &Path,
    topic: Option<&str>,
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
    let is_changing =
        latency.is_some_and(|found| found.time_dependence.dependence == Dependence::Changing);
    let effect = |(case, latency): (String, Option<f64>)| {
        let words = advise_words(args, config, topic, latency);
        let command = quoted(words.clone());
        let advise_args = AdviseArgs::parse_words(words)?;
        let advise::ClockAdvice { answer, verdict, warnings, budgets } =
            advise::of_clock(&advise_args, &command, is_changing, quiet)?;
        let holds = verdict.is_good();
        Ok(Effect { case, latency, holds, verdict, answer, warnings, budgets, command })
    };
    cases.into_iter().map(effect).collect()
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
