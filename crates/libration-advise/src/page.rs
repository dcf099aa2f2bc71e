//! Advice as an HTML page.

use libration_report::figure::{Axis, ColorMap, Colors, Dash, Figure, Mark, Marker, Panel, Role};
use libration_report::notation::number;
use libration_report::page::Page;
use libration_report::record::{Cell, Table};
use libration_report::report;
use libration_report::verdict::Outcome;

use super::advice::{Advice, LoopAdvice};
use super::budget::Budget;
use super::first_screen::{actions, budget_bars, budget_numbers, cut, simulated_cost, title};
use super::integrator_choice::IntegratorChoice;
use super::live_setting::{add_live_section, of_advice};
use super::stability_map::StabilityMap;

/// The advice as an HTML page.
pub fn page(advice: &Advice) -> String {
    let is_too_costly = |own: &LoopAdvice| own.exceeds_tolerated_cost(&advice.tolerance);
    let title = match &advice.looped {
        None => title_of_integrators(advice),
        Some(_) if advice.chosen().is_none() && advice.verdict.outcome == Outcome::Exceeds => {
            "The loop is stable, but no integrator keeps the tolerance".to_owned()
        }
        Some(looped) => title(advice.verdict.outcome, looped.is_in_window()).to_owned(),
    };
    let mut page = Page { title, ..Page::default() };
    page.answer.clone_from(&advice.answer);
    add_live_section(&mut page, of_advice(advice), advice.verdict.outcome);
    for warning in &advice.warnings {
        page.note(format!("Warning: {warning}."));
    }
    if let Some(looped) = &advice.looped {
        page.highlights = budget_numbers(&looped.budgets);
        page.highlights.truncate(3);
        page.highlights.extend(looped.combined.simulated.as_ref().map(simulated_cost));
        page.bars = budget_bars(&looped.budgets);
        page.actions = actions(looped, is_too_costly(looped));
        of_loop(&mut page, looped, advice.map.as_ref());
    }
    integrators(&mut page, advice);
    let parameters: Vec<String> =
        advice.parameters.iter().map(|(name, value)| format!("{name} = {value}")).collect();
    let place = if advice.looped.is_some() { "held at" } else { "from" };
    let sub = format!(
        "{} ({}), {place} q = {:?}, v = {:?} · {} ≤ {} · {} s · `{}`",
        advice.system,
        parameters.join(", "),
        advice.q,
        advice.v,
        advice.tolerance.of,
        number(advice.tolerance.most, 3),
        number(advice.horizon, 4),
        advice.repeat_command,
    );
    report::render_page(&page, &sub)
}

/// The verdict on the integrators, as a title.
fn title_of_integrators(advice: &Advice) -> String {
    match (advice.verdict.outcome, advice.chosen()) {
        (Outcome::Within, Some((choice, dt))) => {
            let dt = number(cut(dt), 4);
            format!("{} in steps of {dt} s keeps the tolerance", choice.integrator)
        }
        (Outcome::Exceeds, _) => "No integrator keeps the tolerance".to_owned(),
        _ => "Whether an integrator keeps the tolerance is unknown".to_owned(),
    }
}

fn of_loop(page: &mut Page, looped: &LoopAdvice, map: Option<&StabilityMap>) {
    if looped.budgets.is_empty() {
        // An unstable loop has no limits, but a map of what stabilises it.
        map.into_iter().for_each(|map| page.figure(figure(map)));
        return;
    }
    page.heading("Budget of each imperfection");
    page.paragraph(format!(
        "{}; sampled every {} s; a constant {} of {} {} holds the operating point. At a limit the loop, in exact steps of a \
         period, becomes unstable (in the mean square for random imperfections), or its cost exceeds the tolerance.",
        looped.controller,
        number(looped.period, 4),
        looped.command,
        number(looped.held_command, 4),
        looped.command_unit
    ));
    let columns =
        ["imperfection", "stated", "stable up to", "tolerated up to", "used (%)", "unit", "method"];
    let mut table = Table::new("budget", &columns);
    for budget in &looped.budgets {
        table.push(budget_row(budget));
    }
    page.table(&table, 4);
    page.paragraph(
        "Each command computes the growth at a limit, or at the largest tried size. At a limit of stability the growth is zero.",
    );
    for budget in &looped.budgets {
        page.paragraph(format!("`{}`", budget.command));
    }
    if let Some(map) = map {
        page.figure(figure(map));
    }
    page.heading("All imperfections together");
    let combined = &looped.combined;
    let mut table = Table::new("combined", &["quantity", "value", "method"]);
    let mut line = |what: &str, value: Cell, how: &str| {
        table.push([what.into(), value, how.into()]);
    };
    line(
        "growth of second moments per period",
        Cell::rounded(combined.growth.exp_m1(), 4),
        "exact: E[M ⊗ M]",
    );
    let margin = margin_cell(combined.margin, combined.margin_tried_up_to, combined.growth);
    line("largest common factor of all imperfections", margin, "exact, in proportion");
    let infinite = || Cell::absent("infinite");
    line(
        "cost of the ideal loop",
        match combined.ideal_cost.is_finite() {
            true => Cell::rounded(combined.ideal_cost, 6),
            false => infinite(),
        },
        "exact: Lyapunov equation",
    );
    line(
        "cost with all imperfections",
        combined.cost.map_or_else(infinite, |cost| Cell::rounded(cost, 6)),
        "exact: Lyapunov equation of the jump system",
    );
    line(
        "ΔJ/J₀",
        combined.cost_increase.map_or_else(infinite, |rise| Cell::rounded(rise, 4)),
        "from the two costs",
    );
    if let Some(simulated) = &combined.simulated {
        line(
            "simulated cost without commands, noise constant over a period",
            Cell::rounded(simulated.cost, 6),
            &format!(
                "± {}, simulated: {} loops, {} periods",
                number(simulated.error, 2),
                simulated.loops,
                simulated.periods
            ),
        );
        line("predicted cost of this simulation", Cell::rounded(simulated.predicted, 6), "exact");
    }
    if let Some(returns) = &combined.region_of_attraction {
        line(
            "largest distance of return",
            cut(returns.up_to).into(),
            &format!(
                "simulated up to {}: of {} starts at a distance of {}, {} return",
                number(returns.tried_up_to, 3),
                returns.returned[1],
                number(returns.deviation, 3),
                returns.returned[0]
            ),
        );
    }
    page.table(&table, 4);
}

/// The largest common factor of all imperfections of a loop whose second moments grow at this rate.
pub(super) fn margin_cell(margin: Option<f64>, tried_up_to: Option<f64>, growth: f64) -> Cell {
    match (margin, tried_up_to) {
        (Some(margin), _) => cut(margin).into(),
        (None, Some(tried)) => Cell::absent(format!("at least {}", number(cut(tried), 4))),
        (None, None) if growth < 0.0 => Cell::absent("not searched"),
        (None, None) => Cell::absent("none: the loop is unstable"),
    }
}

/// The row of a budget in its table.
pub(super) fn budget_row(budget: &Budget) -> [Cell; 7] {
    let limit = |limit: Option<f64>| {
        limit.map_or_else(|| Cell::absent(budget.limit_in_words(None)), |limit| cut(limit).into())
    };
    [
        budget.kind.name().into(),
        budget.stated.into(),
        limit(budget.stable_up_to),
        budget.tolerated_up_to.map_or_else(|| Cell::absent(""), limit),
        match (budget.used, budget.regained) {
            (_, Some(_)) => Cell::absent("regained"),
            (Some(used), None) => Cell::rounded(100.0 * used, 3),
            (None, None) => Cell::absent("—"),
        },
        budget.unit.into(),
        budget.how.into(),
    ]
}

/// The stability map as a figure.
pub(super) fn figure(map: &StabilityMap) -> Figure {
    let grid = map.growth.clone();
    // The colours saturate at three times the mean growth.
    let sizes = grid.z.iter().filter(|z| z.is_finite()).map(|z| z.abs());
    let reach = (3.0 * sizes.sum::<f64>() / grid.z.len() as f64).clamp(1e-6, 1.0);
    let mut shown = grid.clone();
    shown.z.iter_mut().for_each(|z| *z = z.clamp(-reach, reach));
    let colors =
        Colors::new("growth per period, ln ρ").map(ColorMap::Diverging).range(-reach, reach);
    let last = grid.x.last().copied().unwrap_or(1.0);
    let panel = Panel::new(
        Axis::linear("latency of the command").unit("s").range(0.0, last),
        Axis::log("factor of all gains").range(0.25, 4.0),
    )
    .mark(Mark::raster(shown, colors))
    .mark(
        Mark::contour(grid, [0.0]).role(Role::Theory).dash(Dash::Solid).label("edge of stability"),
    )
    .mark(
        Mark::points([map.latency], [1.0])
            .role(Role::Neutral)
            .marker(Marker::Circle)
            .radius(5.0)
            .label("as stated"),
    );
    Figure::new("stability-map", "Stability of the loop over latency and gain")
        .caption("Blue: decay; red: growth; in exact steps of a period, without jitter and losses.")
        .description(
            "A map of the growth of the loop over latency and gain, with the operating point.",
        )
        .panel(panel)
}

/// The words in place of a step that meets the tolerance.
fn none_down_to(choice: &IntegratorChoice) -> String {
    match choice.tried_down_to {
        Some(shortest) => format!("none tried, down to {}", number(shortest, 2)),
        None => "none tried".to_owned(),
    }
}

fn integrators(page: &mut Page, advice: &Advice) {
    if advice.integrators.is_empty() {
        return;
    }
    page.heading("Integrator, step and float type");
    if let Some(why) = &advice.runner_up {
        page.paragraph(format!("Runner-up: {why}."));
    }
    if let Some(command) = &advice.command {
        let what = if advice.looped.is_some() {
            "Command that repeats this advice"
        } else {
            "Command that takes these steps"
        };
        page.paragraph(format!("{what}: `{command}`"));
    }
    let columns = [
        "integrator",
        "largest step (s)",
        "steps per period",
        "error",
        "error with the next longer step",
        "force evaluations per second",
    ];
    let mut table = Table::new("integrators", &columns);
    let known = |x: Option<f64>, words: &str| x.map_or_else(|| Cell::absent(words), Cell::from);
    for choice in &advice.integrators {
        table.push([
            choice.integrator.into(),
            known(choice.dt, &none_down_to(choice)),
            choice.substeps.map_or_else(|| Cell::absent(""), Cell::from),
            choice.lost.into(),
            known(choice.lost_beyond, ""),
            known(choice.evaluations, ""),
        ]);
    }
    page.table(&table, 4);
    if !advice.floats.is_empty() {
        let mut table = Table::new("float types", &["float type", "error", "tolerated"]);
        for float in &advice.floats {
            let meets = if float.meets { "yes" } else { "no" };
            table.push([float.float.into(), float.lost.into(), meets.into()]);
        }
        page.table(&table, 4);
    }
    if let Some(throughput) = &advice.throughput {
        page.paragraph(format!(
            "On this machine one core takes {} such steps of the plant per second with {} trajectories at a time (measured now); a rollout \
             of {} steps of each takes {} MB in `f32`.",
            number(throughput.steps_a_second, 3),
            throughput.trajectories,
            throughput.steps,
            number(throughput.bytes as f64 / 1e6, 4)
        ));
    }
}
