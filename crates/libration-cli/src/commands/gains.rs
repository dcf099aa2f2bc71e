//! `libration gains`.

use std::fmt::Write as _;

use libration_probe::{
    ChildProcess, GainReport, MeasuredGains, ServoIntegrator, ServosDescription, Torque, gains,
    gains_page, parse_printable,
};
use libration_report::notation::{cut_off, number};
use libration_report::verdict::exit_code;
use serde_json::json;

use super::mujoco;
use super::repeat_command::command_line;
use super::result_file::ResultFile;
use crate::args::{Coordinates, GainsArgs};
use crate::error::Failure;
use crate::terminal;

/// Whether gains hold: prints the report.
pub(crate) fn run(args: &GainsArgs) -> Result<(), Failure> {
    let page = ResultFile::create("--page", args.page.as_deref())?;
    let (mut description, mut child) = described(args)?;
    if args.held_torque {
        description.torque = Torque::Held;
    }
    let servos =
        description.servos().map_err(|error| Failure::usage(named(args, &error.to_string())))?;
    let Some(dt) = args.dt.or(description.dt) else {
        return Err(Failure::usage(
            "--dt is missing; expected the time step of the simulator in s",
        ));
    };
    let integrator = match (args.integrator, &description.integrator) {
        (Some(integrator), _) => integrator,
        (None, None) => ServoIntegrator::SYMPLECTIC_EULER,
        (None, Some(name)) => ServoIntegrator::from_name(name).ok_or_else(|| {
            Failure::usage(format!(
                "the integrator of the model is {name}, which is not known here; expected --integrator"
            ))
        })?,
    };
    let mut report = gains(&servos, dt, args.substeps, integrator, description.notes)
        .with_inert_servos(description.saturated, description.idle)
        .with_other_forces(description.other_forces);
    // Torques that a simulator holds are not those of its own servos.
    let step = description.step.filter(|_| !args.held_torque);
    if let (Some(child), Some(step)) = (&mut child, step) {
        let subject = step.subject().map_err(Failure::run)?;
        let measured = MeasuredGains::measure(child, &subject, &description.servos, args.substeps)
            .map_err(Failure::run)?;
        report = report.with_measured(measured);
    } else if args.mujoco.is_some() {
        report.answer = format!("By a servo model, not by a measured step: {}", report.answer);
    }
    report.repeat_command = command_line();
    let text = match args.json {
        true => serde_json::to_string_pretty(&report).map_err(Failure::run)? + "\n",
        false => describe(&report),
    };
    terminal::print(&text)?;
    page.write(|| gains_page(&report))?;
    if exit_code([&report.verdict]) == 0 { Ok(()) } else { Err(Failure::Disagreement) }
}

/// The servos of the options, and the program that steps them, if there is one.
fn described(args: &GainsArgs) -> Result<(ServosDescription, Option<ChildProcess>), Failure> {
    let numbers =
        |given: &Option<Coordinates>| given.as_ref().map(|numbers| numbers.values().to_vec());
    let parse =
        |text: &str| parse_printable::<ServosDescription>(text).map_err(|error| error.to_string());
    if let Some(path) = &args.mujoco {
        let mut words = vec!["--gains".to_owned()];
        let mut option = |name: &str, value: Option<String>| {
            words.extend(value.into_iter().flat_map(|value| [format!("--{name}"), value]));
        };
        option("keyframe", args.keyframe.clone());
        option("dt", args.dt.map(|dt| format!("{dt:?}")));
        option("integrator", args.integrator.map(|integrator| integrator.name().to_owned()));
        option("substeps", Some(args.substeps.to_string()));
        if args.settle {
            words.push("--settle".into());
        }
        let (child, text) = mujoco::start(&args.python, path, &words, args.timeout, None)?;
        return Ok((parse(&text).map_err(Failure::run)?, Some(child)));
    }
    if let Some(path) = &args.matrices {
        let text = libration_settings::read_text(path).map_err(|error| {
            Failure::usage(format!("cannot read `{}` (--matrices): {error}", path.display()))
        })?;
        let description = parse(&text).map_err(|why| {
            Failure::usage(format!("cannot use `{}` (--matrices): {why}", path.display()))
        })?;
        return Ok((description, None));
    }
    let value = json!({
        "mass": numbers(&args.inertia),
        "kp": numbers(&args.kp),
        "kv": numbers(&args.kv),
        "damping": numbers(&args.damping),
    });
    Ok((parse(&value.to_string()).map_err(Failure::usage)?, None))
}

/// A field of servos as the option that sets it.
fn named(args: &GainsArgs, message: &str) -> String {
    if args.inertia.is_none() {
        return message.to_owned();
    }
    let message = message.replace("`mass`", "--inertia");
    ["kp", "kv", "damping"].iter().fold(message, |message, field| {
        message.replace(&format!("`{field}`"), &format!("--{field}"))
    })
}

fn rounded(x: f64) -> String {
    number(x, 6)
}

/// Returns the report as text.
fn describe(report: &GainReport) -> String {
    let mut text = format!("{}\n", report.answer);
    for note in &report.notes {
        let _ = writeln!(text, "note: {note}");
    }
    let limit = |x: f64| match x {
        f64::INFINITY => "no limit".to_owned(),
        0.0 => "none found".to_owned(),
        x if x.is_nan() => "-".to_owned(),
        x => number(cut_off(x, 6), 6),
    };
    let known = |x: Option<f64>| x.map_or_else(|| "-".to_owned(), rounded);
    let _ = writeln!(
        text,
        "\n{:<24} {:>12} {:>12} {:>12} {:>10} {:>12} {:>10} {:>12} {:>12}",
        "joint", "inertia", "kp", "kv", "wh", "largest wh", "damping", "largest kp", "largest kv"
    );
    // The limits of a measured step are those of servos, whose gains are not those of joints.
    let own_limit = |x: f64| if report.measured.is_some() { f64::NAN } else { x };
    for joint in &report.joints {
        let _ = writeln!(
            text,
            "{:<24} {:>12} {:>12} {:>12} {:>10} {:>12} {:>10} {:>12} {:>12}",
            joint.name,
            rounded(joint.inertia),
            rounded(joint.kp),
            rounded(joint.kv),
            rounded(joint.turn),
            limit(joint.largest_turn),
            known(joint.damping_ratio),
            limit(own_limit(joint.largest_kp)),
            limit(own_limit(joint.largest_kv))
        );
    }
    if let Some(measured) = &report.measured {
        measured_tables(measured, limit, &mut text);
    }
    let _ = writeln!(
        text,
        "\n{:<36} {:>12} {:>10} {:>10} {:>18} {:>14}",
        if report.measured.is_some() { "mode of the servo model" } else { "mode in" },
        "Hz",
        "wh",
        "damping",
        "|z|",
        "added damping"
    );
    for mode in &report.modes {
        let names: Vec<&str> = mode.joints.iter().map(|(name, _)| name.as_str()).collect();
        let _ = writeln!(
            text,
            "{:<36} {:>12} {:>10} {:>10} {:>18} {:>14}",
            names.join(", "),
            rounded(mode.frequency),
            rounded(mode.turn),
            known(mode.damping_ratio),
            mode.radii.iter().map(|radius| rounded(*radius)).collect::<Vec<_>>().join(", "),
            known(mode.numerical_damping)
        );
    }
    let _ = writeln!(
        text,
        "\n{:<30} {:<6} {:>18} {:>16}",
        if report.measured.is_some() { "integrator of the servo model" } else { "integrator" },
        "holds",
        "largest factor",
        "fewest substeps"
    );
    for row in &report.integrators {
        let _ = writeln!(
            text,
            "{:<30} {:<6} {:>18} {:>16}",
            row.name,
            row.answer(),
            limit(row.largest_factor),
            row.substeps()
        );
    }
    let _ = writeln!(text, "repeat with: {}", report.repeat_command);
    text
}

/// Adds the limits of servos and the modes of the measured step.
fn measured_tables(measured: &MeasuredGains, limit: impl Fn(f64) -> String, text: &mut String) {
    let _ = writeln!(
        text,
        "\n{:<36} {:>12} {:>12} {:>12} {:>12}",
        "servo, in the measured step", "kp", "largest kp", "kv", "largest kv"
    );
    for servo in &measured.servos {
        let _ = writeln!(
            text,
            "{:<36} {:>12} {:>12} {:>12} {:>12}",
            servo.name,
            rounded(servo.kp),
            limit(servo.largest_kp),
            rounded(servo.kv),
            limit(servo.largest_kv)
        );
    }
    let _ = writeln!(
        text,
        "\n{:<36} {:>12} {:>12} {:>12} {:>12}",
        "mode of the measured step", "|z|", "growth 1/s", "of system", "freq. Hz"
    );
    let rate = |x: f64| match measured.is_differentiable {
        true => rounded(x),
        false => "unknown".to_owned(),
    };
    for mode in &measured.modes {
        let of_system = mode.flow.map(|flow| flow.growth_rate);
        let _ = writeln!(
            text,
            "{:<36} {:>12} {:>12} {:>12} {:>12}",
            mode.names(),
            number(mode.radius, 8),
            rate(mode.step.growth_rate),
            of_system.map_or_else(|| "-".to_owned(), rate),
            rate(mode.step.frequency)
        );
    }
}
