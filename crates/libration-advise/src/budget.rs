//! What a loop stands of each imperfection alone, and which fails first.

use libration::Model;
use libration::analysis::{CostError, Imperfections, Mode};
use libration::control::{Feedback, Jitter, Latency};
use libration_work::Work;
use serde::Serialize;

use super::control::{Control, Law};
use super::limits::{Kind, Limit};
use super::loops::{Loop, LoopError};
use super::regained::Regained;
use super::remedies::{NEUTRAL, rounded_down};
use super::request::Request;
use super::words::swings;
use super::{AdviseError, TURN};

/// What a loop stands of an imperfection alone.
#[derive(Clone, Debug, Serialize)]
pub struct Budget {
    /// Which.
    pub kind: Kind,
    /// The unit of its sizes.
    pub unit: &'static str,
    /// How much of it is stated; of a clock that is fast a negative number, as its limits are.
    pub stated: f64,
    /// Up to here the loop is stable; none where no end was found.
    pub stable_up_to: Option<f64>,
    /// Up to here the cost is tolerated, if a cost is; none where no end was found.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tolerated_up_to: Option<Option<f64>>,
    /// The largest that was tried.
    pub tried_up_to: f64,
    /// What is stated over the smaller of the two limits; none without one, and none in a window that is regained.
    pub used: Option<f64>,
    /// The window beyond that limit in which what is stated lies, and the loop is stable again.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub regained: Option<Regained>,
    /// How it was obtained.
    pub how: &'static str,
    /// A command that shows it.
    pub command: String,
}

/// What fails first, and how that looks.
#[derive(Clone, Debug, Serialize)]
pub struct Failing {
    /// Which.
    pub kind: Kind,
    /// The part of its budget that is used.
    pub used: f64,
    /// With which frequency the loop swings at the limit, in Hz; none where it does not, or where nothing is told of it.
    pub frequency: Option<f64>,
    /// In words.
    pub how: String,
}

impl<M: Model<1>> Loop<M> {
    /// Fails where nothing can be advised, before any work.
    pub(super) fn check(&self) -> Result<(), AdviseError> {
        self.check_period()?;
        let (plant, none) = (self.plant(), Imperfections::NONE);
        let stated = self.stated()?;
        if let Err(error) = self.decays(&plant, &stated) {
            // What is too large with jitter or losses may be told of without.
            let late = Imperfections { latency: stated.latency, ..none };
            if plant.mean_square_stable(&self.linear, &late) == Ok(false) {
                return Err(AdviseError::Late(self.control.latency));
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
            // By less than a rounding.
            modes.push(plant.slowest_mode(&self.linear, &none).map_err(LoopError::from)?);
        }
        let told = |mode: &Mode| {
            let how = swings(mode.angle, self.control.period).1;
            match mode.radius - 1.0 {
                neutral if neutral < NEUTRAL => "a motion neither grows nor decays".into(),
                small if small < 1e-3 => {
                    format!("a motion grows by the factor 1 + {small:.2e} a period ({how})")
                }
                _ => format!("a motion grows by the factor {:.6} a period ({how})", mode.radius),
            }
        };
        let modes = modes.iter().map(told).collect();
        let gains = [self.units.gains[0], self.units.gains[1]];
        if self.settles(&plant, &stated) {
            let remedies = self.remedies(&plant, &none).sentence(gains);
            let help = format!(
                "with what is stated it is stable, in a window that less latency leaves: do not rely on it. Without the latency: {remedies}"
            );
            return Err(AdviseError::Unstable { modes, help });
        }
        let remedies = self.remedies(&plant, &stated);
        let shorter = self.stable_period().map_or_else(String::new, |period| {
            format!(" It is stable with a period of {} s.", rounded_down(period))
        });
        let help = format!("{}{shorter}", remedies.sentence(gains));
        Err(AdviseError::Unstable { modes, help })
    }

    /// Fails where the period is far too short or too long for the motions of the loop.
    fn check_period(&self) -> Result<(), AdviseError> {
        let Feedback { position, velocity } = self.gains();
        let plant = self.plant().rate();
        let fastest = plant.max(position.abs().sqrt()).max(velocity.abs());
        if fastest == 0.0 {
            // Nothing turns, whatever the period.
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
        work.sweep("what the loop stands", &Kind::ALL, |&kind| self.budget(kind, request))
    }

    fn budget(&self, kind: Kind, request: &Request) -> Result<Budget, AdviseError> {
        let plant = self.plant();
        let Control { period, latency, jitter, skew, loss, .. } = self.control;
        let (unit, scale, stated) = match kind {
            Kind::Latency => ("s", period, latency),
            Kind::Jitter => ("relative rms", 1.0, jitter.rms()),
            Kind::Skew => ("part of a period", 1.0_f64.copysign(skew), skew),
            Kind::Loss => ("probability", 1.0, loss),
        };
        let end = |limit: Limit| match limit {
            Limit::None => (Some(0.0), 0.0),
            Limit::At(size) => (Some(scale * size), scale * size),
            Limit::Beyond(size) => (None, scale * size),
        };
        let (stable, tried) = end(self.stable_up_to(&plant, kind)?);
        let tolerated =
            self.cheap_up_to(&plant, kind, request.tolerance)?.map(|limit| end(limit).0);
        let smaller = |a: f64, b: f64| if a.abs() < b.abs() { a } else { b };
        let limit = [stable, tolerated.flatten()].into_iter().flatten().reduce(smaller);
        let regained = match limit {
            Some(first) => {
                let sizes = [first, stated].map(|size| size / scale);
                self.regained(&plant, kind, sizes, request.tolerance)?
            }
            None => None,
        };
        let regained = regained.map(|Regained { from, to }| Regained {
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
                Kind::Latency | Kind::Skew => "exact: the spectral radius passes 1",
                Kind::Jitter if self.control.record.is_some() => {
                    "exact: growth through the stretched record"
                }
                Kind::Jitter | Kind::Loss => "exact: second moments grow",
            },
            command: self.command(&self.only(kind, limit.unwrap_or(tried) / scale)?, request),
        })
    }

    /// A command that shows the loop with `imperfections`.
    pub(super) fn command(&self, imperfections: &Imperfections, request: &Request) -> String {
        let gains = match self.control.law {
            _ if self.control.record.is_some() && imperfections.jitter.rms() > 0.0 => {
                return format!("{} --json", request.asked_by);
            }
            Law::Pd(_) | Law::Lqr(_) if M::LINEAR => self.given_gains(),
            // No other command takes a controller that remembers, or exact steps of what is linearised.
            _ => return self.asked_again(imperfections, request),
        };
        let Imperfections { latency, jitter, skew, loss } = *imperfections;
        // Commands are late by parts of steps, which the clock makes longer.
        let latency = match (latency == Latency::NONE, skew == 0.0) {
            (true, _) => String::new(),
            (_, true) => format!(" --latency {}", latency.steps() * self.control.period),
            (_, false) => format!(" --latency {}steps", latency.steps()),
        };
        let jitter = match jitter.rms() {
            0.0 => String::new(),
            _ => format!(" --jitter {}", flag(jitter)),
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

    /// The command that asked, for the loop with `imperfections`.
    fn asked_again(&self, imperfections: &Imperfections, request: &Request) -> String {
        // A flag cannot take back a record.
        if self.control.record.is_some() || request.asked_by.contains("--jitter-file") {
            return format!("{} --json", request.asked_by);
        }
        let Imperfections { latency, jitter, skew, loss } = *imperfections;
        let law = flag(jitter);
        let seconds = latency.steps() * self.control.period * (1.0 + skew);
        format!(
            "{} --latency {seconds} --jitter {law} --skew {skew} --loss {loss} --json",
            request.asked_by
        )
    }

    pub(super) fn fails_first(&self, budgets: &[Budget]) -> Result<Option<Failing>, AdviseError> {
        let used = |budget: &&Budget| budget.used.is_some_and(|used| used > 0.0);
        let most =
            |a: &&Budget, b: &&Budget| a.used.unwrap_or(0.0).total_cmp(&b.used.unwrap_or(0.0));
        let Some(first) = budgets.iter().filter(used).max_by(most) else { return Ok(None) };
        let period = self.control.period;
        // Where the cost ends a budget, nothing grows there yet.
        let dear = first.tolerated_up_to.flatten();
        let grows =
            first.stable_up_to.filter(|limit| dear.is_none_or(|dear| limit.abs() <= dear.abs()));
        let (frequency, how) = match (first.kind, grows) {
            (Kind::Latency | Kind::Skew, Some(limit)) => {
                let size = if first.kind == Kind::Latency { limit / period } else { limit };
                let at = self.only(first.kind, size)?;
                let mode = self.plant().slowest_mode(&self.linear, &at).map_err(LoopError::from)?;
                let longer = 1.0 + at.skew;
                let (frequency, how) = swings(mode.angle, period * longer);
                (frequency, format!("at its limit {how}"))
            }
            (Kind::Jitter, Some(_)) if self.control.record.is_some() => {
                (None, "at its limit the loop grows as often as it goes through the record".to_owned())
            }
            (Kind::Jitter | Kind::Loss, Some(_)) => (
                None,
                "beyond its limit rare outbursts become so large that the mean square grows, while a typical run may still \
                 decay"
                    .to_owned(),
            ),
            _ => (None, "it costs too much before it becomes unstable".to_owned()),
        };
        let used = first.used.unwrap_or(0.0);
        Ok(Some(Failing { kind: first.kind, used, frequency, how }))
    }
}

/// A law of step times as flags take it.
fn flag(law: Jitter) -> String {
    match law {
        Jitter::Gaussian(rms) => format!("gaussian:{rms}"),
        Jitter::Uniform(rms) => format!("uniform:{rms}"),
    }
}
