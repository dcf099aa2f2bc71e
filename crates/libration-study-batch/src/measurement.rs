//! Measurement of rates: execution, rounds, and verdicts on ratios.

use std::f64::consts::FRAC_PI_2;

use libration::ensemble::{Execution, InstructionSet};
use libration_report::record::{Finding, Record, Relation, Tolerance, Undecided};
use libration_study::{Lab, StudyError};

use crate::bench::{Contestant, Rates, Task, Turns, race};

/// Quartiles further apart than this share of the median say that the machine had other work.
const NOISY: f64 = 0.1;

/// Settings that all measurements share.
pub(super) struct Measurement<'a> {
    pub(super) lab: &'a Lab<'a>,
    /// One thread.
    pub(super) serial: Execution,
    /// All cores.
    pub(super) parallel: Execution,
    /// Rounds of ratios with a verdict.
    comparison_turns: Turns,
    /// Rounds of sweeps.
    sweep_turns: Turns,
}

impl<'a> Measurement<'a> {
    /// Returns a measurement on the instruction set of the configuration.
    pub(super) fn new(lab: &'a Lab<'a>) -> Result<Self, StudyError> {
        let serial = lab.alone()?;
        let parallel = serial.clone().threads(0)?;
        let (rounds, seconds) = lab.effort.choose((5, 2e-3), (15, 10e-3), (31, 20e-3));
        let comparison_turns = Turns { rounds, seconds };
        let sweep_turns = Turns { rounds: lab.effort.choose(3, 3, 7), seconds: seconds / 2.0 };
        Ok(Measurement { lab, serial, parallel, comparison_turns, sweep_turns })
    }

    /// The instruction set.
    pub(super) fn set(&self) -> InstructionSet {
        self.serial.instruction_set()
    }

    /// One core and all; one alone where there is no other.
    pub(super) fn executions(&self) -> impl Iterator<Item = &Execution> {
        [&self.serial, &self.parallel].into_iter().take(self.parallel.thread_count().min(2))
    }

    /// The task of the study `throughput` with so many trajectories.
    pub(super) fn task(&self, count: usize) -> Task {
        // Small enough for every bounded method to stay so; explicit Euler leaves an f32 after 10⁸ steps.
        let oscillator = self.lab.config.oscillator;
        Task { count, omega2: oscillator.system().omega2, dt: 1e-3 / oscillator.omega() }
    }

    /// Returns rates for a comparison, with many rounds.
    pub(super) fn compare_rates<const N: usize>(
        &self,
        mut contestants: [Contestant<'_>; N],
    ) -> Result<[Rates; N], StudyError> {
        self.compare_rates_of(&mut contestants).map(exactly)
    }

    /// Returns rates for a comparison of any number of contestants, with many rounds.
    pub(super) fn compare_rates_of(
        &self,
        contestants: &mut [Contestant<'_>],
    ) -> Result<Vec<Rates>, StudyError> {
        race(self.lab, self.comparison_turns, contestants)
    }

    /// Returns rates for a sweep, with few rounds.
    pub(super) fn sweep_rates<const N: usize>(
        &self,
        mut contestants: [Contestant<'_>; N],
    ) -> Result<[Rates; N], StudyError> {
        self.sweep_rates_of(&mut contestants).map(exactly)
    }

    /// Returns rates of any number of contestants for a sweep, with few rounds.
    pub(super) fn sweep_rates_of(
        &self,
        contestants: &mut [Contestant<'_>],
    ) -> Result<Vec<Rates>, StudyError> {
        race(self.lab, self.sweep_turns, contestants)
    }
}

/// Returns one rate per contestant.
fn exactly<const N: usize>(rates: Vec<Rates>) -> [Rates; N] {
    let mut rates = rates.into_iter();
    std::array::from_fn(|_| rates.next().unwrap_or_default())
}

/// A ratio of rates with its uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ratio {
    median: f64,
    /// The distance between the quartiles of the rounds.
    spread: f64,
    /// The standard error of the median.
    error: f64,
}

impl Ratio {
    /// The median of so many rounds, whose quartiles lie `spread` apart.
    pub(super) fn new(median: f64, spread: f64, rounds: usize) -> Self {
        // Quartiles of a normal distribution lie 1.349 standard deviations apart, and its median varies √(π/2)
        // times as much as its mean.
        let deviation = spread / 1.349;
        let error = (FRAC_PI_2 / rounds.max(1) as f64).sqrt() * deviation;
        Ratio { median, spread, error }
    }
}

impl From<&Rates> for Ratio {
    fn from(ratios: &Rates) -> Self {
        Ratio::new(ratios.median(), ratios.spread(), ratios.rounds())
    }
}

/// A ratio of speeds that is to reach a bar, but for twice the error of its median.
///
/// To fall short of it is no disagreement: what else the machine does decides that, and no theory. There is no verdict where the machine was
/// too noisy for one, where there is no bar, and in a build that is not for speed.
pub(super) fn judge(
    record: &mut Record,
    id: String,
    text: String,
    bar: Option<f64>,
    ratio: impl Into<Ratio>,
) {
    let bar = bar.filter(|_| !cfg!(debug_assertions));
    record.find(judged(id, text, bar, ratio.into()));
}

fn judged(id: String, text: String, bar: Option<f64>, ratio: Ratio) -> Finding {
    let Ratio { median, spread, error } = ratio;
    let Some(bar) = bar else { return Finding::measured(id, text, "1", median) };
    let without =
        |reason| Finding::measured(id.clone(), text.clone(), "1", median).undecided(reason);
    // Where rounds lie far apart, the bar must lie further off to be told from their median.
    if spread > NOISY * median && (median - bar).abs() <= spread {
        return without(Undecided::Noisy(format!(
            "the machine was too noisy: the quartiles of the rounds are {spread:.2} apart; target: {bar}"
        )));
    }
    let reason = "twice the standard error of the median of the rounds, by their quartiles";
    let tolerance = Tolerance::absolute(2.0 * error, reason);
    let (own, words) = (id.clone(), text.clone());
    let reached = Finding::related(own, words, "1", Relation::AtLeast, bar, median, tolerance);
    if reached.agrees() {
        return reached;
    }
    without(Undecided::Beyond(format!(
        "not reached: the target is {bar}, and twice the standard error of the median is {:.2}",
        2.0 * error
    )))
}

/// A ratio that is wanted to reach a bar which no theory tells: to fall short of it is no disagreement, and stands there with
/// what is known of the reason.
pub(super) fn aim(
    record: &mut Record,
    id: String,
    text: String,
    bar: Option<f64>,
    ratio: impl Into<Ratio>,
    reason: &str,
) {
    let ratio = ratio.into();
    match bar.filter(|&bar| !cfg!(debug_assertions) && ratio.median < bar) {
        Some(bar) => {
            let finding = Finding::measured(id, text, "1", ratio.median);
            let reason = format!("below the target of {bar}: {reason}");
            record.find(finding.undecided(Undecided::Beyond(reason)));
        }
        None => judge(record, id, text, bar, ratio),
    }
}

#[cfg(test)]
mod tests {
    use libration_report::record::Agreement;

    use super::*;

    #[test]
    fn a_speed_reaches_its_target_or_not_or_is_too_noisy_and_never_disagrees() {
        let judged = |bar, median, spread| {
            let finding = judged("a.b".into(), String::new(), bar, Ratio::new(median, spread, 20));
            assert_ne!(finding.verdict, Agreement::Disagrees);
            (finding.agrees(), finding.undecided.map(|reason| reason.to_string()))
        };
        assert_eq!(judged(Some(0.9), 0.95, 0.01), (true, None));
        assert_eq!(judged(None, 0.5, 0.01), (false, None));
        let (_, missed) = judged(Some(0.9), 0.8, 0.01);
        assert!(missed.unwrap().starts_with("not reached: the target is 0.9"));
        let (_, noisy) = judged(Some(0.9), 0.8, 0.79);
        assert!(noisy.unwrap().starts_with("the machine was too noisy"));
    }

    #[test]
    fn the_median_of_four_times_as_many_rounds_is_twice_as_sure() {
        let [few, many] = [5, 20].map(|rounds| Ratio::new(1.0, 1.349, rounds).error);
        assert!((few / many - 2.0).abs() < 1e-12, "{few} {many}");
        assert!((few * few - FRAC_PI_2 / 5.0).abs() < 1e-12, "{few}");
    }
}
