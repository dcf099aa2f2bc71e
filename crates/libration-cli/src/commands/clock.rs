//! `libration clock`.

use libration_logs::clock::{Dependence, Latency, TopicClock, phase_lags, rate_of_phase};
use libration_logs::{Log, LogError};
use libration_report::verdict;
use serde_json::json;

use super::clock_effect;
use super::clock_page::page;
use super::clock_report::{ClockReport, Hold, Topic};
use super::clock_text::describe;
use super::measure_jitter::print_json;
use super::result_file::ResultFile;
use crate::args::{ClockArgs, quoted};
use crate::error::Failure;
use crate::progress::reading;
use crate::terminal;

/// Analyzes the clocks of a log and prints the result.
pub(crate) fn run(args: &ClockArgs, quiet: bool) -> Result<(), Failure> {
    let file = ResultFile::create("--page", args.page.as_deref())?;
    let report = report(args, quiet)?;
    match args.json {
        true => print_json(&json!(report))?,
        false => terminal::print(&describe(&report))?,
    }
    file.write(|| page(&report))?;
    match verdict::exit_code(report.effects.iter().map(|effect| &effect.verdict)) {
        verdict::GOOD => Ok(()),
        _ => Err(Failure::Disagreement),
    }
}

fn report(args: &ClockArgs, quiet: bool) -> Result<ClockReport, Failure> {
    let name = args.file.display().to_string();
    let clock = args.topic.clock.choice();
    let wrong = |option: &'static str| {
        let name = name.clone();
        move |error: LogError| Failure::usage(format!("cannot use `{name}` ({option}): {error}"))
    };
    let option = if args.topic.time.is_some() { "--time" } else { "FILE" };
    let open = || Log::open(&args.file, &args.topic.read_options());
    let log = reading(quiet, &args.file, open).map_err(wrong(option))?;
    let topic = match (&args.topic.topic, log.default_topic()) {
        (Some(topic), _) => Some(topic.clone()),
        (None, Ok(topic)) => Some(topic),
        (None, Err(why)) if args.config.is_some() => {
            return Err(Failure::usage(format!("cannot use `{name}` (--config): {why}")));
        }
        (None, Err(_)) => None,
    };
    let of = |topic: &String| {
        let of = || TopicClock::of(&log, topic, clock);
        reading(quiet, &args.file, of).map_err(wrong("--topic"))
    };
    let topic_clock = topic.as_ref().map(of).transpose()?;
    let latency = match (&topic, &args.against) {
        (Some(topic), Some(against)) => {
            let between = || Latency::between(&log, topic, against, clock);
            Some(reading(quiet, &args.file, between).map_err(wrong("--against"))?)
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
        // A latency that changes has no value that holds beyond the record.
        let steady = latency
            .as_ref()
            .filter(|latency| latency.time_dependence.dependence != Dependence::Changing);
        let at = steady.map(|latency| latency.quantile(0.99));
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
