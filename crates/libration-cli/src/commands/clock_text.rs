//! The clocks of a log as text.

use std::fmt::Write as _;

use libration_advise::Budget;
use libration_logs::clock::{
    Dependence, Doubt, Drift, Latency, Law, LawFit, LawVerdict, Matching, PhaseLag, TopicClock,
};
use libration_report::printable::printable;

use super::clock_effect::Effect;
use super::clock_report::ClockReport;
use super::measure_jitter::{self, listed, time};

/// The warning about latencies that the interval of the earlier topic cuts.
pub(super) const CUT: &str =
    "latencies reach the limit or are uniform below it: true ones may be longer";

/// Returns the report as text.
pub(super) fn describe(report: &ClockReport) -> String {
    let mut text = format!("{}: {}\n", report.file, report.format);
    for note in report.notes.iter().map(|note| printable(note)) {
        let _ = match note.starts_with("warning: ") {
            true => writeln!(text, "{note}"),
            false => writeln!(text, "note: {note}"),
        };
    }
    let width = report
        .topics
        .iter()
        .map(|topic| topic.name.chars().count())
        .max()
        .unwrap_or(0)
        .clamp(16, 48);
    if !report.topics.is_empty() {
        let _ = writeln!(
            text,
            "\n{:<width$} {:>9} {:>12}  {:<20} type",
            "topic", "messages", "rate", "clocks"
        );
    }
    for topic in &report.topics {
        let rate = topic.rate.map_or_else(|| "-".to_owned(), |rate| format!("{rate:.3} Hz"));
        let clocks = topic.clocks.join(", ");
        let [name, kind] = [&topic.name, &topic.message_type].map(|text| printable(text));
        let count = topic.count;
        let _ = writeln!(text, "{name:<width$} {count:>9} {rate:>12}  {clocks:<20} {kind}");
    }
    match &report.clock {
        Some(clock) => topic_clock(clock, &mut text),
        None if report.topics.is_empty() => text += "\nthe file has no time stamps\n",
        None => text += "\nhelp: choose a topic with --topic\n",
    }
    if let Some(found) = &report.latency {
        latency(found, &mut text);
    }
    if let Some(hold) = report.hold.as_ref().filter(|_| report.effects.is_empty()) {
        let _ = writeln!(text, "\nin any loop that runs with this clock");
        line(&mut text, "hold of a sample", phases(hold.delay, &hold.phase));
        if let Some(found) = &report.latency {
            line(&mut text, "median latency", phases(found.quantile(0.5), &found.phase_of_median));
            line(
                &mut text,
                "99 % latency",
                phases(found.quantile(0.99), &found.phase_of_99_percent),
            );
            if let Some(bandwidth) = found.bandwidth_at_10_degrees {
                let words =
                    format!("the 99 % latency costs 10° of phase margin at {bandwidth:.3} Hz");
                line(&mut text, "bandwidth", words);
            }
        }
    }
    for effect in &report.effects {
        describe_effect(effect, &mut text);
    }
    if let Some(command) = report.advise_command.as_ref().filter(|_| report.effects.is_empty()) {
        let _ = writeln!(text, "\nfor your loop: {command}");
    }
    text
}

fn line(text: &mut String, name: &str, value: impl std::fmt::Display) {
    let _ = writeln!(text, "  {name:<22} {value}");
}

fn topic_clock(clock: &TopicClock, text: &mut String) {
    let count = match clock.without_clock {
        0 => clock.messages.to_string(),
        without => format!("{} of {}", clock.messages - without, clock.messages),
    };
    let head =
        format!("\n{}, {} clock: {count} messages, {:.4} Hz", clock.topic, clock.clock, clock.rate);
    *text += &measure_jitter::describe(&head, &clock.statistics);
    if clock.without_clock > 0 {
        line(text, "without this clock", format!("{} messages", clock.without_clock));
    }
    let order = match clock.backward {
        0 => "each stamp is at or after its predecessor".to_owned(),
        count => {
            format!("{count} stamps go back, at most by {}; sorted", time(clock.largest_step_back))
        }
    };
    line(text, "order", order);
    law(&clock.law, "intervals", text);
    if let Some(lateness) = &clock.lateness {
        law(lateness, "lateness", text);
    }
    if let Some(drift) = &clock.log_against_header {
        line(text, "log clock - header", drift_words(drift));
    }
}

/// The warning about latencies that change over time.
pub(super) const CHANGING: &str = "latencies change over time, as of clocks that drift or were set: they are those of this record";

/// The line of latencies over time in words.
pub(super) fn trend_words(trend: &Drift) -> String {
    format!("rises by {:+.2} ± {:.2} ppm (95 %)", trend.skew_ppm, trend.half_width_ppm)
}

/// The drift between two clocks in words.
pub(super) fn drift_words(drift: &Drift) -> String {
    format!(
        "median {}, rises by {:+.2} ± {:.2} ppm (95 %)",
        time(drift.offset),
        drift.skew_ppm,
        drift.half_width_ppm
    )
}

/// The verdict about laws in words.
pub(super) fn verdict_words(fit: &LawFit) -> String {
    let words = |what: &str| {
        let best = fit.best();
        best.map_or_else(String::new, |best| {
            format!(
                "{}{what} (distance {:.3}, p = {:.2})",
                law_words(&best.law),
                best.distance,
                best.p_value
            )
        })
    };
    match fit.verdict {
        LawVerdict::Constant => "all are equal".to_owned(),
        LawVerdict::TooFew => "too few for a law".to_owned(),
        LawVerdict::Fits => words(""),
        LawVerdict::Close => words(", close but rejected"),
        LawVerdict::None => "none fits: replay the record (--jitter-file)".to_owned(),
        LawVerdict::DependsOnTime => "none: they change over time".to_owned(),
        LawVerdict::Correlated => "none: neighbours resemble each other".to_owned(),
    }
}

fn law(fit: &LawFit, of: &str, text: &mut String) {
    line(text, &format!("law of {of}"), verdict_words(fit));
    if fit.fits.is_empty() {
        return;
    }
    let _ = writeln!(text, "  {:<22} {:<34} {:>10} {:>9} {:>7}", "", "law", "AIC", "distance", "p");
    for one in &fit.fits {
        let _ = writeln!(
            text,
            "  {:<22} {:<34} {:>+10.1} {:>9.4} {:>7.3}",
            "", one.name, one.aic_above_best, one.distance, one.p_value
        );
    }
}

/// A law with its parameters in words.
pub(super) fn law_words(law: &Law) -> String {
    match *law {
        Law::Gaussian { mean, deviation } => {
            format!("gaussian, {} ± {}", time(mean), time(deviation))
        }
        Law::Uniform { from, to } => format!("uniform from {} to {}", time(from), time(to)),
        Law::Exponential { from, scale } => {
            format!("at least {}, exponential tail of {}", time(from), time(scale))
        }
        Law::Laplace { median, scale } => {
            format!("exponential tails of {} around {}", time(scale), time(median))
        }
        Law::TwoValued { values: [a, b], deviations: [da, db], share } => format!(
            "two-valued: {} ± {}, and {} ± {} in {:.1} %",
            time(a),
            time(da),
            time(b),
            time(db),
            100.0 * share
        ),
    }
}

/// The doubt about latencies in words.
pub(super) fn doubt_words(doubt: Doubt) -> &'static str {
    match doubt {
        Doubt::CopiedStamps => {
            "all latencies are 0: the stamps of one topic are copied to the other; help: choose another --clock or topic"
        }
        Doubt::ClocksApart => {
            "latencies are longer than the record: the clocks of both topics are apart, as those of two machines; help: --clock log"
        }
    }
}

/// How messages are matched, in words.
pub(super) fn matching_words(latency: &Latency) -> String {
    let how = match latency.matching {
        Matching::HeaderStamps => "equal header stamps",
        Matching::Row => "rows",
        Matching::NearestPreceding => "the nearest preceding message",
    };
    format!(
        "{} pairs by {how}; {} of {} without a match, {} of {} not answered",
        latency.count, latency.unmatched, latency.to, latency.unanswered, latency.from
    )
}

fn latency(found: &Latency, text: &mut String) {
    let _ = writeln!(text, "\nlatency from {} to {}, {} clock", found.from, found.to, found.clock);
    line(text, "matched", matching_words(found));
    line(text, "latency", listed(&found.quantiles));
    line(text, "mean", format!("{} ± {}", time(found.mean), time(found.deviation)));
    if found.negative > 0 {
        let words = format!(
            "{} latencies are below zero: the clock is not that of a cause",
            found.negative
        );
        line(text, "warning", words);
    }
    if let Some(interval) = found.visible_up_to {
        line(text, "limit", format!("latencies above {} are not visible", time(interval)));
    }
    if found.is_cut {
        line(text, "warning", CUT);
    }
    if let Some(doubt) = found.doubt {
        line(text, "warning", doubt_words(doubt));
    }
    if let Some(trend) = &found.time_dependence.trend {
        line(text, "change over time", trend_words(trend));
    }
    let correlation = found.time_dependence.correlation;
    line(text, "correlation", format!("{correlation:+.2} of neighbours"));
    if found.time_dependence.dependence == Dependence::Changing {
        line(text, "warning", CHANGING);
    }
    law(&found.law, "latencies", text);
    let most = found.histogram.iter().map(|bin| bin.1).max().unwrap_or(1).max(1);
    for &(from, count) in &found.histogram {
        let bar = "█".repeat((40 * count).div_ceil(most));
        line(text, &format!("{:>10} and more", time(from)), format!("{count:>9} {bar}"));
    }
}

fn phases(delay: f64, lags: &[PhaseLag]) -> String {
    let lags: Vec<String> =
        lags.iter().map(|lag| format!("{:.1}° at {} Hz", lag.degrees, lag.frequency)).collect();
    format!("{}: {}", time(delay), lags.join(", "))
}

/// A stated size beside its limit, with the used part if there is one.
fn budget_words(budget: &Budget) -> String {
    let (stated, unit) = (libration_advise::rounded(budget.stated), budget.unit);
    let (limit, used) = (budget.limit_in_words(budget.stable_up_to), budget.used_in_percent());
    match budget.stable_up_to {
        Some(_) if used.is_empty() => format!("{stated} of at most {limit} {unit}"),
        Some(_) => format!("{stated} of at most {limit} {unit}: {used}"),
        None => format!("{stated} {unit}; limit: {limit}"),
    }
}

fn describe_effect(effect: &Effect, text: &mut String) {
    let at = effect.latency.map_or_else(String::new, |latency| format!(" of {}", time(latency)));
    let _ = writeln!(text, "\n{}{at}: {}", effect.case, effect.answer);
    for warning in &effect.warnings {
        let _ = writeln!(text, "warning: {warning}");
    }
    let _ = writeln!(text, "verdict: {}", effect.verdict);
    for budget in &effect.budgets {
        line(text, &budget.name(), budget_words(budget));
    }
    let _ = writeln!(text, "  {}", effect.command);
}
