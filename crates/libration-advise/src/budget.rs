//! Budgets of the imperfections of a loop.

use libration::analysis::{CostError, Imperfections, Mode};
use libration::control::{Feedback, Jitter, Latency};
use libration_work::Work;
use serde::Serialize;

use super::control::{Control, Law};
use super::limits::{Imperfection, Limit};
use super::loops::{Loop, LoopError, PlantModel};
use super::motion::describe_motion;
use super::request::Request;
use super::stabilising_changes::{NEUTRAL, rounded_down};
use super::stability_window::StabilityWindow;
use super::{AdviseError, TURN};

/// The budget of one imperfection: the sizes with which the loop is stable without others.
#[derive(Clone, Debug, Serialize)]
pub struct Budget {
    /// The imperfection.
    pub kind: Imperfection,
    /// The unit of its sizes.
    pub unit: &'static str,
    /// The stated size. For a fast clock it is negative, like the limits.
    pub stated: f64,
    /// The largest stable size; none if no limit was found.
    pub stable_up_to: Option<f64>,
    /// The largest size with a tolerated cost, for a tolerance of the cost; none if no limit was found.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tolerated_up_to: Option<Option<f64>>,
    /// The largest tried size.
    pub tried_up_to: f64,
    /// The stated size over the smaller of the two limits; none without a limit, and none in a separate stability window.
    pub used: Option<f64>,
    /// The separate stability window beyond the limit that contains the stated size.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub regained: Option<StabilityWindow>,
    /// The method of the result.
    pub how: &'static str,
    /// A command that reproduces it.
    pub command: String,
}

/// The imperfection that fails first.
#[derive(Clone, Debug, Serialize)]
pub struct FirstFailure {
    /// The imperfection.
    pub kind: Imperfection,
    /// The used part of its budget.
    pub used: f64,
    /// The frequency of oscillation at the limit, in Hz; none without oscillation, or if it is unknown.
    pub frequency: Option<f64>,
    /// The failure in words.
    pub how: String,
}

impl<M: PlantModel> Loop<M> {
    /// Fails if the loop is unstable without imperfections or its numbers are invalid, before any work.
    pub(super) fn check(&self) -> Result<(), AdviseError> {
        self.check_period()?;
        let (plant, none) = (self.plant(), Imperfections::NONE);
        let stated = self.stated()?;
        if let Err(error) = self.decays(&plant, &stated) {
            // A loop that is too large with jitter or losses may be analysed without them.
            let late = Imperfections { latency: stated.latency, ..none };
            if plant.mean_square_stable(&self.linear, &late) == Ok(false) {
                return Err(AdviseError::LatencyTooLong(self.control.latency));
            }
            if let CostError::Size { .. } = error {
                let (name, value) = ("loop.latency", self.control.latency);
                let allowed = "at most 290 periods, 90 with jitter or losses, and 20 with a record and losses";
                return Err(AdviseError::Value { name, value, allowed });
            }
            return Err(LoopError::from(error).into());
        }
        if plant.mean_square_stable(&self.linear, &none).map_err(LoopError::from)? {
            return Ok(());
        }
        let mut modes = plant.unstable_modes(&self.linear).map_err(LoopError::from)?;
        if modes.is_empty() {
            // Unstable by less than rounding.
            modes.push(plant.slowest_mode(&self.linear, &none).map_err(LoopError::from)?);
        }
        let describe = |mode: &Mode| {
            let how = describe_motion(mode.angle, self.control.period).1;
            match mode.radius - 1.0 {
                neutral if neutral < NEUTRAL => "a motion neither grows nor decays".into(),
                small if small < 1e-3 => {
                    format!("a motion grows by the factor 1 + {small:.2e} per period ({how})")
                }
                _ => format!("a motion grows by the factor {:.6} per period ({how})", mode.radius),
            }
        };
        let modes = modes.iter().map(describe).collect();
        let gains = [self.units.gains[0], self.units.gains[1]];
        if self.settles(&plant, &stated) {
            let remedies = self.stabilising_changes(&plant, &none).sentence(gains);
            let help = format!(
                "it is stable with the stated imperfections, but only in a stability window that less latency leaves: do not rely on it. Without the latency: {remedies}"
            );
            return Err(AdviseError::Unstable { modes, help });
        }
        let remedies = self.stabilising_changes(&plant, &stated);
        let shorter = self.stable_period().map_or_else(String::new, |period| {
            format!(" It is stable with a period of {} s.", rounded_down(period))
        });
        let help = format!("{}{shorter}", remedies.sentence(gains));
        Err(AdviseError::Unstable { modes, help })
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
        work.sweep("budgets of the loop", &Imperfection::ALL, |&kind| self.budget(kind, request))
    }

    fn budget(&self, kind: Imperfection, request: &Request) -> Result<Budget, AdviseError> {
        let plant = self.plant();
        let Control { period, latency, jitter, skew, loss, .. } = self.control;
        let (unit, scale, stated) = match kind {
            Imperfection::Latency => ("s", period, latency),
            Imperfection::Jitter => ("relative rms", 1.0, jitter.rms()),
            Imperfection::Skew => ("part of a period", 1.0_f64.copysign(skew), skew),
            Imperfection::Loss => ("probability", 1.0, loss),
        };
        let end = |limit: Limit| match limit {
            Limit::None => (Some(0.0), 0.0),
            Limit::Value(size) => (Some(scale * size), scale * size),
            Limit::Beyond(size) => (None, scale * size),
        };
        let (stable, tried) = end(self.stable_up_to(&plant, kind)?);
        let tolerated =
            self.tolerated_up_to(&plant, kind, request.tolerance)?.map(|limit| end(limit).0);
        let smaller = |a: f64, b: f64| if a.abs() < b.abs() { a } else { b };
        let limit = [stable, tolerated.flatten()].into_iter().flatten().reduce(smaller);
        let regained = match limit {
            Some(first) => {
                let sizes = [first, stated].map(|size| size / scale);
                self.stability_window(&plant, kind, sizes, request.tolerance)?
            }
            None => None,
        };
        let regained = regained.map(|StabilityWindow { from, to }| StabilityWindow {
            from: scale * from,
            to: to.map(|to| scale * to),
        });
        Ok(Budget {
            kind,
            unit,
            stated,
            stable_up_to: stable,
            tolerated_up_to: tolerated,
            tried_up_to: tried,
            used: limit
                .filter(|&limit| limit != 0.0 && regained.is_none())
                .map(|limit| stated / limit),
            regained,
            how: match kind {
                Imperfection::Latency | Imperfection::Skew => "exact: the spectral radius passes 1",
                Imperfection::Jitter if self.control.record.is_some() => {
                    "exact: growth through the stretched record"
                }
                Imperfection::Jitter | Imperfection::Loss => "exact: second moments grow",
            },
            command: self.command(&self.single(kind, limit.unwrap_or(tried) / scale)?, request),
        })
    }

    /// A command that analyses the loop with `imperfections`.
    pub(super) fn command(&self, imperfections: &Imperfections, request: &Request) -> String {
        let gains = match self.control.law {
            _ if self.control.record.is_some() && imperfections.jitter.rms() > 0.0 => {
                return format!("{} --json", request.invocation);
            }
            Law::Pd(_) | Law::Lqr(_) if M::LINEAR => self.given_gains(),
            // `analyze` takes neither controllers with memory nor exact steps of a linearisation.
            _ => return self.rerun_command(imperfections, request),
        };
        let Imperfections { latency, jitter, skew, loss } = *imperfections;
        // Latencies are parts of steps, which the clock stretches.
        let latency = match (latency == Latency::NONE, skew == 0.0) {
            (true, _) => String::new(),
            (_, true) => format!(" --latency {}", latency.steps() * self.control.period),
            (_, false) => format!(" --latency {}steps", latency.steps()),
        };
        let jitter = match jitter.rms() {
            0.0 => String::new(),
            _ => format!(" --jitter {}", law_flag(jitter)),
        };
        let loss = if loss == 0.0 { String::new() } else { format!(" --loss {loss}") };
        let weights = self.control.weights.map_or_else(String::new, |w| {
            format!(" --cost-weights {},{},{}", w.position, w.velocity, w.command)
        });
        format!(
            "libration analyze --system {}{} --q {} --integrator exact --dt {} --feedback {},{}{latency}{jitter}{loss}{weights}",
            request.system.name(),
            request.parameters(),
            request.q[0],
            self.control.period * (1.0 + skew),
            gains.position,
            gains.velocity
        )
    }

    /// The invocation, for the loop with `imperfections`.
    fn rerun_command(&self, imperfections: &Imperfections, request: &Request) -> String {
        // A flag cannot remove a record.
        if self.control.record.is_some() || request.invocation.contains("--jitter-file") {
            return format!("{} --json", request.invocation);
        }
        let Imperfections { latency, jitter, skew, loss } = *imperfections;
        let law = law_flag(jitter);
        let seconds = latency.steps() * self.control.period * (1.0 + skew);
        format!(
            "{} --latency {seconds} --jitter {law} --skew {skew} --loss {loss} --json",
            request.invocation
        )
    }

    pub(super) fn fails_first(
        &self,
        budgets: &[Budget],
    ) -> Result<Option<FirstFailure>, AdviseError> {
        let used = |budget: &&Budget| budget.used.is_some_and(|used| used > 0.0);
        let most =
            |a: &&Budget, b: &&Budget| a.used.unwrap_or(0.0).total_cmp(&b.used.unwrap_or(0.0));
        let Some(first) = budgets.iter().filter(used).max_by(most) else { return Ok(None) };
        let period = self.control.period;
        // A budget that the cost limits ends before the loop grows.
        let cost_limit = first.tolerated_up_to.flatten();
        let grows = first
            .stable_up_to
            .filter(|limit| cost_limit.is_none_or(|cost_limit| limit.abs() <= cost_limit.abs()));
        let (frequency, how) = match (first.kind, grows) {
            (Imperfection::Latency | Imperfection::Skew, Some(limit)) => {
                let size = if first.kind == Imperfection::Latency { limit / period } else { limit };
                let at = self.single(first.kind, size)?;
                let mode = self.plant().slowest_mode(&self.linear, &at).map_err(LoopError::from)?;
                let longer = 1.0 + at.skew;
                let (frequency, how) = describe_motion(mode.angle, period * longer);
                (frequency, format!("at its limit {how}"))
            }
            (Imperfection::Jitter, Some(_)) if self.control.record.is_some() => {
                (None, "at its limit the loop grows over each pass through the record".to_owned())
            }
            (Imperfection::Jitter | Imperfection::Loss, Some(_)) => (
                None,
                "beyond its limit rare outbursts become so large that the mean square grows, while a typical run may still \
                 decay"
                    .to_owned(),
            ),
            _ => (None, "its cost exceeds the tolerance before it becomes unstable".to_owned()),
        };
        let used = first.used.unwrap_or(0.0);
        Ok(Some(FirstFailure { kind: first.kind, used, frequency, how }))
    }
}

/// A law of step times in the syntax of flags.
fn law_flag(law: Jitter) -> String {
    match law {
        Jitter::Gaussian(rms) => format!("gaussian:{rms}"),
        Jitter::Uniform(rms) => format!("uniform:{rms}"),
    }
}
