//! `libration clock`.

use libration_logs::clock::{Latency, PhaseLag, TopicClock, phase_lags, rate_of_phase};
use libration_logs::{Log, LogError, ReadOptions, TopicInfo};
use serde::Serialize;
use serde_json::json;

use super::clock_effect::{self, Effect};
use super::clock_page::page;
use super::clock_text::describe;
use super::measure_jitter::print_json;
use super::result_file::ResultFile;
use crate::args::{ClockArgs, quoted};
use crate::error::Failure;
use crate::terminal;

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

/// Analyzes the clocks of a log and prints the result.
pub(crate) fn run(args: &ClockArgs, quiet: bool) -> Result<(), Failure> {
    let file = ResultFile::create("--page", args.page.as_deref())?;
    let report = report(args, quiet)?;
    match args.json {
        true => print_json(&json!(report))?,
        false => terminal::print(&describe(&report))?,
    }
    file.write(|| page(&report))?;
    match report.effects.iter().all(|effect| effect.holds) {
        true => Ok(()),
        false => Err(Failure::Disagreement),
    }
}

fn report(args: &ClockArgs, quiet: bool) -> Result<ClockReport, Failure> {
    let name = args.file.display().to_string();
    let clock = args.topic.clock.choice();
    let wrong = |option: &'static str| {
        let name = name.clone();
        move |error: LogError| Failure::usage(format!("cannot use `{name}` ({option}): {error}"))
    };
    let option = if args.time.is_some() { "--time" } else { "FILE" };
    let log = Log::open(&args.file, &ReadOptions { time: args.time.clone(), clock })
        .map_err(wrong(option))?;
    let topic = match (&args.topic.topic, log.default_topic()) {
        (Some(topic), _) => Some(topic.clone()),
        (None, Ok(topic)) => Some(topic),
        (None, Err(why)) if args.config.is_some() => {
            return Err(Failure::usage(format!("cannot use `{name}` (--config): {why}")));
        }
        (None, Err(_)) => None,
    };
    let of = |topic: &String| TopicClock::of(&log, topic, clock).map_err(wrong("--topic"));
    let topic_clock = topic.as_ref().map(of).transpose()?;
    let latency = match (&topic, &args.against) {
        (Some(topic), Some(against)) => {
            Some(Latency::between(&log, topic, against, clock).map_err(wrong("--against"))?)
        }
        _ => None,
    };
    let hold = topic_clock.as_ref().map(|found| {
        let delay = found.statistics.mean / 2.0;
        let bandwidth_at_10_degrees = rate_of_phase(delay, 10.0);
        Hold { delay, phase: phase_lags(delay), bandwidth_at_10_degrees }
    });
    let effects = match (&args.config, &topic_clock) {
        (Some(config), Some(_)) => {
            clock_effect::effects(args, config, topic.as_deref(), latency.as_ref(), quiet)?
        }
        _ => Vec::new(),
    };
    let advise_command = topic_clock.as_ref().map(|_| {
        let config = args.config.clone().unwrap_or_else(|| "loop.toml".into());
        let at = latency.as_ref().map(|latency| latency.quantile(0.99));
        quoted(clock_effect::advise_words(args, &config, topic.as_deref(), at))
    });
    Ok(ClockReport {
        file: name,
        format: log.format(),
        notes: log.notes(),
        topics: log.topics().into_iter().map(Topic::from).collect(),
        clock: topic_clock,
        latency,
        hold,
        effects,
        advise_command,
    })
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
