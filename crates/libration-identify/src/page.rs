//! An identification as an HTML page.

use libration_report::figure::{Axis, Colors, Figure, Grid, Mark, Panel, Role};
use libration_report::notation::plural;
use libration_report::page::Page;
use libration_report::record::{Cell, Table};
use libration_report::report;

use crate::identification::Identification;
use crate::loop_file::loop_file;
use crate::summary::{interval, seconds, with_unit};

/// The identification as an HTML page.
pub fn page(found: &Identification) -> String {
    let mut page = Page { title: title(found), ..Page::default() };
    page.answer.clone_from(&found.answer);
    page.note(format!("Verdict: {}.", found.verdict));
    for warning in &found.warnings {
        page.note(format!("Warning: {warning}."));
    }
    // Numbers of a response that does not depend on the command mean nothing.
    if found.depends_on_command {
        parameters(&mut page, found);
        fit(&mut page, found);
        // Errors by a model that is not right, or not known to be, mean nothing.
        if found.has_intervals() {
            told_apart(&mut page, found);
        }
        residuals(&mut page, found);
    }
    candidates(&mut page, found);
    if found.depends_on_command && found.has_intervals() {
        repeats(&mut page, found);
    }
    if found.has_loop() {
        page.heading("How is it used?");
        page.paragraph(
            "`libration advise --config loop.toml` computes what this loop tolerates. The file `loop.toml`, as `--save-loop` writes it:",
        );
        page.code(loop_file(found));
    }
    if !found.repeat_command.is_empty() {
        page.heading("How is the identification repeated?");
        page.code(found.repeat_command.clone());
    }
    let sub = format!(
        "{} · {}, one in {} · `libration identify` {}",
        plural(found.commands, "command"),
        plural(found.responses, "response"),
        seconds(found.interval),
        found.libration_version,
    );
    report::render_page(&page, &sub)
}

/// The first numbers of the answer, or the verdict if it is not good.
fn title(found: &Identification) -> String {
    if !found.depends_on_command {
        return format!("Loop that is not identified: {}", found.verdict.outcome);
    }
    let named = found.parameters.iter().filter(|parameter| parameter.unit == "s").take(2);
    let numbers: Vec<String> = named
        .map(|parameter| format!("{} {}", parameter.name, with_unit(parameter.value, "s")))
        .collect();
    let outcome = match found.verdict.is_good() {
        true => String::new(),
        false => format!(" ({})", found.verdict.outcome),
    };
    format!("Identified loop: {}{outcome}", numbers.join(", "))
}

fn parameters(page: &mut Page, found: &Identification) {
    page.heading("What are the parameters?");
    if !found.has_intervals() {
        let mut table = Table::new("parameters", &["number", "estimate", "key"]);
        for parameter in &found.parameters {
            let value = with_unit(parameter.value, &parameter.unit);
            let key = format!("`{}`", parameter.key);
            table.push([parameter.name.clone().into(), value.into(), key.into()]);
        }
        page.table(&table, 4);
        let outcome = found.verdict.outcome;
        page.paragraph(format!("The numbers have no intervals, as the verdict is “{outcome}”."));
        return;
    }
    let mut table =
        Table::new("parameters", &["number", "estimate", "95 % interval", "standard error", "key"]);
    for parameter in &found.parameters {
        table.push([
            parameter.name.clone().into(),
            with_unit(parameter.value, &parameter.unit).into(),
            interval(parameter).into(),
            parameter
                .standard_error
                .map_or_else(String::new, |error| with_unit(error, &parameter.unit))
                .into(),
            format!("`{}`", parameter.key).into(),
        ]);
    }
    page.table(&table, 4);
    page.paragraph(
        "Intervals of times are those of the profile of the likelihood. Standard errors follow from Fisher's information.",
    );
}

fn fit(page: &mut Page, found: &Identification) {
    page.heading("How well does the model follow the response?");
    let fit = &found.fit;
    let response = Panel::new(Axis::linear("time").unit("s"), Axis::linear("response"))
        .mark(Mark::points(fit.time.clone(), fit.response.clone()).radius(1.4).label("response"))
        .mark(Mark::line(fit.time.clone(), fit.model.clone()).role(Role::Theory).label("model"));
    let residual = Panel::new(
        Axis::linear("time").unit("s"),
        Axis::linear("residual over its standard deviation"),
    )
    .mark(Mark::points(fit.time.clone(), fit.residual.clone()).radius(1.2))
    .mark(Mark::horizontal(1.96).label("95 %"))
    .mark(Mark::horizontal(-1.96));
    page.figure(
        Figure::new("fit", "Response and model")
            .caption(
                "Left: the response, and that of the model to the same commands. Right: what is left, without what earlier residuals predict.",
            )
            .panel(response)
            .panel(residual)
            .columns(2),
    );
}

fn told_apart(page: &mut Page, found: &Identification) {
    let Some(map) = &found.likelihood else { return };
    let second = &found.parameters[1];
    page.heading(format!("How well are dead time and {} known apart?", second.name));
    let milliseconds = |values: &[f64]| values.iter().map(|x| x * 1e3).collect::<Vec<f64>>();
    let is_time = second.unit == "s";
    let rows = if is_time { milliseconds(&map.seconds) } else { map.seconds.clone() };
    let deficits: Vec<f64> =
        map.deficits.iter().flatten().map(|deficit| deficit.clamp(0.0, 30.0)).collect();
    let grid = Grid { x: milliseconds(&map.dead_times), y: rows, z: deficits };
    let axis = Axis::linear(second.name.clone());
    let axis = if is_time { axis.unit("ms") } else { axis };
    let scale = if is_time { 1e3 } else { 1.0 };
    let panel = Panel::new(Axis::linear("dead time").unit("ms"), axis)
        .mark(Mark::raster(grid.clone(), Colors::new("2 (ln L_max − ln L)").range(0.0, 30.0)))
        // Of two parameters together: the quantile of chi squared with two degrees of freedom.
        .mark(Mark::contour(grid, [5.991]).label(match map.is_slice {
            true => "95 % region, other parameters at their estimates",
            false => "95 % region",
        }))
        .mark(
            Mark::points([found.parameters[0].value * 1e3], [second.value * scale])
                .label("estimate"),
        );
    page.figure(
        Figure::new("likelihood", "Likelihood of dead time and lag")
            .caption(match found.correlation {
                Some(correlation) => format!(
                    "The errors of both have the correlation {correlation:.2}: at −1 only their sum would be known."
                ),
                None => "The region is that of the likelihood, which is not smooth here: no ellipse has its form.".to_owned(),
            })
            .panel(panel),
    );
    let mut table = Table::new(
        "excitations",
        &[
            "command",
            "standard error of the dead time",
            &format!("of the {}", second.name),
            "correlation",
        ],
    );
    let time = |x: Option<f64>, unit: &str| {
        x.map_or_else(|| Cell::absent("unknown"), |x| with_unit(x, unit).into())
    };
    for row in &found.excitations {
        table.push([
            row.command.clone().into(),
            time(row.dead_time_error, "s"),
            time(row.lag_error, &second.unit),
            row.correlation.map_or_else(|| Cell::absent("—"), |x| Cell::rounded(x, 2)),
        ]);
    }
    page.paragraph(
        "Standard errors with other commands of the same size, in a recording of the same length, predicted by Fisher's information:",
    );
    page.table(&table, 3);
}

fn residuals(page: &mut Page, found: &Identification) {
    page.heading("Do the residuals contradict the model?");
    let tests = &found.residuals;
    let mut table = Table::new("residuals", &["question", "p", "answer"]);
    let mut row = |question: &str, p: f64, bad: &str, good: &str| {
        let answer = if p < crate::CONTRADICTION { bad } else { good };
        table.push([question.into(), Cell::rounded(p, 2), answer.into()]);
    };
    row(
        "Are the residuals independent? (Ljung and Box)",
        tests.whiteness,
        "no: the noise has another colour",
        "nothing contradicts it",
    );
    row(
        "Are they independent of earlier commands?",
        tests.command,
        "no: the response has other dynamics",
        "nothing contradicts it",
    );
    row(
        "Are later commands independent of them?",
        tests.feedback,
        "no: the loop was closed",
        "nothing contradicts it",
    );
    row("Are they normal? (kurtosis)", tests.normality, "no", "nothing contradicts it");
    page.table(&table, 3);
}

fn candidates(page: &mut Page, found: &Identification) {
    page.heading("Which models are candidates?");
    let mut table = Table::new(
        "candidates",
        &[
            "response",
            "hold",
            "noise",
            "arrivals",
            "dead time",
            "lag or time constant",
            "log likelihood",
            "excess of Bayes' criterion",
        ],
    );
    for row in &found.candidates {
        table.push([
            row.response.into(),
            row.hold.name().into(),
            row.noise.name().into(),
            row.arrivals.into(),
            seconds(row.dead_time).into(),
            row.second.map_or_else(|| Cell::absent("—"), |x| seconds(x).into()),
            Cell::rounded(row.log_likelihood, 6),
            Cell::rounded(row.excess, 3),
        ]);
    }
    page.table(&table, 4);
}

fn repeats(page: &mut Page, found: &Identification) {
    if found.bootstrap.is_empty() {
        return;
    }
    page.heading("Do simulated recordings confirm the intervals?");
    let mut table = Table::new(
        "bootstrap",
        &["parameter", "standard deviation", "over that of Fisher's information", "95 % interval"],
    );
    for row in &found.bootstrap {
        let unit = found.parameter(&row.key).map_or("", |parameter| &*parameter.unit);
        table.push([
            format!("`{}`", row.key).into(),
            with_unit(row.standard_deviation, unit).into(),
            row.ratio.map_or_else(|| Cell::absent("—"), |x| Cell::rounded(x, 3)),
            format!("{} to {}", with_unit(row.low, unit), with_unit(row.high, unit)).into(),
        ]);
    }
    page.table(&table, 4);
}
