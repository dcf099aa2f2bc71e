//! Advice on a loop around a linear plant.

use libration_advise::linear::{InputMargins, LinearAdvice, RedesignLimit};
use libration_advise::{Budget, Imperfection};

use super::super::digits::{least, limit, short, significant};
use super::super::repeat_command::{with_flag, with_joined_option, with_option};
use super::loop_limits::{
    append_limits, append_share, append_simulated, change, change_without, cost,
};
use super::{Summary, in_decimals, map_command, numbers, words};
use crate::args::AdviseArgs;

/// Largest number of entries of a gain, of states, and of limits with a redesign.
const MOST_GAINS: usize = 6;
const MOST_STATES: usize = 3;
const MOST_REDESIGN_LIMITS: usize = 5;

/// Lines of an answer and its warnings from which it is long.
const LONG: usize = 5;

/// Returns a screen of advice.
pub(crate) fn of_linear_advice(advice: &LinearAdvice, args: &AdviseArgs) -> String {
    let mut summary = Summary::new(&advice.answer);
    summary.warnings(&advice.warnings);
    // A long answer leaves less room for numbers.
    let is_long = summary.line_count() > LONG;
    match &advice.redesign {
        Some(_) => append_redesign(advice, is_long, &mut summary),
        None if advice.budgets.is_empty() => {}
        None => append_limits(&advice.budgets, &mut summary),
    }
    summary.blank();
    let has_room = advice.redesign.is_none() && !is_long;
    if has_room {
        append_gain(advice, &mut summary);
    }
    if !advice.schedule.is_empty() {
        summary.row("margins", "none: a cascade has no frequency response");
    }
    if advice.redesign.is_none() || !is_long {
        append_margins("margins", &advice.margins, &mut summary);
    }
    let redesigned = advice.redesign.iter().flat_map(|redesign| &redesign.margins);
    append_margins("of the redesign", redesigned, &mut summary);
    match advice.unstable_motions.is_empty() || advice.is_stable_as_stated() {
        true => summary.row("second moments", &change(advice.growth)),
        false => summary
            .row("second moments", &(change_without(advice.growth) + " without imperfections")),
    }
    if advice.ideal_cost.is_finite() {
        summary.row("cost", &cost(advice.cost, advice.ideal_cost));
    }
    append_share(advice.margin, &mut summary);
    append_simulated(advice.simulated.as_ref(), "at samples", &mut summary);
    if has_room && !advice.deviations.is_empty() {
        append_deviations(advice, &mut summary);
    }
    if let Some((purpose, command)) = next(advice, args) {
        summary.command(purpose, &command);
    }
    let more = "all limits with methods, parts of the latency, deviations";
    summary.finish(&match (&advice.redesign, &advice.deadline_misses) {
        (Some(_), _) => format!("the controller, {more}"),
        (None, Some(_)) => format!("{more}, sequences of misses"),
        (None, None) => more.to_owned(),
    })
}

fn append_gain(advice: &LinearAdvice, summary: &mut Summary) {
    let small = advice.gain.as_ref().filter(|gain| gain.entries().len() <= MOST_GAINS);
    let Some(gain) = small else { return };
    for i in 0..gain.rows() {
        let row: Vec<String> = gain.row(i).iter().map(|x| significant(*x, 6)).collect();
        summary.row("feedback", &format!("{} = -[{}] x", advice.inputs[i].name, row.join(", ")));
    }
}

fn append_margins<'a>(
    name: &str,
    margins: impl IntoIterator<Item = &'a InputMargins>,
    summary: &mut Summary,
) {
    let known = |x: Option<String>, unit: &str| x.map_or_else(|| "none".to_owned(), |x| x + unit);
    if let Some(own) = InputMargins::tightest(margins) {
        let shown = format!(
            "at {}: gain from {} to {}, phase {} at {}",
            own.input,
            known(own.gain_down.map(|x| least(x, 4)), ""),
            known(own.gain_up.map(|x| limit(x, 4)), ""),
            known(own.phase.map(|x| limit(x, 4)), " deg"),
            known(own.crossover.map(|x| significant(x, 4)), " Hz")
        );
        summary.row(name, &shown);
    }
}

/// Appends the limits with the given and with the redesigned controller.
fn append_redesign(advice: &LinearAdvice, is_long: bool, summary: &mut Summary) {
    let Some(redesign) = &advice.redesign else { return };
    summary.blank();
    summary.sentence(&in_decimals(&format!("Redesign: {}", advice.redesign_effect())));
    for note in &redesign.notes {
        summary.wrap("", &format!("note: {note}"), 2);
    }
    let mut limits: Vec<&RedesignLimit> = redesign.limits.iter().collect();
    // Those of single channels that are not stated come last, and `false` is first.
    limits.sort_by_key(|limit| limit.stated == 0.0 && limit.channel.is_some());
    // The tightest first: those that are used most.
    let used = |limit: &RedesignLimit| {
        let end = limit.redesigned.and_then(|range| range.to);
        end.map_or(0.0, |end| limit.stated / end)
    };
    limits.sort_by(|a, b| used(b).total_cmp(&used(a)));
    let all = limits.len();
    let notes = redesign.notes.len().min(2);
    limits.truncate(MOST_REDESIGN_LIMITS - 1 - usize::from(is_long) - notes);
    let rows: Vec<Vec<String>> = limits
        .iter()
        .map(|limit| {
            vec![
                limit.name(),
                significant(limit.stated, 4),
                limit.in_words(limit.given),
                limit.in_words(limit.redesigned),
                limit.unit.to_owned(),
            ]
        })
        .collect();
    let heads = [
        words("others as stated"),
        numbers("stated"),
        numbers("stable"),
        numbers("redesigned: stable"),
        words("unit"),
    ];
    summary.table(&heads, &rows);
    summary.rest(all - rows.len());
}

fn append_deviations(advice: &LinearAdvice, summary: &mut Summary) {
    let shown = advice.deviations.iter().take(MOST_STATES).map(|deviation| {
        let size = deviation.stated.map(|x| significant(x, 3));
        let size = size.unwrap_or_else(|| advice.no_deviation().to_owned());
        format!("{} {size} {}", deviation.state, deviation.unit).trim_end().to_owned()
    });
    let mut shown: Vec<String> = shown.collect();
    let more = advice.deviations.len().saturating_sub(MOST_STATES);
    if more > 0 {
        shown.push(format!("and {more} more"));
    }
    let is_known = advice.deviations.iter().any(|deviation| deviation.stated.is_some());
    let shown = match is_known {
        true => shown.join(", "),
        false if advice.growth >= 0.0 => advice.no_deviation().to_owned(),
        false => "not computed for recorded steps".to_owned(),
    };
    summary.row("rms under noise", &shown);
}

/// The recommended command and its purpose.
fn next(advice: &LinearAdvice, args: &AdviseArgs) -> Option<(&'static str, String)> {
    if advice.redesign.as_ref().is_some_and(|redesign| redesign.cost.is_some()) {
        return Some(("Print the redesigned controller to paste", with_flag("--verbose")));
    }
    // What stabilises a loop that meets its deadlines may not do so beside missed ones.
    if let Some(remedies) = advice.remedies.as_ref().filter(|_| advice.deadline_misses.is_none()) {
        // Only a gain that the options give has a sign that an option changes.
        let gain =
            advice.gain.as_ref().filter(|_| args.config.is_none() && !args.linear.has_weights());
        if let (Some(factor), Some(gain)) = (remedies.opposite_factor, gain) {
            let row = |i: usize| {
                let row: Vec<String> =
                    gain.row(i).iter().map(|x| short(factor * x + 0.0)).collect();
                row.join(",")
            };
            let rows: Vec<String> = (0..gain.rows()).map(row).collect();
            let purpose = "Confirm the opposite sign of the gains";
            return Some((purpose, with_joined_option("--gain", &rows.join(";"))));
        }
        let is_late = |budget: &&Budget| {
            matches!(budget.kind, Imperfection::Latency | Imperfection::OutputLatency)
                && budget.stated != 0.0
        };
        // One value of `--latency` is that of all inputs; those of outputs are options of their own.
        let late: Vec<&Budget> = advice.budgets.iter().filter(is_late).collect();
        let inputs = late.iter().all(|budget| budget.kind == Imperfection::Latency);
        let latency = remedies.latency.filter(|_| inputs && advice.inputs.len() == 1);
        return latency
            .map(|latency| ("Confirm this latency", with_option("--latency", &limit(latency, 4))));
    }
    if args.linear.has_weights() && advice.is_costly() {
        return Some((
            "Design the controller of least cost for this timing",
            with_flag("--redesign"),
        ));
    }
    map_command(args)
}
