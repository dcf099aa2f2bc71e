//! What `libration clock` reports.

use libration_logs::TopicInfo;
use libration_logs::clock::{Latency, PhaseLag, TopicClock};
use serde::Serialize;

use super::clock_effect::Effect;

/// What a log says about its clocks.
#[derive(Debug, Serialize)]
pub(super) struct ClockReport {
    pub(super) file: String,
    pub(super) format: String,
    /// Remarks about the file.
    pub(super) notes: Vec<String>,
    pub(super) topics: Vec<Topic>,
    /// The clock of the topic.
    pub(super) clock: Option<TopicClock>,
    /// The latency from the topic to another.
    pub(super) latency: Option<Latency>,
    /// What the hold of a sample costs any loop that runs with this clock.
    pub(super) hold: Option<Hold>,
    /// What clock and latency do to the loop of `--config`.
    pub(super) effects: Vec<Effect>,
    /// The command that takes these numbers.
    pub(super) advise_command: Option<String>,
}

/// A topic of the file.
#[derive(Debug, Serialize)]
pub(super) struct Topic {
    pub(super) name: String,
    pub(super) message_type: String,
    pub(super) count: usize,
    /// Messages per second.
    pub(super) rate: Option<f64>,
    pub(super) clocks: Vec<&'static str>,
}

/// The mean delay of a sample that is held for a period.
#[derive(Debug, Serialize)]
pub(super) struct Hold {
    /// Half the mean interval in s.
    pub(super) delay: f64,
    pub(super) phase: Vec<PhaseLag>,
    /// The bandwidth in Hz at which it costs 10° of phase.
    pub(super) bandwidth_at_10_degrees: Option<f64>,
}

impl From<TopicInfo> for Topic {
    fn from(info: TopicInfo) -> Self {
        let intervals = info.count.saturating_sub(1) as f64;
        Topic {
            rate: (info.span > 0.0).then(|| intervals / info.span),
            clocks: info.clocks.iter().map(|clock| clock.name()).collect(),
            name: info.name,
            message_type: info.message_type,
            count: info.count,
        }
    }
}
