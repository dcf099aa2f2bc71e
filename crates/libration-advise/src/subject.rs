//! Imperfections that have a budget, of one channel or of all.

use super::imperfection::Imperfection;
use super::timed_loop::{StatedTiming, TimedLoop};

/// An imperfection, of one channel or of all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Subject {
    pub(super) kind: Imperfection,
    /// The input or output; none for all.
    pub(super) channel: Option<usize>,
}

impl Subject {
    /// Whether it is a latency, whose sizes are in periods.
    pub(super) fn is_latency(self) -> bool {
        matches!(self.kind, Imperfection::Latency | Imperfection::OutputLatency)
    }
}

/// Most outputs whose latencies have a budget each.
const MOST_OUTPUTS: usize = 8;

impl TimedLoop {
    /// The imperfections that have a budget, with those of the outputs or without.
    pub(super) fn subjects(&self, with_outputs: bool) -> Vec<Subject> {
        let of = |kind| Subject { kind, channel: None };
        let each = |kind, count: usize| {
            (0..count).map(move |i| Subject { kind, channel: Some(i) }).collect::<Vec<_>>()
        };
        let StatedTiming { input_latency, output_latency, .. } = &self.timing;
        let mut subjects = vec![of(Imperfection::Latency)];
        if input_latency.len() > 1 {
            subjects.extend(each(Imperfection::Latency, input_latency.len()));
        }
        if with_outputs {
            subjects.push(of(Imperfection::OutputLatency));
            if (2..=MOST_OUTPUTS).contains(&output_latency.len()) {
                subjects.extend(each(Imperfection::OutputLatency, output_latency.len()));
            }
        }
        if !self.is_sampled() {
            subjects.extend([Imperfection::Jitter, Imperfection::Skew].map(of));
        }
        subjects.push(of(Imperfection::Loss));
        subjects
    }

    /// Whether it is a latency of several channels that have a budget each as well.
    pub(super) fn is_joint(&self, subject: Subject) -> bool {
        let StatedTiming { input_latency, output_latency, .. } = &self.timing;
        subject.channel.is_none()
            && match subject.kind {
                Imperfection::Latency => input_latency.len() > 1,
                Imperfection::OutputLatency => (2..=MOST_OUTPUTS).contains(&output_latency.len()),
                _ => false,
            }
    }
}
