//! A report on gains as an HTML page.

use libration_report::notation::{number, plural};
use libration_report::page::Page;
use libration_report::record::{Cell, Table};
use libration_report::report;

use super::first_screen::{actions, bars, numbers, title};
use super::{GainReport, MeasuredGains, ServoIntegrator, ServoMode, Torque};

/// The report as an HTML page.
pub fn gains_page(report: &GainReport) -> String {
    let mut page = Page { title: title(report).into(), ..Page::default() };
    page.answer.clone_from(&report.answer);
    page.highlights = numbers(report);
    page.bars = bars(report);
    page.actions = actions(report);
    for note in &report.notes {
        page.note(format!("{note}."));
    }
    let limit = |x: f64, digits| match x {
        f64::INFINITY => Cell::absent("no limit"),
        0.0 => Cell::absent("none found"),
        x if x.is_nan() => Cell::absent("—"),
        x => Cell::rounded(x, digits),
    };
    let known = |x: Option<f64>| x.map_or_else(|| Cell::absent("—"), |x| Cell::rounded(x, 4));
    let is_measured = report.measured.is_some();
    page.heading(match is_measured {
        true => "What is each joint alone?",
        false => "How much does each joint allow?",
    });
    page.paragraph(format!(
        "ω, its limit and the damping ratio are those of the joint alone: ω² is its stiffness, with that of the gain of position, divided by \
         its inertia; h is the length of a {}.{}",
        match report.torque {
            Torque::Held => "step, through which torques are held",
            Torque::EachSubstep => "substep",
        },
        match is_measured {
            true => " kp and kv have the stiffness and the damping of the joint, too.",
            false => {
                " The largest gains are those with all couplings and with all other gains as they are."
            }
        }
    ));
    let columns = [
        "joint",
        "inertia",
        "kp",
        "kv",
        "ωh",
        "largest ωh",
        "damping ratio",
        "largest kp",
        "largest kv",
    ];
    // The limits of a measured step are those of each servo, in the next table.
    let count = if is_measured { columns.len() - 2 } else { columns.len() };
    let mut table = Table::new("joints", &columns[..count]);
    for joint in &report.joints {
        let row = [
            joint.name.clone().into(),
            Cell::rounded(joint.inertia, 4),
            Cell::rounded(joint.kp, 4),
            Cell::rounded(joint.kv, 4),
            Cell::rounded(joint.turn, 4),
            limit(joint.largest_turn, 4),
            known(joint.damping_ratio),
            limit(joint.largest_kp, 5),
            limit(joint.largest_kv, 5),
        ];
        table.push(row.into_iter().take(count));
    }
    page.table(&table, 5);
    if let Some(measured) = &report.measured {
        measured_tables(&mut page, measured, limit);
    }
    page.heading(match is_measured {
        true => "What does the servo model predict, without contacts and constraints?",
        false => "What do all joints do together?",
    });
    let columns =
        ["mode in", "frequency (Hz)", "ωh", "damping ratio", "|z|", "damping that the step adds"];
    let mut table = Table::new("modes", &columns);
    for mode in &report.modes {
        let names: Vec<&str> = mode.joints.iter().map(|(name, _)| name.as_str()).collect();
        table.push([
            names.join(", ").into(),
            Cell::rounded(mode.frequency, 4),
            Cell::rounded(mode.turn, 4),
            known(mode.damping_ratio),
            factors(mode).into(),
            known(mode.numerical_damping),
        ]);
    }
    page.table(&table, 5);
    page.heading(match is_measured {
        true => {
            "Which integrator holds the gains in the servo model, without contacts and constraints?"
        }
        false => "Which integrator holds the gains?",
    });
    let columns =
        ["integrator", "in words", "holds", "largest factor of kp", "fewest substeps", "|z|"];
    let mut table = Table::new("integrators", &columns);
    for row in &report.integrators {
        table.push([
            row.name.into(),
            row.title.clone().into(),
            row.answer().into(),
            limit(row.largest_factor, 5),
            row.fewest_substeps
                .map_or_else(|| Cell::absent(row.substeps()), |n| Cell::rounded(f64::from(n), 4)),
            Cell::rounded(row.spectral_radius, 5),
        ]);
    }
    page.table(&table, 5);
    if !report.repeat_command.is_empty() {
        page.heading("How is the report repeated?");
        page.code(report.repeat_command.clone());
    }
    let sub = format!(
        "{} · {} · {} of {} s · `libration gains` {}",
        plural(report.joints.len(), "joint"),
        ServoIntegrator::label(report.integrator),
        plural(report.substeps as usize, "substep"),
        number(report.dt / f64::from(report.substeps), 4),
        env!("CARGO_PKG_VERSION"),
    );
    report::render_page(&page, &sub)
}

/// Limits and modes of the measured step.
fn measured_tables(page: &mut Page, measured: &MeasuredGains, limit: impl Fn(f64, usize) -> Cell) {
    page.heading("What does the step of the simulator do with each servo?");
    page.paragraph(
        "The step was measured with contacts, limits and constraints as they are at the point. A largest gain is that with all others as \
         they are.",
    );
    let mut table = Table::new("servos", &["servo", "kp", "largest kp", "kv", "largest kv"]);
    for servo in &measured.servos {
        table.push([
            servo.name.clone().into(),
            Cell::rounded(servo.kp, 4),
            limit(servo.largest_kp, 5),
            Cell::rounded(servo.kv, 4),
            limit(servo.largest_kv, 5),
        ]);
    }
    if !measured.servos.is_empty() {
        page.table(&table, 5);
    }
    let columns = ["mode in", "|z|", "growth rate (1/s)", "of the system (1/s)", "frequency (Hz)"];
    let mut table = Table::new("measured modes", &columns);
    // Of a step without a derivative an error hides each rate.
    let rate = |x: f64| match measured.is_differentiable {
        true => Cell::rounded(x, 5),
        false => Cell::absent("unknown"),
    };
    for mode in &measured.modes {
        let flow = mode.flow.map(|flow| rate(flow.growth_rate));
        table.push([
            mode.names().into(),
            Cell::rounded(mode.radius, 7),
            rate(mode.step.growth_rate),
            flow.unwrap_or_else(|| Cell::absent("—")),
            rate(mode.step.frequency),
        ]);
    }
    page.table(&table, 5);
}

/// The sizes of the factors of a mode, the largest first.
fn factors(mode: &ServoMode) -> String {
    mode.radii.iter().map(|radius| number(*radius, 5)).collect::<Vec<_>>().join(", ")
}
