//! Advice on loops around linear plants as an HTML page.

use libration_report::notation::{cut_off, cut_up, number};
use libration_report::page::{Highlight, Page};
use libration_report::record::{Cell, Table};
use libration_report::report;
use libration_report::verdict::Outcome;

use super::deadlines_page::deadlines;
use super::{ChainLink, DeadlineMisses, InputMargins, LinearAdvice, redesign_page};
use crate::first_screen::{
    budget_bars, budget_numbers, change, cut, measure, reduce, simulated_cost, title,
};
use crate::live_setting::add_live_section;
use crate::page::{budget_row, figure, margin_cell};
use crate::{Budget, StabilityWindow};

/// Why a cascade has no margins.
pub const NO_MARGINS: &str = "Gain and phase margins are not available for a cascade: its loop changes from period to period and has no frequency response.";

/// The advice as an HTML page.
pub fn page(advice: &LinearAdvice) -> String {
    let title = title(advice.verdict.outcome, advice.is_in_window());
    let mut page = Page { title: title.into(), ..Page::default() };
    page.answer.clone_from(&advice.answer);
    page.highlights = numbers(advice);
    page.bars = budget_bars(&advice.budgets);
    page.actions = actions(advice);
    add_live_section(&mut page, advice.live.clone(), advice.verdict.outcome);
    for warning in &advice.warnings {
        page.note(format!("Warning: {warning}."));
    }
    match &advice.map {
        // An unstable loop has no limits, but a map of what stabilises it.
        Some(map) if advice.budgets.is_empty() => page.figure(figure(map)),
        _ if advice.budgets.is_empty() => {}
        _ => budgets(&mut page, advice),
    }
    chain(&mut page, advice);
    redesign_page::add(&mut page, advice);
    margins(&mut page, advice);
    deadlines(&mut page, advice);
    together(&mut page, advice);
    plant(&mut page, advice);
    let names = |signals: &[super::SignalName]| {
        signals.iter().map(|signal| signal.name.as_str()).collect::<Vec<_>>().join(", ")
    };
    let sub = format!(
        "{} states · inputs {} · measured {} · {} s · `{}`",
        advice.states.len(),
        names(&advice.inputs),
        names(&advice.outputs),
        number(advice.period, 4),
        advice.repeat_command,
    );
    report::render_page(&page, &sub)
}

/// The limits of what is stated, the margin at the input with the least, and the simulated cost with its prediction.
fn numbers(advice: &LinearAdvice) -> Vec<Highlight> {
    let mut all = budget_numbers(&advice.budgets);
    all.truncate(2);
    let tightest = InputMargins::tightest(&advice.margins);
    if let Some((own, phase)) = tightest.and_then(|own| Some((own, own.phase?))) {
        let gain = own.gain_up.map(|most| format!("; gain up to {} times", number(cut(most), 4)));
        all.push(Highlight {
            value: format!("{}°", number(cut_off(phase, 3), 3)),
            text: format!("phase margin at {}{}", own.input, gain.unwrap_or_default()),
        });
    }
    all.extend(advice.simulated.as_ref().map(simulated_cost));
    all
}

/// What to do about the answer. What stabilises a loop that meets its deadlines may not do so beside missed ones.
fn actions(advice: &LinearAdvice) -> Vec<String> {
    let mut actions = Vec::new();
    let is_stable = !advice.is_unstable();
    let remedies = advice.remedies.filter(|_| !is_stable && advice.deadline_misses.is_none());
    actions.extend(remedies.as_ref().and_then(|remedies| change(remedies, ["", ""])));
    actions.extend(advice.exceeds_tolerated_cost().then(|| reduce(advice.margin)).flatten());
    match &advice.redesign {
        Some(redesign) if redesign.cost.is_some() => {
            actions
                .push("Use the redesigned controller below, which is ready to paste.".to_owned());
        }
        // A loop that is unstable without imperfections has no cost under this timing.
        None if advice.unstable_motions.is_empty()
            && advice.is_costly()
            && advice.schedule.is_empty() => actions.push(
            "Add `--redesign`, with weights of a cost, for the controller of least cost under this timing."
                .to_owned(),
        ),
        _ => {}
    }
    let holds = advice.deadline_misses.as_ref().is_none_or(DeadlineMisses::holds);
    actions.extend((is_stable && holds).then(|| measure(&advice.budgets)).flatten());
    actions
}

fn budgets(page: &mut Page, advice: &LinearAdvice) {
    page.heading("Budget of each imperfection");
    page.paragraph(format!(
        "{}; sampled every {} s. At a limit the loop becomes unstable (in the mean square for random imperfections), or its cost exceeds \
         the tolerance, while all else is perfect.",
        advice.controller,
        number(advice.period, 4),
    ));
    // Without a tolerance of the cost there is nothing in its column.
    let tolerance = advice.budgets.iter().any(|budget| budget.tolerated_up_to.is_some());
    let [front, back] = [
        &["imperfection", "channel", "stated", "stable up to"][..],
        &["used (%)", "unit", "method"],
    ];
    let tolerated = if tolerance { &["tolerated up to"][..] } else { &[] };
    let mut table = Table::new("budget", &[front, tolerated, back].concat());
    for budget in &advice.budgets {
        let [kind, stated, stable, tolerated, used, unit, how] = budget_row(budget);
        let row = [kind, channel_cell(&budget.channel), stated, stable];
        let tolerated = tolerance.then_some(tolerated);
        table.push(row.into_iter().chain(tolerated).chain([used, unit, how]));
    }
    page.table(&table, 4);
    let later = |budget: &Budget| {
        StabilityWindow::sentence(&budget.name(), &budget.later_windows, budget.unit)
    };
    for windows in advice.budgets.iter().filter_map(later) {
        page.note(format!("{windows}."));
    }
    if let Some(map) = &advice.map {
        page.figure(figure(map));
    }
}

/// The channel of an imperfection, in its column.
pub(super) fn channel_cell(channel: &Option<String>) -> Cell {
    channel.as_deref().unwrap_or("all").into()
}

fn chain(page: &mut Page, advice: &LinearAdvice) {
    if advice.chain.is_empty() {
        return;
    }
    page.heading("Where does the latency come from?");
    page.paragraph(
        "Each part delays the loop by its delay at low frequencies. The phase is that at the frequency at which the loop oscillates when \
         the latency of the channel reaches its limit. The share is the delay over that limit.",
    );
    let columns = ["part", "channel", "delay (s)", "phase (°)", "share of the limit (%)"];
    let mut table = Table::new("latency-chain", &columns);
    for link in &advice.chain {
        let known = |x: Option<f64>| x.map_or_else(|| Cell::absent("—"), |x| Cell::rounded(x, 4));
        table.push([
            link.part.clone().into(),
            link.channel.clone().into(),
            Cell::rounded(link.delay, 4),
            known(link.phase),
            known(link.share.map(|share| 100.0 * share)),
        ]);
    }
    page.table(&table, 4);
    for note in ChainLink::notes(&advice.chain) {
        page.note(format!("{note}."));
    }
}

fn margins(page: &mut Page, advice: &LinearAdvice) {
    if !advice.schedule.is_empty() {
        page.heading("Gain and phase margins");
        page.paragraph(NO_MARGINS);
        return;
    }
    if advice.margins.is_empty() {
        return;
    }
    page.heading("Gain and phase margins");
    page.paragraph(
        "Of the loop opened at one input, with the stated latencies and all other inputs closed.",
    );
    page.table(&margins_table("margins", &advice.margins), 4);
}

/// The margins at each input.
pub(super) fn margins_table(name: &str, margins: &[InputMargins]) -> Table {
    let columns = ["input", "least gain", "most gain", "phase margin (°)", "crossover (Hz)"];
    let mut table = Table::new(name, &columns);
    for margins in margins {
        let known = |x: Option<f64>| x.map_or_else(|| Cell::absent("none"), Cell::from);
        table.push([
            margins.input.clone().into(),
            known(margins.gain_down.map(|x| cut_up(x, 4))),
            known(margins.gain_up.map(cut)),
            known(margins.phase.map(cut)),
            margins.crossover.map_or_else(|| Cell::absent("none"), |x| Cell::rounded(x, 4)),
        ]);
    }
    table
}

fn together(page: &mut Page, advice: &LinearAdvice) {
    let is_stated = advice.unstable_motions.is_empty() || advice.is_stable_as_stated();
    page.heading(match is_stated {
        true => "All imperfections together",
        false => "The loop without imperfections",
    });
    let mut table = Table::new("combined", &["quantity", "value", "method"]);
    let infinite = || Cell::absent("infinite");
    let rounded = |x: Option<f64>, digits| x.map_or_else(infinite, |x| Cell::rounded(x, digits));
    let margin = margin_cell(advice.margin, advice.margin_tried_up_to, advice.growth);
    let ideal = Some(advice.ideal_cost).filter(|cost| cost.is_finite());
    let increase = match (ideal, advice.cost) {
        // Both are infinite, or that of the ideal loop alone.
        (None, _) => Cell::absent("—"),
        _ => rounded(advice.cost_increase, 4),
    };
    let growth = match advice.verdict.outcome {
        Outcome::Unknown if !is_stated => Cell::absent("unknown"),
        _ => Cell::rounded(advice.growth.exp_m1(), 4),
    };
    let lines = [
        ("growth of second moments per period", growth, "exact: E[M ⊗ M]"),
        ("largest common factor of all imperfections", margin, "exact, in proportion"),
        ("cost of the ideal loop", rounded(ideal, 6), "exact: Lyapunov equation"),
        (
            "cost with all imperfections",
            rounded(advice.cost, 6),
            "exact: Lyapunov equation of the jump system",
        ),
        ("ΔJ/J₀", increase, "from the two costs"),
    ];
    // Without imperfections the loop has its growth alone.
    for (what, value, how) in lines.into_iter().take(if is_stated { 5 } else { 1 }) {
        table.push([what.into(), value, how.into()]);
    }
    if let Some(simulated) = &advice.simulated {
        let how = format!(
            "± {}, simulated event by event: {} loops, {} periods",
            number(simulated.error, 2),
            simulated.loops,
            simulated.periods
        );
        let value = Cell::rounded(simulated.cost, 6);
        table.push(["simulated cost, noise constant over a period".into(), value, how.into()]);
        let value = Cell::rounded(simulated.predicted, 6);
        table.push(["predicted cost of this simulation".into(), value, "exact".into()]);
    }
    page.table(&table, 4);
    if advice.deviations.is_empty() {
        return;
    }
    page.heading("Deviations under noise");
    let columns = ["state", "unit", "ideal loop (rms)", "with all imperfections (rms)"];
    let mut table = Table::new("deviations", &columns);
    let unknown = || Cell::absent(advice.no_deviation());
    for deviation in &advice.deviations {
        table.push([
            deviation.state.clone().into(),
            deviation.unit.clone().into(),
            Cell::rounded(deviation.ideal, 4),
            deviation.stated.map_or_else(unknown, |x| Cell::rounded(x, 4)),
        ]);
    }
    page.table(&table, 4);
}

fn plant(page: &mut Page, advice: &LinearAdvice) {
    page.heading("The plant");
    if let Some(point) = &advice.operating_point {
        page.paragraph(point.sentence());
    }
    modes(page, advice);
    if let Some(gain) = &advice.gain {
        let row = |i: usize| -> String {
            let numbers: Vec<String> = gain.row(i).iter().map(|x| format!("{x:.8e}")).collect();
            format!("[{}]", numbers.join(", "))
        };
        let rows: Vec<String> = (0..gain.rows()).map(row).collect();
        page.paragraph("The gain of the state, inputs × states, to paste:");
        page.code(format!("[{}]", rows.join(",\n ")));
    }
    page.paragraph(format!("Command that repeats this advice: `{}`", advice.repeat_command));
}

/// The modes of all states.
fn modes(page: &mut Page, advice: &LinearAdvice) {
    let LinearAdvice { plant_modes, part_modes, .. } = advice;
    let has_parts = !part_modes.is_empty();
    let rates = ["growth rate (1/s)", "frequency (Hz)"];
    let of = if has_parts { &["of"][..] } else { &[] };
    let mut table = Table::new("plant-modes", &[&["mode in"][..], of, &rates].concat());
    let plant = plant_modes.iter().map(|mode| (mode, "plant"));
    for (mode, of) in plant.chain(part_modes.iter().map(|mode| (mode, "lags and filters"))) {
        let names: Vec<&str> = mode.states.iter().map(|(name, _)| name.as_str()).collect();
        let of = has_parts.then(|| Cell::from(of));
        let rates = mode.shown.map(|x| Cell::rounded(x, 4));
        table.push([Cell::from(names.join(", "))].into_iter().chain(of).chain(rates));
    }
    page.table(&table, 4);
}
