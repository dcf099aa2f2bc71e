//! The verdict on measured gains and the answer, in sentences.

use libration_report::notation::{cut_off, number, plural};
use libration_report::verdict::{Outcome, Verdict};

use super::gain_search::FAR;
use super::measured::{MeasuredGains, ServoRow};
use super::{GainReport, ServoIntegrator};

/// Growth per step that errors may hide without a doubt about the verdict.
const DOUBTFUL: f64 = 9e-5;

impl MeasuredGains {
    /// The verdict of the measured step.
    pub(super) fn verdict(&self) -> Verdict {
        let radius = number(self.spectral_radius, 7);
        let point = self.operating_point.as_ref();
        let verdict = if !self.is_differentiable {
            Verdict::unknown(format!(
                "the step has no derivative at this point (relative error {})",
                number(self.error, 2)
            ))
        } else if let Some(point) = point.filter(|point| point.is_far()) {
            Verdict::unknown(format!("the equilibrium that was found is {}", point.distance()))
        } else if self.grows && (self.equilibrium.holds || self.unstable_without_servos.is_some()) {
            Verdict::new(
                Outcome::Unstable,
                format!("spectral radius {radius} of the measured step"),
            )
        } else if let Some(point) = point.filter(|point| !point.run.stands) {
            Verdict::unknown(format!("the equilibrium is {}{}", point.distance(), point.remedy()))
        } else if self.grows {
            Verdict::new(
                Outcome::Unstable,
                format!("a fast mode of deviations from the motion grows by {radius} per step"),
            )
        } else if !self.equilibrium.holds {
            Verdict::unknown(format!(
                "the point is no equilibrium: `{}` changes by {} per step; the largest factor of deviations from the motion is {radius}",
                self.equilibrium.state,
                number(self.equilibrium.change, 3)
            ))
        } else if self.hidden_growth > DOUBTFUL && self.spectral_radius > 1.0 + 1e-7 {
            Verdict::unknown(format!(
                "errors of the measured step may hide a growth of {} per step; spectral radius {radius}",
                number(self.hidden_growth, 1)
            ))
        } else if let Some(mode) = self.doubtful_growth() {
            Verdict::unknown(format!(
                "a mode ({}) grows at {} 1/s, and errors of the measured step may hide as much",
                mode.names(),
                number(mode.step.growth_rate, 3)
            ))
        } else if let Some(servo) = self.negative_gain.as_ref().filter(|_| self.neutral_modes > 0) {
            Verdict::unknown(format!(
                "kp of {servo} is negative, and a mode is neutral within errors, which may hide a growth of {} 1/s",
                number(self.hidden_growth_rate, 1)
            ))
        } else if self.neutral_modes > 0 {
            Verdict::new(Outcome::Stable, format!("spectral radius {radius} of the measured step"))
                .without(format!(
                    "growth of neutral modes below {} 1/s",
                    number(self.hidden_growth_rate, 1)
                ))
        } else {
            Verdict::new(Outcome::Stable, format!("spectral radius {radius} of the measured step"))
        };
        let verdict = match &self.negative_gain {
            Some(servo) => verdict.without(format!("how far the negative kp of {servo} may fall")),
            None => verdict,
        };
        match &self.not_searched[..] {
            [] => verdict,
            some => verdict.without(format!("limits of the gains of {}", some.join(", "))),
        }
    }

    /// The answer in a few sentences.
    pub(super) fn summary(&self, report: &GainReport) -> String {
        let (integrator, of) = (ServoIntegrator::label(report.integrator), report.steps());
        let verdict = &report.verdict;
        let mut sentences = Vec::new();
        let point = self.operating_point.as_ref();
        sentences.push(match verdict.outcome {
            Outcome::Unknown => {
                format!("Whether the gains hold is unknown: {}.", verdict.evidence)
            }
            Outcome::Unstable if report.growth_in_continuous_time.is_some() => format!(
                "The motion is unstable in the system itself, whatever the step: a mode grows at {} 1/s ({}).{}",
                number(report.growth_in_continuous_time.unwrap_or(0.0), 5),
                self.leading(),
                report.window()
            ),
            Outcome::Unstable if self.unstable_without_servos.is_some() || !self.has_servos() => {
                self.unstable_by_itself(report)
            }
            Outcome::Unstable => format!(
                "The gains do not hold with {integrator} and {of}: a mode of the measured step grows by a factor {} per step ({}){}",
                number(self.spectral_radius, 6),
                self.leading(),
                report.factor()
            ),
            _ => format!(
                "The gains hold with {integrator} and {of}: the largest factor of a mode of the measured step is {}{}",
                number(self.spectral_radius, 7),
                report.factor()
            ),
        });
        sentences.extend(report.others.sentences(verdict.outcome == Outcome::Unknown));
        if let Some(point) = point.filter(|_| verdict.outcome != Outcome::Unknown) {
            if let Some(sentence) = point.sentence() {
                sentences.insert(0, sentence);
            }
            if !point.run.stands {
                sentences.push(format!("The request does not hold{}.", point.remedy()));
            }
        }
        if self.is_differentiable {
            sentences.extend(self.tightest());
            if self.grows && report.growth_in_continuous_time.is_none() {
                sentences.push(self.substeps_in_words(report));
            }
        }
        if !self.equilibrium.holds {
            sentences.push(
                "At a point that is no equilibrium only fast modes count; `--settle` (Python: state=\"settled\") searches for the equilibrium near it.".into(),
            );
        }
        if self.neutral_modes > 0 && self.is_differentiable && report.saturated.is_empty() {
            sentences.push(format!(
                "{} neutral within errors, as those of a free base, or of joints without damping or stiffness.",
                match self.neutral_modes {
                    1 => "1 mode is".to_owned(),
                    several => format!("{} are", plural(several, "mode")),
                }
            ));
        }
        let limits = verdict.limits();
        if !limits.is_empty() {
            sentences.push(limits);
        }
        sentences.retain(|sentence| !sentence.is_empty());
        sentences.join(" ")
    }

    /// The sentence about a step that is unstable without gains of servos.
    fn unstable_by_itself(&self, report: &GainReport) -> String {
        let without = match (report.others.remaining(), self.has_servos()) {
            (None, _) => "without any servo".to_owned(),
            (Some(names), true) => {
                format!("without gains of the servos, with other actuators as they are ({names})")
            }
            (Some(names), false) => format!("with its actuators as they are ({names})"),
        };
        let radius = number(self.spectral_radius, 6);
        let growth = match self.unstable_without_servos.filter(|_| self.has_servos()) {
            Some(passive) => format!(
                "without gains a mode grows by a factor {} per step, with them by {radius}",
                number(passive, 6)
            ),
            None => format!("a mode grows by a factor {radius} per step"),
        };
        format!(
            "The step is unstable {without}, with {} and {}: {growth} ({}).",
            ServoIntegrator::label(report.integrator),
            report.steps(),
            self.leading()
        )
    }

    /// The fewest substeps, as a sentence.
    fn substeps_in_words(&self, report: &GainReport) -> String {
        match report.fewest_substeps {
            Some(substeps) if !self.has_servos() => {
                format!("With {} no mode grows.", plural(substeps as usize, "substep"))
            }
            None if !self.has_servos() => String::new(),
            _ => report.substeps_in_words().trim().to_owned(),
        }
    }

    /// The states of the mode that grows fastest.
    fn leading(&self) -> String {
        let largest = self.modes.iter().max_by(|a, b| a.radius.total_cmp(&b.radius));
        largest.map_or_else(String::new, |mode| mode.names())
    }

    /// The gains with the least margin, in sentences.
    fn tightest(&self) -> Vec<String> {
        let mut found = Vec::new();
        type Gain = fn(&ServoRow) -> (f64, f64);
        let gains: [(&str, Gain); 2] = [
            ("kp", |servo| (servo.largest_kp, servo.kp)),
            ("kv", |servo| (servo.largest_kv, servo.kv)),
        ];
        for (name, gain) in gains {
            let limited = self.servos.iter().filter(|servo| {
                let (largest, given) = gain(servo);
                largest.is_finite() && largest > 0.0 && (given > 0.0 || name == "kv")
            });
            let margin = |servo: &ServoRow| gain(servo).0 / gain(servo).1.max(1e-300);
            let tightest = limited.min_by(|a, b| margin(a).total_cmp(&margin(b)));
            if let Some(servo) = tightest {
                let (largest, given) = gain(servo);
                let of = match name == "kp" && self.negative_gain.is_some() {
                    true => "positive kp",
                    false => name,
                };
                found.push(format!(
                    "The least margin of {of} has {}: at most {}, given {}, with all others as they are.",
                    servo.name,
                    number(cut_off(largest, 5), 5),
                    number(given, 5)
                ));
            } else if name == "kp" && self.servos.iter().any(|servo| servo.kp > 0.0) && !self.grows
            {
                found.push(format!(
                    "No limit of {name} was found up to {} times the given ones.",
                    number(FAR, 4)
                ));
            }
        }
        found
    }
}
