//! `libration advise` for loops around linear plants.

use std::fmt::Write as _;
use std::ops::RangeInclusive;

use libration_advise::linear::{self, ChainLink, InputMargins, LinearAdvice, LinearRequest};
use libration_advise::{Budget, StabilityWindow, rounded, rounded_down};
use libration_report::notation::{cut_off, cut_up};
use libration_work::Work;

use super::advice_output::AdviceOutput;
use super::digits::{exact, significant};
use super::repeat_command::command_line;
use super::time_stamps::RecordNotes;
use super::{config_file, summary, time_stamps};
use crate::args::AdviseArgs;
use crate::error::Failure;

/// Mean intervals of time stamps over the period: a hundredth still tells units from each other, which differ by 1000, and the largest is just
/// below a skew of 8, the limit of the analysis.
const INTERVALS: RangeInclusive<f64> = 0.01..=8.9;

/// Returns the request of the file or of the options, if it is about a linear plant, and what is to be said of its record.
pub(super) fn load_request(
    args: &AdviseArgs,
) -> Result<Option<(LinearRequest, RecordNotes)>, Failure> {
    let request = match (&args.config, args.linear_request()) {
        (_, Some(request)) => Some(request?),
        (Some(path), None) => config_file::read(path, |text, name| {
            let change = |file: &mut linear::RequestFile| args.set_timing(file);
            match linear::is_linear(text) {
                true => linear::parse_changed(text, name, change).map(Some),
                false => Ok(None),
            }
        })?,
        (None, None) => None,
    };
    let Some(mut request) = request else { return Ok(None) };
    request.map = args.page.is_some();
    request.redesign = args.linear.redesign;
    request.invocation = command_line();
    let mut notes = RecordNotes::default();
    if let Some(path) = &args.jitter_file {
        let (options, period) = (args.topic.options(), request.period());
        let replay = |stamps: &[f64]| request.with_time_stamps(stamps);
        (request, notes) = time_stamps::read_for_period(path, &options, period, INTERVALS, replay)?;
    }
    Ok(Some((request, notes)))
}

/// Computes the limits of a loop around a linear plant and prints them.
pub(super) fn run(
    args: &AdviseArgs,
    request: LinearRequest,
    notes: RecordNotes,
    quiet: bool,
) -> Result<(), Failure> {
    let compute = |work: &Work<'_>| linear::advise(work, &request);
    let output = AdviceOutput {
        describe,
        summarise: summary::of_linear_advice,
        page: linear::page,
        verdict: |advice| &advice.verdict,
        warnings: |advice| &mut advice.warnings,
        doubt: LinearAdvice::doubt,
    };
    output.deliver(args, quiet, notes, compute)
}

/// Returns the answer as text.
fn describe(advice: &LinearAdvice) -> String {
    let mut text = format!("{}\n", advice.answer);
    for warning in &advice.warnings {
        let _ = writeln!(text, "warning: {warning}");
    }
    let _ = writeln!(text, "verdict: {}", advice.verdict);
    let _ = writeln!(text, "\n{}; a sample every {} s", advice.controller, advice.period);
    if let Some(gain) = &advice.gain {
        for i in 0..gain.rows() {
            let row: Vec<String> = gain.row(i).iter().map(|x| rounded(*x)).collect();
            let _ = writeln!(text, "  {} = -[{}] x", advice.inputs[i].name, row.join(", "));
        }
    }
    if !advice.budgets.is_empty() {
        budgets(advice, &mut text);
    }
    if !advice.chain.is_empty() {
        let _ = writeln!(
            text,
            "\n{:<24} {:<16} {:>12} {:>10} {:>16}",
            "part of the latency", "channel", "delay/s", "phase/deg", "share of limit"
        );
    }
    for link in &advice.chain {
        let _ = writeln!(
            text,
            "{:<24} {:<16} {:>12} {:>10} {:>16}",
            link.part,
            link.channel,
            rounded(link.delay),
            link.phase.map_or_else(|| "-".to_owned(), |phase| format!("{phase:.2}")),
            link.share.map_or_else(|| "-".to_owned(), |share| format!("{:.1} %", 100.0 * share)),
        );
    }
    for note in ChainLink::notes(&advice.chain) {
        let _ = writeln!(text, "  {note}");
    }
    if !advice.schedule.is_empty() {
        let _ = writeln!(text, "\n{}", linear::NO_MARGINS);
    }
    margins(&advice.margins, "", &mut text);
    redesign(advice, &mut text);
    deadlines(advice, &mut text);
    let with = if advice.unstable_motions.is_empty() || advice.is_stable_as_stated() {
        "all imperfections together"
    } else {
        "without imperfections"
    };
    let _ = writeln!(
        text,
        "\n{with}: second moments change by {:+.4e} per period (exact)",
        advice.growth.exp_m1()
    );
    if advice.deviations.is_empty() {
        let _ = writeln!(text, "repeat with: {}", advice.repeat_command);
        return text;
    }
    let _ = writeln!(
        text,
        "cost under noise: {}, without imperfections {:.6e} (exact: Lyapunov equation)",
        advice.cost.map_or_else(|| "infinite".to_owned(), |cost| format!("{cost:.6e}")),
        advice.ideal_cost
    );
    if let Some(s) = &advice.simulated {
        let _ = writeln!(
            text,
            "cost of {} simulated loops, {} periods, constant noise in each period: {:.5e} ± {:.1e}, predicted {:.5e}",
            s.loops, s.periods, s.cost, s.error, s.predicted
        );
    }
    let _ = writeln!(
        text,
        "\n{:<24} {:<10} {:>14} {:>20}",
        "deviation (rms)", "unit", "ideal", "with imperfections"
    );
    for deviation in &advice.deviations {
        let _ = writeln!(
            text,
            "{:<24} {:<10} {:>14.6e} {:>20}",
            deviation.state,
            deviation.unit,
            deviation.ideal,
            deviation
                .stated
                .map_or_else(|| advice.no_deviation().to_owned(), |x| format!("{x:.6e}")),
        );
    }
    let _ = writeln!(text, "repeat with: {}", advice.repeat_command);
    text
}

/// Appends the margins at each input.
fn margins(of_inputs: &[InputMargins], of: &str, text: &mut String) {
    for margins in of_inputs {
        let known =
            |x: Option<f64>, unit: &str| x.map_or_else(|| "none".to_owned(), |x| exact(x) + unit);
        let _ = writeln!(
            text,
            "\nmargins{of} at {}: gain from {} to {}, phase {} at {}",
            margins.input,
            known(margins.gain_down.map(|x| cut_up(x, 5)), ""),
            known(margins.gain_up.map(|x| cut_off(x, 5)), ""),
            known(margins.phase.map(|x| cut_off(x, 5)), " deg"),
            margins.crossover.map_or_else(|| "none".to_owned(), |x| significant(x, 5) + " Hz"),
        );
    }
}

/// Appends what the loop does when it misses deadlines.
fn deadlines(advice: &LinearAdvice, text: &mut String) {
    let Some(misses) = &advice.deadline_misses else { return };
    if let Some(worst) = &misses.worst_case {
        let _ = writeln!(
            text,
            "\n{:<32} {:<10} {:>14} {:>14}  worst sequence, over and over",
            format!("missed deadlines ({}, {})", misses.overrun, misses.missing),
            "verdict",
            "growth from",
            "to"
        );
        for row in &worst.tried {
            let _ = writeln!(
                text,
                "{:<32} {:<10} {:>14.6} {:>14.6}  {}",
                format!("at most {} of {}", row.misses, row.window),
                row.verdict,
                row.lower,
                row.upper,
                row.sequence_text()
            );
        }
    }
    if let Some(random) = &misses.random {
        let limit = random.stable_up_to.map_or_else(|| "above 63/64".to_owned(), rounded_down);
        let cost = random.cost.map_or_else(|| "infinite".to_owned(), |x| format!("{x:.6e}"));
        let _ = writeln!(
            text,
            "\nrandom overruns ({}, {}) with probability {}: second moments change by {:+.4e} per period, cost {cost}, stable up to {limit}",
            misses.overrun,
            misses.missing,
            random.probability,
            random.growth.exp_m1()
        );
    }
}

/// Appends the controller of least cost for the stated timing.
fn redesign(advice: &LinearAdvice, text: &mut String) {
    let Some(redesign) = &advice.redesign else { return };
    let _ = writeln!(text, "\nredesign: {}", redesign.method);
    let _ = writeln!(text, "{}", advice.redesign_effect());
    for note in &redesign.notes {
        let _ = writeln!(text, "note: {note}");
    }
    let _ = writeln!(
        text,
        "\n{:<32} {:>12} {:>24} {:>24}  unit",
        "others as stated", "stated", "stable", "redesigned: stable"
    );
    for limit in &redesign.limits {
        let _ = writeln!(
            text,
            "{:<32} {:>12} {:>24} {:>24}  {}",
            limit.name(),
            rounded(limit.stated),
            limit.in_words(limit.given),
            limit.in_words(limit.redesigned),
            limit.unit
        );
    }
    margins(&redesign.margins, " of the redesign", text);
    let _ = writeln!(text, "\nto paste in place of the controller:\n{}", redesign.toml.trim_end());
}

/// Appends the budget of each imperfection.
fn budgets(advice: &LinearAdvice, text: &mut String) {
    // Without a tolerance of the cost there is nothing in the column.
    let tolerance = advice.budgets.iter().any(|budget| budget.tolerated_up_to.is_some());
    let tolerated = |what: String| if tolerance { format!(" {what:>14}") } else { String::new() };
    let _ = writeln!(
        text,
        "\n{:<32} {:>12} {:>14}{} {:>8}  {:<17} how",
        "alone",
        "stated",
        "stable up to",
        tolerated("tolerated".into()),
        "used",
        "unit"
    );
    for budget in &advice.budgets {
        let limit =
            budget.tolerated_up_to.map_or_else(String::new, |limit| budget.limit_in_words(limit));
        let _ = writeln!(
            text,
            "{:<32} {:>12} {:>14}{} {:>8}  {:<17} {}",
            budget.name(),
            rounded(budget.stated),
            budget.limit_in_words(budget.stable_up_to),
            tolerated(limit),
            budget.used_in_percent(),
            budget.unit,
            budget.how
        );
    }
    let later = |budget: &Budget| {
        StabilityWindow::sentence(&budget.name(), &budget.later_windows, budget.unit)
    };
    for windows in advice.budgets.iter().filter_map(later) {
        let _ = writeln!(text, "{windows}");
    }
}
