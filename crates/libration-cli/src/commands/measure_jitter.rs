//! `libration measure-jitter`.

use std::fmt::Write as _;
use std::io::{BufWriter, Write};
use std::path::Path;

use libration::control::clock::Recorded;
use libration_advise::jitter_measurement::{JitterMeasurementError, Plan, Priority, WakeupTimes};
use libration_logs::{Quantile, Statistics};
use serde_json::{Value, json};

use super::time_stamps;
use crate::args::MeasureJitterArgs;
use crate::error::Failure;
use crate::output_file::OutputFile;
use crate::{interrupt, terminal};

/// Measures the jitter of a loop, or reads time stamps, and prints statistics.
pub(crate) fn run(args: &MeasureJitterArgs, quiet: bool) -> Result<(), Failure> {
    args.topic.ensure_file("--from", args.from.as_deref())?;
    if let Some(path) = &args.from {
        let stamps = time_stamps::read(path, "--from", &args.topic.options(), |stamps| {
            // Time stamps that a replay rejects are rejected here, too.
            Recorded::steps_between(&stamps.seconds).map(|_| stamps)
        })?;
        let statistics = Statistics::of(&stamps.seconds, None).with_resolution(stamps.resolution);
        return match args.json {
            true => print_json(&json!(statistics)),
            false => Ok(terminal::print(&describe(&path.display().to_string(), &statistics))?),
        };
    }
    let plan = args.plan();
    plan.check().map_err(|error| Failure::usage(format!("--{error}")))?;
    let stop = interrupt::listen();
    // An output file that cannot be written must fail before the measurement.
    let mut file = args.output.as_deref().map(create).transpose()?;
    let mut json_results = Vec::new();
    let mut interrupted = false;
    for &priority in args.priorities() {
        let name = named(priority);
        if !quiet {
            let load = if plan.load { ", with all cores busy" } else { "" };
            terminal::say(&format!("measuring for {} s, {name}{load}", plan.seconds));
        }
        let wakeups = match plan.measure(priority, stop) {
            Err(error @ JitterMeasurementError::NotAllowed(_)) if args.priorities().len() > 1 => {
                terminal::say(&format!("note: {error}"));
                continue;
            }
            Err(JitterMeasurementError::Interrupted) => {
                interrupted = true;
                break;
            }
            outcome => outcome.map_err(Failure::run)?,
        };
        let statistics = Statistics::of_loop(&wakeups.times, wakeups.period);
        if let Some((path, file)) = file.take() {
            write(file, &plan, name, &wakeups)
                .map_err(|error| Failure::run(unwritable(path, &error)))?;
        }
        match args.json {
            true => json_results.push(json!({
                "rate": plan.rate,
                "load": plan.load,
                "priority": name,
                "statistics": statistics,
            })),
            false => {
                let head = format!("{} Hz, {name}: {} wake-ups", plan.rate, wakeups.times.len());
                terminal::print(&describe(&head, &statistics))?;
            }
        }
        if wakeups.stopped {
            interrupted = true;
            break;
        }
    }
    if args.json {
        print_json(&json!(json_results))?;
    }
    match interrupted {
        true => Err(Failure::Interrupted("interrupted; the output ends here".into())),
        false => Ok(()),
    }
}

fn named(priority: Priority) -> &'static str {
    match priority {
        Priority::Ordinary => "ordinary priority",
        Priority::Raised => "raised priority",
    }
}

pub(super) fn print_json(value: &Value) -> Result<(), Failure> {
    let text = serde_json::to_string_pretty(value).map_err(Failure::run)?;
    Ok(terminal::print(&(text + "\n"))?)
}

fn unwritable(path: &Path, error: &std::io::Error) -> String {
    format!("cannot write `{}` (--output): {error}", path.display())
}

fn create(path: &Path) -> Result<(&Path, OutputFile), Failure> {
    let file = OutputFile::create(path);
    Ok((path, file.map_err(|error| Failure::usage(unwritable(path, &error)))?))
}

/// Writes the time stamps.
fn write(file: OutputFile, plan: &Plan, name: &str, wakeups: &WakeupTimes) -> std::io::Result<()> {
    let mut out = BufWriter::new(file);
    let load = if plan.load { "all cores busy" } else { "no load" };
    writeln!(out, "# wake-ups of a loop of {} Hz, {name}, {load}", plan.rate)?;
    writeln!(out, "time_ns")?;
    wakeups.times.iter().try_for_each(|time| writeln!(out, "{time}"))?;
    out.into_inner().map_err(|error| error.into_error())?.keep()
}

/// Returns the statistics as text.
pub(super) fn describe(head: &str, statistics: &Statistics) -> String {
    let mut text = format!("{head}\n");
    let mut line = |name: &str, value: String| {
        let _ = writeln!(text, "  {name:<22} {value}");
    };
    if let Some(lateness) = &statistics.lateness {
        line("lateness", listed(&lateness.quantiles));
        line("missed", format!("{} deadlines", lateness.overruns));
    }
    line("intervals", listed(&statistics.lengths));
    line(
        "mean interval",
        format!("{}, nominal {}", time(statistics.mean), time(statistics.period)),
    );
    line("jitter, relative rms", jitter_words(statistics));
    if statistics.gaps > 0 && statistics.heavy_tailed() {
        let few = if statistics.gaps * 10 < statistics.intervals { "a few" } else { "many" };
        line("", format!("{few} long gaps dominate the rms; help: replay the time stamps instead"));
    }
    line("gaps above 1.5 periods", statistics.gaps.to_string());
    if statistics.repeats > 0 {
        line("repeated time stamps", format!("{}: steps of length zero", statistics.repeats));
    }
    if !statistics.correlation.is_empty() {
        let shown: Vec<String> =
            statistics.correlation.iter().map(|c| format!("{c:+.2}")).collect();
        line("correlation, 1 apart on", shown.join(" "));
        line("", meaning(&statistics.correlation).into());
    }
    if let Some(spectrum) = &statistics.spectrum {
        line(
            "spectrum",
            match spectrum.peak() {
                Some(peak) => format!(
                    "highest at {:.4} Hz: {:.1} times white noise",
                    peak.frequency, peak.density
                ),
                None => "no distinct peak".into(),
            },
        );
    }
    if let Some(lateness) = &statistics.lateness {
        let most = lateness.histogram.iter().map(|&(_, count)| count).max().unwrap_or(1).max(1);
        let bins = lateness.histogram.iter().skip_while(|(_, count)| *count == 0);
        for &(from, count) in bins {
            // Rounded up: each bin with a count has a bar.
            let bar = (40 * count).div_ceil(most);
            line(
                &format!("{:>10} and more", time(from)),
                format!("{count:>9} {}", "█".repeat(bar)),
            );
        }
    }
    text
}

/// Correlation of neighbouring intervals below which they are taken as independent.
const INDEPENDENT: f64 = 0.1;

/// The rms of the intervals in words.
pub(super) fn jitter_words(statistics: &Statistics) -> String {
    let rms = statistics.jitter_rms;
    // `--jitter` has independent intervals.
    let correlation = &statistics.correlation;
    let is_independent =
        correlation.first().is_none_or(|first| first.abs() < INDEPENDENT) && !repeats(correlation);
    match statistics.equal_up_to {
        Some(resolution) => format!(
            "{rms:.3e}: intervals are equal up to the resolution of the time stamps, {}",
            time(resolution)
        ),
        None if is_independent => format!("{rms:.3e}, as in --jitter gaussian:{rms:.3}"),
        None => format!("{rms:.3e}; intervals are correlated: replay the record (--jitter-file)"),
    }
}

/// Correlation of intervals further apart from which they repeat: the noise of some tens of them is smaller.
const REPEATING: f64 = 0.35;

/// Whether intervals that are not neighbours are alike or opposite.
fn repeats(correlation: &[f64]) -> bool {
    correlation.iter().skip(1).any(|c| c.abs() > REPEATING)
}

/// Returns the likely cause of the correlations.
fn meaning(correlation: &[f64]) -> &'static str {
    match correlation[0] {
        c if repeats(correlation) && c < REPEATING => {
            "intervals repeat in a pattern: replay the record (--jitter-file)"
        }
        c if c < -0.35 => "the latenesses of wake-ups are independent; the time does not drift",
        c if c > 0.35 => "the rate varies slowly; neighbouring intervals are similar",
        c if c.abs() < INDEPENDENT => "intervals are independent",
        _ => "neighbouring intervals are weakly correlated",
    }
}

/// Quantiles as text.
pub(super) fn listed(quantiles: &[Quantile]) -> String {
    let one = |q: &Quantile| match q.part {
        0.0 => format!("min {}", time(q.value)),
        1.0 => format!("max {}", time(q.value)),
        part => format!("{} % {}", 100.0 * part, time(q.value)),
    };
    quantiles.iter().map(one).collect::<Vec<_>>().join(", ")
}

/// A time with three digits.
pub(super) fn time(seconds: f64) -> String {
    let (value, unit) = match seconds.abs() {
        s if s >= 0.9995 => (seconds, "s"),
        s if s >= 0.9995e-3 => (seconds * 1e3, "ms"),
        s if s >= 0.9995e-6 => (seconds * 1e6, "µs"),
        _ => (seconds * 1e9, "ns"),
    };
    let digits = if value.abs() >= 100.0 {
        0
    } else if value.abs() >= 10.0 {
        1
    } else {
        2
    };
    format!("{value:.digits$} {unit}")
}
