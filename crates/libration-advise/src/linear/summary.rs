//! The answer on a loop around a linear plant, in sentences.

use libration_report::notation::cut_off;
use libration_report::verdict::Outcome;

use super::LinearAdvice;
use crate::loop_check::in_window;
use crate::summary::{beside_ideal, capitalise, describe_window, noun, percent};
use crate::used_share::share_in_percent;

impl LinearAdvice {
    /// The answer in a few sentences. A failure because of missed deadlines comes first.
    pub(super) fn summary(&self) -> String {
        let all_met = self.summary_without_misses();
        let mut text = match &self.deadline_misses {
            Some(misses) if misses.holds() => format!("{all_met} {}", misses.sentences()),
            Some(misses) => {
                let mut letters = all_met.chars();
                let first: String =
                    letters.next().into_iter().flat_map(char::to_lowercase).collect();
                let rest = letters.as_str();
                format!("{} Without missed deadlines {first}{rest}", misses.sentences())
            }
            None => all_met,
        };
        if let Some(point) = &self.operating_point {
            text = format!("{} {}", text.trim_end(), point.location());
        }
        text
    }

    fn summary_without_misses(&self) -> String {
        let remedies = self.remedies.as_ref().map(|remedies| remedies.sentence(["", ""]));
        if !self.unstable_motions.is_empty() {
            let motions = self.unstable_motions.join("; ");
            if self.stable_as_stated.is_some() && self.verdict.is_good() {
                return in_window(&motions);
            }
            let first = match self.verdict.outcome {
                Outcome::Unknown => {
                    "It is unknown whether the loop is stable without latency, jitter, skew and loss"
                }
                _ => "The loop is unstable without latency, jitter, skew and loss",
            };
            let help = remedies.unwrap_or_else(|| "Shorten the period.".to_owned());
            return format!("{first}: {motions}. {help}");
        }
        if self.verdict.outcome == Outcome::Unknown && self.remedies.is_some() {
            return format!(
                "It is unknown whether the loop is stable with the stated imperfections: {}. {}",
                self.verdict.evidence,
                remedies.unwrap_or_default()
            );
        }
        if self.remedies.is_some() {
            return format!(
                "The loop is unstable with the stated imperfections: its second moments grow by {} % per period. {}",
                percent(self.growth.exp_m1()),
                remedies.unwrap_or_default()
            );
        }
        if let Some(motion) = self.motion.as_ref().filter(|motion| motion.contradiction().is_some())
        {
            return format!(
                "The loop is {}: {}. Its linearisation is stable, and all limits are those of it.",
                match self.verdict.outcome {
                    Outcome::Unstable => "unstable",
                    _ => "not known to be stable",
                },
                motion.in_words()
            );
        }
        let of_loop = match self.is_linearised_only() {
            true => "The linearised loop",
            false => "The loop",
        };
        let regained = self.budgets.iter().find_map(|budget| Some((budget, budget.regained?)));
        let mut text = match (self.margin, self.margin_tried_up_to) {
            _ if self.simulated.is_some_and(|simulated| !simulated.agrees()) => {
                "The simulation contradicts the theory of the loop: see the warnings.".to_owned()
            }
            _ if self.exceeds_tolerated_cost() => {
                format!(
                    "{of_loop} is stable with the stated imperfections, but its cost exceeds the tolerance."
                )
            }
            _ if let Some((budget, window)) = regained => describe_window(budget, window),
            (Some(margin), _) => format!(
                "{of_loop} is stable with the stated imperfections, also if all of them are {} times as large.",
                cut_off(margin, 4)
            ),
            (None, Some(tried)) => format!(
                "{of_loop} is stable with the stated imperfections, also if all of them are at least {} times as large, the most that was tried.",
                cut_off(tried, 4)
            ),
            (None, None) if self.deadline_misses.is_some() => format!("{of_loop} is stable."),
            (None, None) => {
                format!("{of_loop} is stable. The request states no imperfections.")
            }
        };
        if let Some(failing) = &self.fails_first {
            let shape = match &failing.states[..] {
                [] => String::new(),
                states => {
                    let names: Vec<&str> = states.iter().map(|(name, _)| name.as_str()).collect();
                    format!(", most in {}", names.join(", "))
                }
            };
            let kind = noun(failing.kind);
            let subject = match &failing.channel {
                Some(channel) => format!("{kind} of {channel}"),
                None => kind.to_owned(),
            };
            text += &format!(
                " {} fails first, with {} of its budget used; {}{shape}.",
                capitalise(&subject),
                share_in_percent(failing.used),
                failing.how
            );
        }
        if let Some(increase) = self.cost_increase.filter(|_| self.margin_tried_up_to.is_some()) {
            text += &format!(" Its cost is {}.", beside_ideal(increase));
        }
        let far = self.motion.as_ref().and_then(|motion| motion.excursion.as_ref());
        text += &far.map_or_else(String::new, |far| {
            format!(" From the start of the system {}.", far.in_words())
        });
        if self.is_linearised_only() {
            text += " The motion of the nonlinear system was not simulated.";
        }
        text
    }

    /// What the redesigned controller costs beside the given one, in a sentence.
    pub fn redesign_effect(&self) -> String {
        let Some(redesign) = &self.redesign else { return String::new() };
        match (self.cost, redesign.cost) {
            (_, None) => "The redesigned loop is unstable with the stated imperfections.".into(),
            (None, Some(cost)) => format!(
                "Its cost with all stated imperfections is {cost:.6e}; the given controller is unstable with them."
            ),
            (Some(before), Some(cost)) => format!(
                "Its cost with all stated imperfections is {cost:.6e}; that of the given controller is {before:.6e}, {:.4} times as much.",
                before / cost
            ),
        }
    }

    /// The warnings, most urgent first.
    pub(super) fn warnings_of(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        match &self.simulated {
            Some(simulated) if !simulated.agrees() => warnings.push(format!(
                "the simulation contradicts the theory: the cost is {:.5e} ± {:.1e}, predicted {:.5e}",
                simulated.cost, simulated.error, simulated.predicted
            )),
            Some(simulated) if simulated.outbursts => warnings.push(
                "rare outbursts dominate the cost: a simulation has too few of them, and a typical run costs less"
                    .into(),
            ),
            None if self.growth < 0.0 && self.unstable_motions.is_empty() => warnings.push(
                "the loop was not simulated because it decays too slowly: the results follow from theory alone".into(),
            ),
            _ => {}
        }
        let worst = self.deadline_misses.as_ref().and_then(|misses| misses.worst_case.as_ref());
        if worst.is_some_and(|worst| worst.stated.verdict == "undecided") {
            warnings.push(
                "the bounds of the worst sequence of missed deadlines do not tell whether the loop is stable".into(),
            );
        }
        let fastest = self.plant_modes.iter().map(|mode| mode.frequency).fold(0.0, f64::max);
        let turn = core::f64::consts::TAU * fastest * self.period;
        if turn > 1.0 {
            warnings.push(format!(
                "the fastest oscillation of the plant turns by {turn:.2} rad per period: the loop samples it sparsely"
            ));
        }
        warnings
    }
}
