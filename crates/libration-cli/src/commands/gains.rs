//! `libration gains`.

use std::fmt::Write as _;

use libration_probe::{
    GainReport, ServoIntegrator, ServosDescription, gains, gains_page, parse_printable,
};
use libration_report::notation::number;
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
    let description = described(args)?;
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
    let mut report = gains(&servos, dt, args.substeps, integrator, description.notes);
    report.repeat_command = command_line();
    let text = match args.json {
        true => serde_json::to_string_pretty(&report).map_err(Failure::run)? + "\n",
        false => describe(&report),
    };
    terminal::print(&text)?;
    page.write(|| gains_page(&report))?;
    if report.holds { Ok(()) } else { Err(Failure::Disagreement) }
}

/// The servos of the options.
fn described(args: &GainsArgs) -> Result<ServosDescription, Failure> {
    let numbers =
        |given: &Option<Coordinates>| given.as_ref().map(|numbers| numbers.values().to_vec());
    let parse =
        |text: &str| parse_printable::<ServosDescription>(text).map_err(|error| error.to_string());
    if let Some(path) = &args.mujoco {
        let mut words = vec!["--gains".to_owned()];
        if let Some(keyframe) = &args.keyframe {
            words.extend(["--keyframe".to_owned(), keyframe.clone()]);
        }
        let (_, text) = mujoco::start(&args.python, path, &words, args.timeout, None)?;
        return parse(&text).map_err(Failure::run);
    }
    if let Some(path) = &args.matrices {
        let text = libration_settings::read_text(path).map_err(|error| {
            Failure::usage(format!("cannot read `{}` (--matrices): {error}", path.display()))
        })?;
        return parse(&text).map_err(|why| {
            Failure::usage(format!("cannot use `{}` (--matrices): {why}", path.display()))
        });
    }
    let value = json!({
        "mass": numbers(&args.inertia),
        "kp": numbers(&args.kp),
        "kv": numbers(&args.kv),
        "damping": numbers(&args.damping),
    });
    parse(&value.to_string()).map_err(Failure::usage)
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
        0.0 => "none holds".to_owned(),
        x if x.is_nan() => "-".to_owned(),
        x => rounded(x),
    };
    let known = |x: Option<f64>| x.map_or_else(|| "-".to_owned(), rounded);
    let _ = writeln!(
        text,
        "\n{:<24} {:>12} {:>12} {:>12} {:>10} {:>12} {:>10} {:>12}",
        "joint", "inertia", "kp", "kv", "wh", "largest wh", "damping", "largest kp"
    );
    for joint in &report.joints {
        let _ = writeln!(
            text,
            "{:<24} {:>12} {:>12} {:>12} {:>10} {:>12} {:>10} {:>12}",
            joint.name,
            rounded(joint.inertia),
            rounded(joint.kp),
            rounded(joint.kv),
            rounded(joint.turn),
            limit(joint.largest_turn),
            known(joint.damping_ratio),
            limit(joint.largest_kp)
        );
    }
    let _ = writeln!(
        text,
        "\n{:<36} {:>12} {:>10} {:>10} {:>10} {:>14}",
        "mode in", "Hz", "wh", "damping", "|z|", "added damping"
    );
    for mode in &report.modes {
        let names: Vec<&str> = mode.joints.iter().map(|(name, _)| name.as_str()).collect();
        let _ = writeln!(
            text,
            "{:<36} {:>12} {:>10} {:>10} {:>10} {:>14}",
            names.join(", "),
            rounded(mode.frequency),
            rounded(mode.turn),
            known(mode.damping_ratio),
            rounded(mode.radius),
            known(mode.numerical_damping)
        );
    }
    let _ = writeln!(
        text,
        "\n{:<30} {:<6} {:>18} {:>16}",
        "integrator", "holds", "largest factor", "fewest substeps"
    );
    for row in &report.integrators {
        let _ = writeln!(
            text,
            "{:<30} {:<6} {:>18} {:>16}",
            row.name,
            if row.holds { "yes" } else { "no" },
            limit(row.largest_factor),
            row.fewest_substeps.map_or_else(|| "above 1000".to_owned(), |n| n.to_string())
        );
    }
    let _ = writeln!(text, "repeat with: {}", report.repeat_command);
    text
}
