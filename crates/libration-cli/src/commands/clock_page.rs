//! The clocks of a log as an HTML page.

use libration_logs::clock::{Dependence, Latency, TopicClock};
use libration_report::figure::{Axis, Figure, Mark, Panel};
use libration_report::notation::plural;
use libration_report::page::Page;
use libration_report::record::{Cell, Table};
use libration_report::report;

use super::clock_report::ClockReport;
use super::clock_text::{
    CHANGING, CUT, doubt_words, drift_words, law_words, matching_words, trend_words, verdict_words,
};
use super::measure_jitter::{jitter_words, listed, time};

/// Returns the report as an HTML page.
pub(super) fn page(found: &ClockReport) -> String {
    let mut page = Page { title: title(found), ..Page::default() };
    page.answer = answer(found);
    for note in &found.notes {
        page.note(format!("{note}."));
    }
    for effect in &found.effects {
        page.heading(format!("Loop: {}", effect.case));
        page.paragraph(effect.answer.clone());
        page.note(format!("Verdict: {}.", effect.verdict));
        for warning in &effect.warnings {
            page.note(format!("Warning: {warning}."));
        }
        let mut table =
            Table::new(&effect.case, &["imperfection", "stated", "stable up to", "used", "unit"]);
        for budget in &effect.budgets {
            table.push([
                budget.name().into(),
                budget.stated.into(),
                budget.limit_in_words(budget.stable_up_to).into(),
                budget.used_in_percent().into(),
                budget.unit.into(),
            ]);
        }
        page.table(&table, 4);
        page.paragraph(format!("`{}`", effect.command));
    }
    if let Some(clock) = &found.clock {
        topic_clock(&mut page, clock);
    }
    if let Some(latency) = &found.latency {
        of_latency(&mut page, latency);
    }
    if let Some(command) = found.advise_command.as_ref().filter(|_| found.effects.is_empty()) {
        page.paragraph(format!("For your loop: `{command}`"));
    }
    page.heading("Topics");
    let mut table = Table::new("topics", &["topic", "messages", "rate (Hz)", "clocks", "type"]);
    for topic in &found.topics {
        table.push([
            topic.name.as_str().into(),
            Cell::from(topic.count as u64),
            topic.rate.map_or_else(|| Cell::absent("-"), Cell::from),
            topic.clocks.join(", ").into(),
            topic.message_type.as_str().into(),
        ]);
    }
    page.table(&table, 6);
    report::render_page(&page, &format!("{} · {} · `libration clock`", found.file, found.format))
}

/// The verdict on the loop, or the rate of the clock.
fn title(found: &ClockReport) -> String {
    match (found.effects.last(), &found.clock) {
        (Some(effect), _) => format!("Loop with a recorded clock: {}", effect.verdict.outcome),
        (None, Some(clock)) => format!(
            "Clock of {}: {:.4} Hz, jitter of {:.3} %",
            clock.topic,
            clock.rate,
            100.0 * clock.statistics.jitter_rms
        ),
        (None, None) => format!("Log of {}", plural(found.topics.len(), "topic")),
    }
}

fn answer(found: &ClockReport) -> String {
    let mut words = Vec::new();
    words.extend(found.effects.last().map(|effect| effect.answer.clone()));
    if let Some(clock) = &found.clock {
        words.push(format!(
            "`{}` has {:.4} messages per second with a jitter of {:.3} % rms.",
            clock.topic,
            clock.rate,
            100.0 * clock.statistics.jitter_rms
        ));
    }
    if let Some(latency) = &found.latency {
        words.push(format!(
            "`{}` follows `{}` after {} in the median and {} in 99 % of the cases.",
            latency.to,
            latency.from,
            time(latency.quantile(0.5)),
            time(latency.quantile(0.99))
        ));
    }
    match words.is_empty() {
        true => format!("The file has {} topics.", found.topics.len()),
        false => words.join(" "),
    }
}

fn topic_clock(page: &mut Page, clock: &TopicClock) {
    page.heading(format!("Clock of {}", clock.topic));
    let mut table = Table::new("clock", &["quantity", "value"]);
    let mut line = |what: &str, value: String| table.push([what.into(), value.into()]);
    let statistics = &clock.statistics;
    line("clock", clock.clock.to_owned());
    line("messages", clock.messages.to_string());
    line("intervals", listed(&statistics.lengths));
    line("mean interval", time(statistics.mean));
    line("jitter, relative rms", jitter_words(statistics));
    line("gaps above 1.5 periods", statistics.gaps.to_string());
    line("repeated stamps", statistics.repeats.to_string());
    line("stamps that go back", clock.backward.to_string());
    line("law of intervals", verdict_words(&clock.law));
    if let Some(lateness) = &clock.lateness {
        line("law of lateness on the grid", verdict_words(lateness));
    }
    if let Some(drift) = &clock.log_against_header {
        line("log clock - header", drift_words(drift));
    }
    page.table(&table, 4);
    laws(page, "laws of intervals", &clock.law.fits);
    if let Some(spectrum) = &statistics.spectrum {
        let (x, y): (Vec<f64>, Vec<f64>) =
            spectrum.bands.iter().map(|band| (band.frequency, band.density)).unzip();
        let panel =
            Panel::new(Axis::linear("frequency").unit("Hz"), Axis::log("density over white noise"))
                .mark(Mark::line(x, y).label("intervals"));
        let figure = Figure::new("spectrum", "Spectrum of the intervals")
            .caption(
                "White noise has the density one; late wake-ups on a grid rise with frequency.",
            )
            .description("The power spectral density of the intervals over frequency.");
        page.figure(figure.panel(panel));
    }
}

fn laws(page: &mut Page, name: &str, fits: &[libration_logs::clock::Fit]) {
    if fits.is_empty() {
        return;
    }
    let mut table = Table::new(name, &["law", "AIC above the best", "distance", "p"]);
    for fit in fits {
        table.push([
            law_words(&fit.law).into(),
            fit.aic_above_best.into(),
            fit.distance.into(),
            fit.p_value.into(),
        ]);
    }
    page.table(&table, 3);
}

fn of_latency(page: &mut Page, latency: &Latency) {
    page.heading(format!("Latency from {} to {}", latency.from, latency.to));
    page.paragraph(format!(
        "{}. {}; {} clock.",
        listed(&latency.quantiles),
        matching_words(latency),
        latency.clock
    ));
    if let Some(interval) = latency.visible_up_to {
        page.note(format!("Latencies above {} are not visible.", time(interval)));
    }
    if latency.is_cut {
        page.note(format!("Warning: {CUT}."));
    }
    if let Some(trend) = &latency.time_dependence.trend {
        page.note(format!("Over time the latency {}.", trend_words(trend)));
    }
    if latency.time_dependence.dependence == Dependence::Changing {
        page.note(format!("Warning: {CHANGING}."));
    }
    page.note(format!("Law of latencies: {}.", verdict_words(&latency.law)));
    if let Some(doubt) = latency.doubt {
        page.note(format!("Warning: {}.", doubt_words(doubt)));
    }
    let (mut x, mut y) = (Vec::new(), Vec::new());
    for (i, &(from, count)) in latency.histogram.iter().enumerate() {
        let next = latency
            .histogram
            .get(i + 1)
            .map_or_else(|| latency.quantile(0.99).max(from), |bin| bin.0);
        x.extend([from * 1e3, next * 1e3]);
        y.extend([count as f64; 2]);
    }
    let panel = Panel::new(Axis::linear("latency").unit("ms"), Axis::linear("messages"))
        .mark(Mark::line(x, y).label("messages per bin"));
    let figure = Figure::new("latency", "Distribution of the latency")
        .caption("The last bin has all latencies above the 99 % quantile.")
        .description("A histogram of the latency between two topics.");
    page.figure(figure.panel(panel));
    laws(page, "laws of latencies", &latency.law.fits);
}
