//! Deadlines that a loop misses: at worst, and at random.

use libration::linear::{
    LoopTiming, MissBounds, MissConstraint, MissingCommand, OverrunStrategy, PeriodOutcome,
    RandomOverruns, Verdict as MissVerdict,
};
use libration_report::verdict::{Outcome, Verdict};
use serde::Serialize;

use super::LinearRequest;
use super::stated_deadlines::StatedDeadlines;
use crate::AdviseError;
use crate::loops::LoopError;
use crate::summary::percent;
use crate::timed_loop::TimedLoop;

/// Missed deadlines of a loop, with the stated latencies and skew.
#[derive(Clone, Debug, Serialize)]
pub struct DeadlineMisses {
    /// What happens to a job that overruns: `kill`, `skip` or `queue`.
    pub overrun: &'static str,
    /// What acts where a period sends no commands: `hold` or `zero`.
    pub missing: &'static str,
    /// The worst sequence; none if the request states no misses.
    pub worst_case: Option<WorstCase>,
    /// Random overruns; none if the request states none.
    pub random: Option<RandomMisses>,
}

/// The worst sequence of missed deadlines, without jitter.
#[derive(Clone, Debug, Serialize)]
pub struct WorstCase {
    /// With the stated number of misses.
    pub stated: MissRow,
    /// The most misses in the same window with which the loop is certainly stable; none if it is not even without misses.
    pub stable_up_to: Option<u32>,
    /// All numbers of misses in the same window that were tried, until one is unstable.
    pub tried: Vec<MissRow>,
}

/// Bounds with a number of misses in a window.
#[derive(Clone, Debug, Serialize)]
pub struct MissRow {
    /// The most misses in a window.
    pub misses: u32,
    /// The deadlines of a window.
    pub window: u32,
    /// `stable`, `unstable` or `undecided`.
    pub verdict: &'static str,
    /// The least factor per period by which motions grow in the worst sequence.
    pub lower: f64,
    /// The largest.
    pub upper: f64,
    /// The worst sequence that was found: `met`, `missed`, or `late` where the commands of the job before are sent.
    pub sequence: Vec<&'static str>,
}

/// Random overruns, with the stated jitter.
#[derive(Clone, Debug, Serialize)]
pub struct RandomMisses {
    /// The probability that a job overruns.
    pub probability: f64,
    /// The logarithm of the growth factor of second moments per period.
    pub growth: f64,
    /// The cost under noise; none if it is infinite.
    pub cost: Option<f64>,
    /// The smallest probability at which second moments stop to decay, from 64ths; none if there is none.
    pub stable_up_to: Option<f64>,
}

/// The relative width of the bounds with the stated number of misses.
const WIDTH: f64 = 1e-3;

impl LinearRequest {
    /// The missed deadlines that the request states; none if it states none.
    pub(super) fn deadline_misses(
        &self,
        stated: &LoopTiming,
    ) -> Result<Option<DeadlineMisses>, AdviseError> {
        let StatedDeadlines { strategy, misses, probability } = self.deadlines;
        if misses.is_none() && probability == 0.0 {
            return Ok(None);
        }
        let timed = &self.timed;
        let worst = misses.map(|misses| worst_case(timed, stated, strategy, misses)).transpose();
        let overruns = RandomOverruns { strategy, probability };
        let random = (probability > 0.0).then(|| random(timed, stated, overruns)).transpose();
        Ok(Some(DeadlineMisses {
            overrun: match strategy {
                OverrunStrategy::Kill => "kill",
                OverrunStrategy::Skip => "skip",
                OverrunStrategy::Queue => "queue",
            },
            missing: match stated.missing {
                MissingCommand::Hold => "hold",
                MissingCommand::Zero => "zero",
            },
            worst_case: worst?,
            random: random?,
        }))
    }
}

fn worst_case(
    timed: &TimedLoop,
    stated: &LoopTiming,
    strategy: OverrunStrategy,
    constraint: MissConstraint,
) -> Result<WorstCase, AdviseError> {
    let window = constraint.window();
    let bounds = |constraint: MissConstraint, once_decided| {
        let found = timed.linear.miss_bounds(stated, strategy, constraint, WIDTH, once_decided);
        found.map(|found| MissRow::new(constraint, &found)).map_err(LoopError::from)
    };
    let own = bounds(constraint, false)?;
    let mut tried = Vec::new();
    for misses in 0..window {
        let row = if misses == constraint.misses() {
            own.clone()
        } else {
            match MissConstraint::new(misses, window) {
                Some(constraint) => bounds(constraint, true)?,
                // Its graph is too large.
                None => continue,
            }
        };
        let ends = row.verdict == UNSTABLE;
        tried.push(row);
        // More misses allow all sequences that fewer do.
        if ends {
            break;
        }
    }
    let stable = tried.iter().filter(|row| row.verdict == STABLE);
    let stable_up_to = stable.map(|row| row.misses).max();
    Ok(WorstCase { stated: own, stable_up_to, tried })
}

fn random(
    timed: &TimedLoop,
    stated: &LoopTiming,
    overruns: RandomOverruns,
) -> Result<RandomMisses, AdviseError> {
    let linear = &timed.linear;
    let decays = |probability: f64| {
        let other = RandomOverruns { probability, ..overruns };
        linear.decays_with_overruns(stated, other).map_err(LoopError::from)
    };
    let growth = linear.overrun_growth(stated, overruns).map_err(LoopError::from)?;
    let found = linear.overrun_stationary(stated, overruns).map_err(LoopError::from)?;
    let mut low = 0.0;
    let mut high = None;
    for part in 0..64 {
        let probability = f64::from(part) / 64.0;
        if !decays(probability)? {
            high = Some(probability);
            break;
        }
        low = probability;
    }
    let stable_up_to = match high {
        Some(mut high) => {
            // To the digits of the answer.
            for _ in 0..24 {
                let middle = 0.5 * (low + high);
                if decays(middle)? { low = middle } else { high = middle }
            }
            Some(low)
        }
        None => None,
    };
    let cost = found.map(|found| found.cost);
    Ok(RandomMisses { probability: overruns.probability, growth, cost, stable_up_to })
}

const STABLE: &str = "stable";
const UNSTABLE: &str = "unstable";

impl MissRow {
    fn new(constraint: MissConstraint, found: &MissBounds) -> Self {
        let word = |outcome: &PeriodOutcome| match outcome {
            PeriodOutcome::Met => "met",
            PeriodOutcome::Missed => "missed",
            PeriodOutcome::Late => "late",
        };
        MissRow {
            misses: constraint.misses(),
            window: constraint.window(),
            verdict: match found.verdict {
                MissVerdict::Stable => STABLE,
                MissVerdict::Unstable => UNSTABLE,
                MissVerdict::Undecided => "undecided",
            },
            lower: found.lower,
            upper: found.upper,
            sequence: found.sequence.iter().map(word).collect(),
        }
    }

    /// The worst sequence with repetitions counted: `3 × met, missed`.
    pub fn sequence_text(&self) -> String {
        let mut runs: Vec<(&str, usize)> = Vec::new();
        for &word in &self.sequence {
            match runs.last_mut() {
                Some((last, count)) if *last == word => *count += 1,
                _ => runs.push((word, 1)),
            }
        }
        let run = |&(word, count): &(&str, usize)| match count {
            1 => word.to_owned(),
            count => format!("{count} × {word}"),
        };
        runs.iter().map(run).collect::<Vec<_>>().join(", ")
    }
}

impl DeadlineMisses {
    /// Whether the loop is certainly stable with all that is stated.
    pub fn holds(&self) -> bool {
        let worst = self.worst_case.as_ref().is_none_or(|worst| worst.stated.verdict == STABLE);
        worst && self.random.as_ref().is_none_or(|random| random.growth < 0.0)
    }

    /// The verdict on what is stated: that of the worst sequence, or of random overruns where the worst sequence is stable.
    pub(super) fn verdict(&self) -> Verdict {
        let worst = self.worst_case.as_ref().map(|worst| &worst.stated);
        match (worst, &self.random) {
            (Some(row), _) if row.verdict == UNSTABLE => Verdict::new(
                Outcome::Unstable,
                format!(
                    "with {} of any {} deadlines missed, motions grow by {:.5} per period",
                    row.misses, row.window, row.lower
                ),
            ),
            (_, Some(random)) if random.growth >= 0.0 => Verdict::new(
                Outcome::Unstable,
                format!(
                    "with {} % of the jobs overrunning, second moments grow by {} % per period",
                    percent(random.probability),
                    percent(random.growth.exp_m1())
                ),
            ),
            (Some(row), _) if row.verdict != STABLE => Verdict::unknown(format!(
                "with {} of any {} deadlines missed, motions change by {:.5} to {:.5} per period",
                row.misses, row.window, row.lower, row.upper
            )),
            _ => Verdict::new(Outcome::Stable, "with the stated missed deadlines"),
        }
    }

    /// The verdicts in sentences.
    pub(super) fn sentences(&self) -> String {
        let worst = self.worst_case.as_ref().map(|worst| self.worst_sentence(worst));
        let random = self.random.as_ref().map(|random| {
            let probability = percent(random.probability);
            let change = percent(random.growth.exp_m1().abs());
            let verdict = match random.growth < 0.0 {
                true => format!("stable: second moments fall by {change} % per period"),
                false => format!("unstable: second moments grow by {change} % per period"),
            };
            format!("With {probability} % of the jobs overrunning at random it is {verdict}.")
        });
        worst.into_iter().chain(random).collect::<Vec<_>>().join(" ")
    }

    fn worst_sentence(&self, WorstCase { stated, stable_up_to, .. }: &WorstCase) -> String {
        let MissRow { misses, window, lower, upper, .. } = stated;
        let how = format!("({}, {})", self.overrun, self.missing);
        let allowed = match stable_up_to {
            Some(most) if most > misses => {
                format!(" It is still stable with {most} of {window}.")
            }
            Some(0) => " It is stable if none is missed.".to_owned(),
            Some(most) if most < misses => format!(" It is stable with {most} of {window}."),
            _ => String::new(),
        };
        let deadlines = format!("{misses} of any {window} deadlines missed {how}");
        match stated.verdict {
            STABLE => format!(
                "With at most {deadlines} it is stable: in the worst sequence motions change by a factor of {lower:.5} to {upper:.5} per period.{allowed}"
            ),
            UNSTABLE => format!(
                "With at most {deadlines} the loop is unstable: motions grow by a factor of {lower:.5} per period in the repeated sequence {}.{allowed}",
                stated.sequence_text()
            ),
            _ => format!(
                "With at most {deadlines} stability is undecided: in the worst sequence motions change by a factor of {lower:.5} to {upper:.5} per period.{allowed}"
            ),
        }
    }
}
