//! Checks of a loop before any work, and its budgets.

use libration::control::Feedback;
use libration::linear::{GROWTH_ROUNDING, LinearLoopError, LoopTiming};
use libration_analyze::linear_analysis::loop_verdict;
use libration_report::verdict::{Outcome, Verdict};
use libration_work::Work;

use super::budget::Budget;
use super::combined_effect::CombinedEffect;
use super::loops::{Loop, LoopError, PlantModel};
use super::request::{Measure, Request, Tolerance};
use super::stabilising_changes::{StabilisingChanges, rounded_down};
use super::timed_loop::TimedLoop;
use super::{AdviseError, TURN};

/// The parts that advice on a loop in a stability window lacks: without imperfections it has no cost to which a tolerance relates.
pub(super) fn window_parts(has_cost_tolerance: bool) -> &'static [&'static str] {
    match has_cost_tolerance {
        true => &["limits of the stability window", "the tolerance of the cost"],
        false => &["limits of the stability window"],
    }
}

/// The answer about a loop that is stable as stated, and without imperfections has these motions.
pub(super) fn in_window(motions: &str) -> String {
    format!(
        "The loop is stable with the stated imperfections, but only in a stability window that less latency leaves: do not rely on it. \
         Without latency, jitter, skew and loss {motions}."
    )
}

/// Latency in periods that no analysis of a loop allows: one with the wrong unit.
const MOST_PERIODS: f64 = 300.0;

/// A loop that is unstable without imperfections.
pub(super) struct UnstableLoop {
    /// The motions that do not decay, in words, fastest first.
    pub(super) motions: Vec<String>,
    /// Whether the loop is stable with the stated imperfections.
    pub(super) is_stable_as_stated: bool,
    /// Changes that stabilise the loop; none if it is stable as stated.
    pub(super) remedies: Option<StabilisingChanges>,
    /// These in words, with a shorter period.
    pub(super) help: String,
}

impl UnstableLoop {
    /// The verdict and the answer; second moments grow by `growth` per period without imperfections.
    pub(super) fn judged(
        &self,
        timed: &TimedLoop,
        growth: f64,
        tolerance: Tolerance,
    ) -> Result<(Verdict, String), AdviseError> {
        let motions = self.motions.join("; ");
        if self.is_stable_as_stated {
            let stated = timed.stated().map_err(LoopError::from)?;
            let own = loop_verdict(&timed.stability(&stated).map_err(LoopError::from)?);
            let evidence = format!("{}; without imperfections {motions}", own.evidence);
            let parts = window_parts(tolerance.of == Measure::Cost);
            let verdict = Verdict { evidence, ..own };
            let verdict = parts.iter().copied().fold(verdict, Verdict::without);
            return Ok((verdict, in_window(&motions)));
        }
        let (outcome, first) = match growth.abs() <= GROWTH_ROUNDING {
            true => (Outcome::Unknown, "It is unknown whether the loop is stable"),
            false => (Outcome::Unstable, "The loop is unstable"),
        };
        let verdict = Verdict::new(outcome, format!("without imperfections {motions}"));
        let help = &self.help;
        Ok((verdict, format!("{first} without latency, jitter, skew and loss: {motions}. {help}")))
    }
}

impl<M: PlantModel> Loop<M> {
    /// The loop as one that is unstable without imperfections, if it is; fails if its numbers are invalid, before any work.
    pub(super) fn unstable(&self) -> Result<Option<UnstableLoop>, AdviseError> {
        self.check_period()?;
        let (timed, none) = (&self.timed, self.timed.ideal());
        let stated = timed.stated().map_err(LoopError::from)?;
        if let Err(error) = timed.decays(&stated) {
            // A loop that is too large with jitter or losses may be analysed without them.
            let input_latency = stated.input_latency.clone();
            let late = LoopTiming { input_latency, ..none };
            if timed.linear.is_stable(&late) == Ok(false) {
                return Err(AdviseError::LatencyTooLong(self.control.latency));
            }
            if let LinearLoopError::Size { .. } = error {
                let (name, value) = ("loop.latency", self.control.latency);
                if value > MOST_PERIODS * self.control.period {
                    let period = self.control.period;
                    return Err(AdviseError::ExcessiveLatency { seconds: value, period });
                }
                let allowed = "at most 290 periods, 90 with jitter or losses, and 20 with a record and losses";
                return Err(AdviseError::Value { name, value, allowed });
            }
            return Err(LoopError::from(error).into());
        }
        let gains = [self.units.gains[0], self.units.gains[1]];
        let Some(motions) = timed.unstable_modes().map_err(LoopError::from)? else {
            return Ok(None);
        };
        if timed.settles(&stated) {
            let help = "It is stable with the stated imperfections, but only in a stability window that less latency leaves.";
            let (remedies, help) = (None, help.to_owned());
            return Ok(Some(UnstableLoop { motions, is_stable_as_stated: true, remedies, help }));
        }
        let remedies = self.stabilising_changes(&stated);
        let shorter = self.stable_period().map_or_else(String::new, |period| {
            format!(" It is stable with a period of {} s.", rounded_down(period))
        });
        let help = format!("{}{shorter}", remedies.sentence(gains));
        let remedies = Some(remedies);
        Ok(Some(UnstableLoop { motions, is_stable_as_stated: false, remedies, help }))
    }

    /// The growth of a loop that is unstable without imperfections: without them, or as stated if it is stable then. It has no margin.
    pub(super) fn combined_effect_unstable(
        &self,
        request: &Request,
        unstable: &UnstableLoop,
    ) -> Result<CombinedEffect, AdviseError> {
        let timing = match unstable.is_stable_as_stated {
            true => self.timed.stated().map_err(LoopError::from)?,
            false => self.timed.ideal(),
        };
        let cost = match unstable.is_stable_as_stated {
            true => Some(self.timed.cost(&timing).map_err(LoopError::from)?),
            false => None,
        };
        Ok(CombinedEffect {
            growth: self.timed.growth(&timing).map_err(LoopError::from)?,
            margin: None,
            margin_tried_up_to: None,
            ideal_cost: f64::INFINITY,
            cost: cost.filter(|cost| cost.is_finite()),
            cost_increase: None,
            simulated: None,
            region_of_attraction: None,
            command: self.command(&timing, request),
        })
    }

    /// Fails if the period is too short or too long for the motions of the loop.
    fn check_period(&self) -> Result<(), AdviseError> {
        let Feedback { position, velocity } = self.gains();
        let plant = self.plant().rate();
        let fastest = plant.max(position.abs().sqrt()).max(velocity.abs());
        if fastest == 0.0 {
            // Without motion every period is valid.
            return Ok(());
        }
        let period = self.control.period;
        let (least, most) = (TURN.start() / fastest, TURN.end() / plant);
        if period >= least && period <= most {
            return Ok(());
        }
        let allowed = match most.is_finite() {
            true => format!("{least:.3e} to {most:.3e} s"),
            false => format!("at least {least:.3e} s"),
        };
        Err(AdviseError::Period { period, allowed })
    }

    pub(super) fn budgets(
        &self,
        work: &Work<'_>,
        request: &Request,
    ) -> Result<Vec<Budget>, AdviseError> {
        let command = |timing: &LoopTiming| self.command(timing, request);
        self.timed.budgets(work, &self.timed.subjects(false), request.tolerance, &command)
    }
}
