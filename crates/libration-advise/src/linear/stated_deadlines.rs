//! The missed deadlines that a request states.

use libration::linear::{MissConstraint, OverrunStrategy};
use libration_settings::linear_loop::LinearLoopTable;
use libration_settings::{Fault, suggestions};

/// The deadlines that a request states as missed.
#[derive(Clone, Debug)]
pub(super) struct StatedDeadlines {
    /// What happens to a job that overruns.
    pub(super) strategy: OverrunStrategy,
    /// The deadlines missed at worst; none if the request states none.
    pub(super) misses: Option<MissConstraint>,
    /// The probability that a job overruns.
    pub(super) probability: f64,
}

impl StatedDeadlines {
    /// What a table states.
    pub(super) fn new(table: &LinearLoopTable, cascade: bool) -> Result<Self, Fault> {
        let strategy = match &*table.overrun {
            "kill" => OverrunStrategy::Kill,
            "skip" => OverrunStrategy::Skip,
            "queue" => OverrunStrategy::Queue,
            other => {
                let fault =
                    Fault::new("loop.overrun", format!("unknown value `{other}` of `overrun`"));
                let known = ["kill", "skip", "queue"];
                return Err(fault.help(suggestions::suggest("values", other, known)));
            }
        };
        let misses = match table.deadline_misses.trim() {
            "" => None,
            text => Some(constraint(text)?),
        };
        let probability = table.overrun_probability.0;
        if strategy != OverrunStrategy::Kill && misses.is_none() && probability == 0.0 {
            let message = format!(
                "`overrun` is \"{}\", but no job overruns; expected `deadline-misses` or `overrun-probability` with it",
                table.overrun
            );
            return Err(Fault::new("loop.overrun", message));
        }
        if misses.is_some() || probability > 0.0 {
            let other = match table.clock.as_str() {
                _ if cascade => Some("the controller is a cascade; expected one controller"),
                "measured" => Some("`clock` is \"measured\"; expected \"nominal\""),
                _ => None,
            };
            if let Some(other) = other {
                let message = format!("missed deadlines are stated, and {other}");
                return Err(Fault::new("loop", message));
            }
        }
        let why = if !(0.0..1.0).contains(&probability) {
            Some("expected a probability of at least 0 and below 1")
        } else if probability == 0.0 {
            None
        } else if table.loss.0 > 0.0 {
            Some("`loss` is given too; expected one of the two")
        } else if !table.time_stamps.is_empty() {
            Some("`time-stamps` are given too; expected one of the two")
        } else {
            None
        };
        match why {
            Some(why) => {
                let message = format!("`overrun-probability` is {probability:?}; {why}");
                Err(Fault::new("loop.overrun-probability", message))
            }
            None => Ok(StatedDeadlines { strategy, misses, probability }),
        }
    }
}

/// The constraint `m of K` or `m consecutive`.
fn constraint(text: &str) -> Result<MissConstraint, Fault> {
    let refused = |expected: &str| {
        let message = format!("`deadline-misses` is \"{text}\"; expected {expected}");
        Fault::new("loop.deadline-misses", message)
    };
    let rule = "`m of K` with m below K, as \"2 of 5\", or \"2 consecutive\"";
    let words: Vec<&str> = text.split_whitespace().collect();
    let number = |word: &str| word.parse::<u32>().map_err(|_| refused(rule));
    let (misses, window) = match words[..] {
        [misses, "of", window] => (number(misses)?, number(window)?),
        [misses, "consecutive"] => {
            let misses = number(misses)?;
            (misses, misses.saturating_add(1))
        }
        _ => return Err(refused(rule)),
    };
    if misses >= window {
        return Err(refused(rule));
    }
    let many = "a smaller window: at most 1000 choices of m deadlines of K";
    MissConstraint::new(misses, window).ok_or_else(|| refused(many))
}
