//! Budgets of the imperfections of a loop.

use libration::linear::{LatencyWindow, LinearLoopError, LoopMode, LoopTiming};
use libration_work::Work;
use serde::Serialize;

use super::AdviseError;
use super::imperfection::Imperfection;
use super::limit_text::{beyond_tried, rounded_down};
use super::limits::Limit;
use super::loops::LoopError;
use super::motion::describe_motion;
use super::request::Tolerance;
use super::stabilising_changes::NEUTRAL;
use super::stability_window::StabilityWindow;
use super::subject::Subject;
use super::timed_loop::TimedLoop;
use super::used_share::share_in_percent;

/// The budget of one imperfection: the sizes with which the loop is stable without others.
#[derive(Clone, Debug, Serialize)]
pub struct Budget {
    /// The imperfection.
    pub kind: Imperfection,
    /// The input or output, `all inputs` or `all outputs`; none for the only one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub channel: Option<String>,
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
    /// The windows of a latency beyond the first limit in which the loop is stable as well, up to the largest tried latency.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub later_windows: Vec<StabilityWindow>,
    /// The angle in rad per period by which the loop turns at its limit of a latency; none without oscillation.
    #[serde(skip)]
    pub crossing_angle: Option<f64>,
    /// The method of the result.
    pub how: &'static str,
    /// A command that reproduces it.
    pub command: String,
}

impl Budget {
    /// The imperfection with its channel, in words.
    pub fn name(&self) -> String {
        with_channel(self.kind, self.channel.as_deref())
    }

    /// A limit in words: the size, or the largest tried one.
    pub fn limit(&self, limit: Option<f64>) -> String {
        match limit {
            Some(limit) => rounded_down(limit),
            None if self.tried_up_to == 0.0 => "too many states".to_owned(),
            None => beyond_tried(self.tried_up_to),
        }
    }

    /// The used part in words.
    pub fn used_in_percent(&self) -> String {
        match (self.used, self.regained) {
            (_, Some(_)) => "regained".to_owned(),
            (Some(used), None) => share_in_percent(used),
            (None, None) => String::new(),
        }
    }
}

/// The windows that do not begin at zero, in the unit of a budget.
fn later_windows(windows: Option<&[LatencyWindow]>, scale: f64) -> Vec<StabilityWindow> {
    let later = windows.unwrap_or_default().iter().filter(|window| window.from > 0.0);
    later.map(|w| StabilityWindow { from: scale * w.from, to: w.to.map(|to| scale * to) }).collect()
}

/// A number with six decimals, or with four digits where six decimals show fewer than three.
pub fn rounded(x: f64) -> String {
    if x == 0.0 || x.abs() >= 1e-4 { format!("{x:.6}") } else { format!("{x:.3e}") }
}

/// An imperfection with its channel, in words.
pub(super) fn with_channel(kind: Imperfection, channel: Option<&str>) -> String {
    match channel {
        Some(channel) => format!("{} of {channel}", kind.name()),
        None => kind.name().to_owned(),
    }
}

/// The imperfection that fails first.
#[derive(Clone, Debug, Serialize)]
pub struct FirstFailure {
    /// The imperfection.
    pub kind: Imperfection,
    /// The input or output; none for all, or the only one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub channel: Option<String>,
    /// The used part of its budget.
    pub used: f64,
    /// The frequency of oscillation at the limit, in Hz; none without oscillation, or if it is unknown.
    pub frequency: Option<f64>,
    /// The states that move most at the limit, with their sizes relative to the largest.
    pub states: Vec<(String, f64)>,
    /// The failure in words.
    pub how: String,
}

impl TimedLoop {
    /// The motions that do not decay without imperfections, in words; none if the loop is stable.
    pub(super) fn unstable_modes(&self) -> Result<Option<Vec<String>>, LinearLoopError> {
        let none = self.ideal();
        let is_stable = match self.names_states {
            true => self.stability(&none)?.is_stable(),
            false => self.linear.is_stable(&none)?,
        };
        if is_stable {
            return Ok(None);
        }
        let mut modes = self.linear.modes(&none, usize::MAX)?;
        // At least one, which may be unstable by less than rounding.
        let growing = modes.iter().filter(|mode| mode.radius >= 1.0).count();
        modes.truncate(growing.max(1));
        let describe = |mode: &LoopMode| {
            let how = describe_motion(mode.angle, self.period()).1;
            let names: Vec<&str> = mode.states.iter().map(|(name, _)| name.as_str()).collect();
            let shape = match self.names_states && !names.is_empty() {
                true => format!(", most in {}", names.join(", ")),
                false => String::new(),
            };
            match mode.radius - 1.0 {
                neutral if neutral < NEUTRAL && self.names_states => {
                    format!("a motion changes by less than 10⁻¹¹ per period{shape}")
                }
                neutral if neutral < NEUTRAL => format!("a motion neither grows nor decays{shape}"),
                small if small < 1e-3 => {
                    format!(
                        "a motion grows by the factor 1 + {small:.2e} per period ({how}{shape})"
                    )
                }
                _ => {
                    let radius = mode.radius;
                    format!("a motion grows by the factor {radius:.6} per period ({how}{shape})")
                }
            }
        };
        Ok(Some(modes.iter().map(describe).collect()))
    }

    /// The budget of each subject. `command` is the command that analyses the loop with a timing.
    pub(super) fn budgets(
        &self,
        work: &Work<'_>,
        subjects: &[Subject],
        tolerance: Tolerance,
        command: &(impl Fn(&LoopTiming) -> String + Sync),
    ) -> Result<Vec<Budget>, AdviseError> {
        work.sweep("budgets of the loop", subjects, |&subject| {
            let budget = self.budget(subject, tolerance, command);
            budget.map_err(|error| LoopError::from(error).into())
        })
    }

    fn budget(
        &self,
        subject: Subject,
        tolerance: Tolerance,
        command: &impl Fn(&LoopTiming) -> String,
    ) -> Result<Budget, LinearLoopError> {
        let stated = self.stated_size(subject);
        let (unit, scale) = match subject.kind {
            Imperfection::Latency | Imperfection::OutputLatency => ("s", self.period()),
            Imperfection::Jitter => ("relative rms", 1.0),
            Imperfection::Skew => ("part of a period", self.side()),
            Imperfection::Loss => ("probability", 1.0),
        };
        let end = |limit: Limit| match limit {
            Limit::None => (Some(0.0), 0.0),
            Limit::Value(size) => (Some(scale * size), scale * size),
            Limit::Beyond(size) => (None, scale * size),
        };
        let channels = self.searched_channels(subject);
        let windows = match &channels {
            Some(channels) => self.latency_windows(subject, channels)?,
            None => None,
        };
        let search_ended = channels.is_some() && windows.is_none();
        let (stable, tried) = end(self.stable_up_to(subject, windows.as_deref())?);
        let tolerated = self.tolerated_up_to(subject, tolerance)?.map(|limit| end(limit).0);
        let smaller = |a: f64, b: f64| if a.abs() < b.abs() { a } else { b };
        let limit = [stable, tolerated.flatten()].into_iter().flatten().reduce(smaller);
        let regained = match limit {
            Some(first) => {
                let sizes = [first, stated].map(|size| size / scale);
                self.stability_window(subject, sizes, tolerance, windows.as_deref())?
            }
            None => None,
        };
        let regained = regained.map(|StabilityWindow { from, to }| StabilityWindow {
            from: scale * from,
            to: to.map(|to| scale * to),
        });
        let crossing = match (&windows, stable) {
            (Some(windows), _) => windows.first().and_then(|window| window.angle),
            (None, Some(limit)) if subject.is_latency() && limit > 0.0 => {
                Some(self.slowest_mode(&self.single(subject, limit / scale)?)?.angle)
            }
            _ => None,
        };
        Ok(Budget {
            kind: subject.kind,
            channel: self.channel_name(subject),
            unit,
            stated,
            stable_up_to: stable,
            tolerated_up_to: tolerated,
            tried_up_to: tried,
            used: limit
                .filter(|&limit| limit != 0.0 && regained.is_none())
                .map(|limit| stated / limit),
            regained,
            later_windows: later_windows(windows.as_deref(), scale),
            crossing_angle: crossing.filter(|angle| *angle > 0.0),
            how: self.method_of(subject, search_ended),
            command: command(&self.single(subject, limit.unwrap_or(tried) / scale)?),
        })
    }

    /// The name of a channel, or of all; none for the only one.
    fn channel_name(&self, subject: Subject) -> Option<String> {
        let plant = self.linear.plant();
        let (signals, all) = match subject.kind {
            Imperfection::OutputLatency => (&plant.outputs, "all outputs"),
            _ => (&plant.inputs, "all inputs"),
        };
        match subject.channel {
            Some(i) => Some(signals[i].name.clone()),
            None => (subject.is_latency() && signals.len() > 1).then(|| all.to_owned()),
        }
    }

    /// The imperfection that uses most of its budget.
    pub(super) fn fails_first(
        &self,
        subjects: &[Subject],
        budgets: &[Budget],
    ) -> Result<Option<FirstFailure>, LinearLoopError> {
        let used = |(_, budget): &(_, &Budget)| budget.used.is_some_and(|used| used > 0.0);
        let share = |budget: &Budget| budget.used.unwrap_or(0.0);
        let all = subjects.iter().zip(budgets).filter(used);
        let most = all.max_by(|(_, a), (_, b)| share(a).total_cmp(&share(b)));
        let Some((&subject, first)) = most else { return Ok(None) };
        let period = self.period();
        // A budget that the cost limits ends before the loop grows.
        let cost_limit = first.tolerated_up_to.flatten();
        let grows = first
            .stable_up_to
            .filter(|limit| cost_limit.is_none_or(|cost_limit| limit.abs() <= cost_limit.abs()));
        let mut states = Vec::new();
        let (frequency, how) = match (first.kind, grows) {
            (
                Imperfection::Latency | Imperfection::OutputLatency | Imperfection::Skew,
                Some(limit),
            ) => {
                let size = if first.kind == Imperfection::Skew { limit } else { limit / period };
                let at = self.single(subject, size)?;
                let mode = self.slowest_mode(&at)?;
                states = mode.states;
                let longer = 1.0 + at.skew;
                let (frequency, how) = describe_motion(mode.angle, period * longer);
                (frequency, format!("at its limit {how}"))
            }
            (Imperfection::Jitter, Some(_)) if self.timing.record.is_some() => {
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
        let (kind, channel, used) = (first.kind, first.channel.clone(), share(first));
        Ok(Some(FirstFailure { kind, channel, used, frequency, states, how }))
    }
}
