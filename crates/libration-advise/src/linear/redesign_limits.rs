//! Limits of each imperfection while all others are as stated.

use libration::linear::LinearLoopError;
use libration_report::notation::{cut_off, cut_up};
use libration_work::Work;
use serde::Serialize;

use super::request::LinearRequest;
use crate::AdviseError;
use crate::imperfection::Imperfection;
use crate::loops::LoopError;
use crate::subject::Subject;
use crate::summary::{ANY_PROBABILITY, is_any_probability};
use crate::timed_loop::{StatedTiming, TimedLoop};

/// The sizes of an imperfection with which a loop is stable while all other imperfections are as stated.
#[derive(Clone, Debug, Serialize)]
pub struct RedesignLimit {
    /// The imperfection.
    pub kind: Imperfection,
    /// The input or output; none for all, or the only one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub channel: Option<String>,
    /// The unit of its sizes.
    pub unit: &'static str,
    /// The stated size.
    pub stated: f64,
    /// With the given controller; none if it is unstable with the stated size.
    pub given: Option<StableRange>,
    /// With the redesigned controller; none if it is unstable with the stated size.
    pub redesigned: Option<StableRange>,
}

/// The sizes around the stated one with which a loop is stable.
///
/// Sizes are tried away from the stated one in growing steps, and the first unstable one is narrowed down: narrower windows of
/// instability may be missed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StableRange {
    /// The smallest; none if no limit was found down to zero, or of a clock down to a tenth of the period.
    pub from: Option<f64>,
    /// The largest; none if no limit was found.
    pub to: Option<f64>,
    /// The largest tried size.
    pub tried_up_to: f64,
}

impl RedesignLimit {
    /// The imperfection with its channel, in words.
    pub fn name(&self) -> String {
        crate::budget::with_channel(self.kind, self.channel.as_deref())
    }

    /// A range of its sizes in words; `unstable` for none.
    pub fn in_words(&self, range: Option<StableRange>) -> String {
        match range {
            None => "unstable".to_owned(),
            Some(StableRange { from, to: None, tried_up_to })
                if is_any_probability(self.kind, tried_up_to) =>
            {
                from.map_or_else(
                    || ANY_PROBABILITY.to_owned(),
                    |from| format!("{} to 1", cut_up(from, 4)),
                )
            }
            Some(range) => range.in_words(),
        }
    }
}

impl StableRange {
    /// The range in words, not beyond itself.
    fn in_words(&self) -> String {
        let [from, to] = [self.from.map(|x| cut_up(x, 4)), self.to.map(|x| cut_off(x, 4))];
        match (from, to) {
            (None, Some(to)) => format!("up to {to}"),
            (None, None) => format!("above {}", self.tried_up_to),
            (Some(from), Some(to)) => format!("{from} to {to}"),
            (Some(from), None) => format!("{from} to above {}", self.tried_up_to),
        }
    }
}

/// Growth of the steps in which sizes are tried.
const GROWTH: f64 = 1.25;

/// Steps of the longest length that fill the range of an imperfection.
const TRIED: f64 = 64.0;

/// Largest latency beyond the stated one that is tried, in periods.
const MOST_PERIODS: f64 = 40.0;

/// Number of bisections: to a millionth of the last step.
const HALVINGS: u32 = 20;

impl LinearRequest {
    /// The limits with the given controller and with another one.
    pub(super) fn redesign_limits(
        &self,
        work: &Work<'_>,
        after: &TimedLoop,
    ) -> Result<Vec<RedesignLimit>, AdviseError> {
        // Others as stated: a latency of all channels would be that of none.
        let mut subjects = self.timed.subjects(true);
        subjects.retain(|subject| !self.timed.is_joint(*subject));
        work.sweep("limits of the redesign", &subjects, |&subject| {
            let range = |timed: &TimedLoop| timed.stable_range(subject).map_err(LoopError::from);
            let plant = self.timed.linear.plant();
            let signals = match subject.kind {
                Imperfection::OutputLatency => &plant.outputs,
                _ => &plant.inputs,
            };
            Ok::<_, AdviseError>(RedesignLimit {
                kind: subject.kind,
                channel: subject.channel.map(|i| signals[i].name.clone()),
                unit: match subject.kind {
                    Imperfection::Latency | Imperfection::OutputLatency => "s",
                    Imperfection::Jitter => "relative rms",
                    Imperfection::Skew => "part of a period",
                    Imperfection::Loss => "probability",
                },
                stated: self.timed.stated_size(subject),
                given: range(&self.timed)?,
                redesigned: range(after)?,
            })
        })
    }
}

impl TimedLoop {
    /// The sizes of an imperfection around the stated one with which the loop is stable while all others are as stated.
    fn stable_range(&self, subject: Subject) -> Result<Option<StableRange>, LinearLoopError> {
        let stated = self.stated_size(subject);
        if !self.is_stable_at(subject, stated)? {
            return Ok(None);
        }
        let ([step, longest], least, most) = match subject.kind {
            Imperfection::Latency | Imperfection::OutputLatency => {
                let period = self.period();
                ([0.05 * period, period], 0.0, stated + MOST_PERIODS * period)
            }
            Imperfection::Jitter => ([0.005, 1.0 / TRIED], 0.0, stated.max(1.0)),
            Imperfection::Skew => ([0.005, 8.0 / TRIED], -0.9, 8.0),
            Imperfection::Loss => ([0.005, 1.0 / TRIED], 0.0, 1.0 - 1e-9),
        };
        let (from, begins) = self.range_end(subject, stated, [-step, -longest], least)?;
        let (to, ends) = self.range_end(subject, stated, [step, longest], most)?;
        Ok(Some(StableRange {
            from: begins.then_some(from),
            to: ends.then_some(to),
            tried_up_to: to,
        }))
    }

    /// The last stable size from a stable one towards `end`, and whether the loop is unstable beyond. Steps grow from the first to the
    /// longest.
    fn range_end(
        &self,
        subject: Subject,
        from: f64,
        [step, longest]: [f64; 2],
        end: f64,
    ) -> Result<(f64, bool), LinearLoopError> {
        // Latencies of a sampled plant are whole periods.
        let whole = subject.is_latency() && self.is_sampled();
        let mut step = if whole { self.period().copysign(step) } else { step };
        let mut stable = from;
        while stable != end {
            let next = stable + step;
            let next = if (next - end) * step >= 0.0 { end } else { next };
            match self.is_stable_at(subject, next) {
                Ok(true) => stable = next,
                Ok(false) => {
                    let mut unstable = next;
                    for _ in 0..if whole { 0 } else { HALVINGS } {
                        let middle = 0.5 * (stable + unstable);
                        match self.is_stable_at(subject, middle)? {
                            true => stable = middle,
                            false => unstable = middle,
                        }
                    }
                    return Ok((stable, true));
                }
                // The rest is too large to analyse.
                Err(
                    LinearLoopError::Size { .. }
                    | LinearLoopError::Turn
                    | LinearLoopError::Latency { .. },
                ) => return Ok((stable, false)),
                Err(error) => return Err(error),
            }
            if !whole {
                step = if (GROWTH * step).abs() < longest.abs() { GROWTH * step } else { longest };
            }
        }
        Ok((stable, false))
    }

    /// Whether the loop is stable with an imperfection of this size, in its unit, and all others as stated.
    fn is_stable_at(&self, subject: Subject, size: f64) -> Result<bool, LinearLoopError> {
        let mut timing = StatedTiming { record: None, ..self.timing.clone() };
        let delay = |channels: &mut Vec<f64>| match subject.channel {
            Some(i) => channels[i] = size,
            None => channels.fill(size),
        };
        match subject.kind {
            Imperfection::Latency => delay(&mut timing.input_latency),
            Imperfection::OutputLatency => delay(&mut timing.output_latency),
            Imperfection::Jitter => timing.jitter = timing.jitter.with_rms(size),
            Imperfection::Skew => timing.skew = size,
            Imperfection::Loss => timing.loss = size,
        }
        let changed = TimedLoop { timing, ..self.clone() }.stated()?;
        // The record, if there is one, is stretched to the rms.
        self.decays(&changed)
    }
}
