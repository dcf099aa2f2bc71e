//! What a recorded clock and a measured latency do to a loop.

use std::path::Path;

use libration_advise::Budget;
use libration_logs::clock::{Dependence, Latency};
use libration_report::{Outcome, Verdict};
use serde::Serialize;

use super::advise;
use super::time_stamps::other_rate;
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
    /// The same with its evidence; unknown if the clock or the latency is not that of the loop.
    pub(super) verdict: Verdict,
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
    let is_changing =
        latency.is_some_and(|found| found.time_dependence.dependence == Dependence::Changing);
    let effect = |(case, latency): (String, Option<f64>)| {
        let words = advise_words(args, config, topic, latency);
        let command = quoted(words.clone());
        let advise_args = AdviseArgs::parse_words(words)?;
        let advise::Verdict { answer, mut warnings, budgets, period, growth, holds } =
            advise::verdict(&advise_args, &command, quiet)?;
        let other = period.and_then(|period| other_rate("topic", period, mean));
        let verdict = match &other {
            Some(_) => Verdict::unknown("the topic is not the clock of this loop"),
            None if is_changing => Verdict::unknown("the latencies change over time"),
            None => judged(growth, holds),
        };
        warnings.splice(0..0, other);
        Ok(Effect { case, latency, holds, verdict, answer, warnings, budgets, command })
    };
    cases.into_iter().map(effect).collect()
}

/// The verdict on a loop whose second moments grow at this rate per period.
fn judged(growth: Option<f64>, holds: bool) -> Verdict {
    let Some(growth) = growth else { return Verdict::unknown("the file has no loop") };
    let evidence = format!("second moments change by {:+.4e} per period", growth.exp_m1());
    let outcome = match (growth < 0.0, holds) {
        (true, true) => Outcome::Stable,
        (true, false) => Outcome::Exceeds,
        (false, _) => Outcome::Unstable,
    };
    Verdict::new(outcome, evidence)
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
