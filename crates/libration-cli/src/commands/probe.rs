//! `libration probe`.

use std::fmt::Write as _;
use std::path::Path;

use libration::linear::Signal;
use libration_advise::rounded;
use libration_probe::{
    BlackBox, ChildProcess, Description, MatrixStep, ProbeReport, Subject, page, probe,
};
use libration_settings::linear_loop::read_plant;

use super::advise::command_line;
use super::mujoco;
use super::page_file::PageFile;
use crate::args::{Coordinates, ProbeArgs};
use crate::error::Failure;
use crate::terminal;

/// Audits the step of a simulator and prints the report.
pub(crate) fn run(args: &ProbeArgs, quiet: bool) -> Result<(), Failure> {
    let file = PageFile::create(args.page.as_deref())?;
    let (mut black_box, mut subject) = simulator(args)?;
    subject.invocation = command_line();
    if args.moving {
        subject.equilibrium = Some(false);
    }
    subject.is_conservative |= args.conservative;
    subject.check().map_err(|error| Failure::usage(named(&error.to_string())))?;
    if !quiet {
        terminal::say(&format!("auditing the step of {}", subject.title));
    }
    let report = probe(black_box.as_mut(), &subject).map_err(Failure::run)?;
    let text = match args.json {
        true => serde_json::to_string_pretty(&report).map_err(Failure::run)? + "\n",
        false => describe(&report),
    };
    terminal::print(&text)?;
    file.write(|| page(&report))?;
    if report.holds() { Ok(()) } else { Err(Failure::Disagreement) }
}

/// A field of a subject as the option that sets it.
fn named(message: &str) -> String {
    let options = ["state_scale", "action_scale", "state", "action", "dt"];
    let with = |message: String, field: &&str| {
        message.replace(&format!("`{field}`"), &format!("--{}", field.replace('_', "-")))
    };
    let message = options.iter().fold(message.to_owned(), with);
    message.replace("`states`", "--state-names").replace("`inputs`", "--action-names")
}

/// The simulator of the options.
fn simulator(args: &ProbeArgs) -> Result<(Box<dyn BlackBox>, Subject), Failure> {
    match (&args.command, &args.mujoco, &args.matrices) {
        (Some(words), _, _) => {
            let subject = described(args, &words.0.join(" "))?;
            let child = ChildProcess::start(&words.0, args.timeout)
                .map_err(|error| Failure::usage(format!("{error} (--command)")))?;
            Ok((Box::new(child), subject))
        }
        (_, Some(path), _) => mujoco_model(args, path),
        (_, _, Some(path)) => matrices(args, path),
        _ => Err(Failure::usage("expected --command, --mujoco or --matrices")),
    }
}

/// The subject of `--command`.
fn described(args: &ProbeArgs, title: &str) -> Result<Subject, Failure> {
    let numbers =
        |option: &Option<Coordinates>| option.as_ref().map(|numbers| numbers.values().to_vec());
    let Some(state) = numbers(&args.state) else {
        return Err(Failure::usage(
            "--command is given without --state; expected a number for each state",
        ));
    };
    let Some(dt) = args.dt else {
        return Err(Failure::usage("--command is given without --dt; expected a time step in s"));
    };
    let mut subject = Subject::new(title, state, numbers(&args.action).unwrap_or_default(), dt);
    subject.has_fixed_dt = args.fixed_dt;
    let signals = |names: &[String]| names.iter().map(|name| Signal::parse(name)).collect();
    if !args.state_names.is_empty() {
        subject.states = signals(&args.state_names);
    }
    if !args.action_names.is_empty() {
        subject.inputs = signals(&args.action_names);
    }
    if let Some(scale) = numbers(&args.state_scale) {
        subject.state_scale = scale;
    }
    if let Some(scale) = numbers(&args.action_scale) {
        subject.action_scale = scale;
    }
    subject.check().map_err(|error| Failure::usage(named(&error.to_string())))?;
    Ok(subject)
}

/// A MuJoCo model, stepped by a Python program.
fn mujoco_model(args: &ProbeArgs, path: &Path) -> Result<(Box<dyn BlackBox>, Subject), Failure> {
    let mut options = Vec::new();
    let mut option = |name: &str, value: Option<String>| {
        options.extend(value.into_iter().flat_map(|value| [format!("--{name}"), value]));
    };
    option("keyframe", args.keyframe.clone());
    option("dt", args.dt.map(|dt| format!("{dt:?}")));
    if args.settle {
        options.push("--settle".into());
    }
    let (mut child, text) = mujoco::start(&args.python, path, &options, args.timeout)?;
    let description = Description::parse(&text).map_err(Failure::run)?;
    child.set_energy(description.energy);
    Ok((Box::new(child), description.subject().map_err(Failure::run)?))
}

/// Matrices of a step.
fn matrices(args: &ProbeArgs, path: &Path) -> Result<(Box<dyn BlackBox>, Subject), Failure> {
    let wrong = |why: String| {
        Failure::usage(format!("cannot use `{}` (--matrices): {why}", path.display()))
    };
    let plant =
        read_plant(path).map_err(wrong)?.plant().map_err(|fault| wrong(fault.to_string()))?;
    let Some(dt) = plant.sampling_period else {
        return Err(wrong(
            "it is a plant in continuous time; expected the matrices of a step, with `dt` in s; help: `libration analyze --plant` has the modes of a plant".into(),
        ));
    };
    let values = |option: &Option<Coordinates>, count| {
        option.as_ref().map_or_else(|| vec![0.0; count], |numbers| numbers.values().to_vec())
    };
    let (n, m) = (plant.a.rows(), plant.b.columns());
    let (state, action) = (values(&args.state, n), values(&args.action, m));
    for (option, given, count) in [("state", state.len(), n), ("action", action.len(), m)] {
        if given != count {
            return Err(Failure::usage(format!(
                "--{option} has {given} numbers; expected {count}"
            )));
        }
    }
    let mut subject = Subject::new(&path.display().to_string(), state, action, dt);
    subject.states = plant.states;
    subject.inputs = plant.inputs;
    subject.has_fixed_dt = true;
    subject.equilibrium = Some(false).filter(|_| args.state.is_some());
    Ok((Box::new(MatrixStep { a: plant.a, b: plant.b }), subject))
}

/// Returns the report as text.
fn describe(report: &ProbeReport) -> String {
    let mut text = format!("{}\n", report.answer);
    for finding in &report.findings {
        let kind = if finding.is_fault { "fault" } else { "warning" };
        let _ = writeln!(text, "{kind}: {}: {}", finding.kind, finding.text);
    }
    for note in &report.notes {
        let _ = writeln!(text, "note: {note}");
    }
    modes(report, &mut text);
    latency(report, &mut text);
    integrator(report, &mut text);
    if let Some(defects) = &report.defects {
        let _ = writeln!(
            text,
            "\nphase-space volume: {} 1/s, of the system {}",
            rounded(defects.volume_rate),
            known(defects.flow_volume_rate)
        );
        let _ = writeln!(
            text,
            "defects: of symplecticity {}, of reversibility {} (with half the step {})",
            known(defects.symplecticity),
            known(defects.reversibility),
            known(defects.reversibility_halved)
        );
        if let Some(energy) = &defects.energy {
            let _ = writeln!(
                text,
                "energy: {} 1/s over {} steps; {}",
                rounded(energy.rate),
                energy.steps,
                energy.reason.text()
            );
        }
    }
    let same = report.bits.checks.iter().filter(|check| check.difference.is_none());
    let names: Vec<&str> = same.map(|check| check.name.as_str()).collect();
    if !names.is_empty() {
        let _ = writeln!(text, "the same bits: {}", names.join("; "));
    }
    if let Some(confirmation) = &report.confirmation {
        let _ = writeln!(
            text,
            "linearised with a relative error of {:.1e}; a run of {} steps follows to {:.1e}",
            report.jacobian_error, confirmation.steps, confirmation.error
        );
    }
    if let Some(reference) = &report.reference {
        let _ = writeln!(
            text,
            "the matrices of {} agree to {:.1e}",
            reference.source, reference.difference
        );
    }
    let _ = writeln!(text, "repeat with: {}", report.repeat_command);
    text
}

fn known(x: Option<f64>) -> String {
    x.map_or_else(|| "-".to_owned(), rounded)
}

fn modes(report: &ProbeReport, text: &mut String) {
    if report.modes.is_empty() {
        return;
    }
    let _ = writeln!(
        text,
        "\n{:<36} {:>11} {:>12} {:>12} {:>12} {:>12} {:>12}",
        "mode in", "|z|", "growth 1/s", "of system", "freq. Hz", "of system", "num. damping"
    );
    for mode in &report.modes {
        let flow = mode.flow;
        let _ = writeln!(
            text,
            "{:<36} {:>11.8} {:>12} {:>12} {:>12} {:>12} {:>12}",
            mode.names(),
            mode.radius,
            rounded(mode.step.growth_rate),
            known(flow.map(|flow| flow.growth_rate)),
            rounded(mode.step.frequency),
            known(flow.map(|flow| flow.frequency)),
            known(mode.numerical_damping)
        );
    }
}

fn latency(report: &ProbeReport, text: &mut String) {
    for latency in &report.hidden_latency {
        let by = latency.state.as_deref().unwrap_or("-");
        let _ = writeln!(
            text,
            "\nlatency of {}: {} steps late; the integrator delays it by {} s (phase of {by})",
            latency.input,
            rounded(latency.late_steps),
            known(latency.integrator_delay)
        );
    }
}

fn integrator(report: &ProbeReport, text: &mut String) {
    let (Some(order), Some(recognition)) = (&report.order, &report.recognition) else { return };
    let estimates: Vec<String> = order.estimates.iter().map(|x| format!("{x:.3}")).collect();
    let _ = writeln!(text, "\norder by halved steps: {}", estimates.join(", "));
    let all = [
        ("by results", Some(&recognition.by_results)),
        ("by matrix", recognition.by_matrix.as_ref()),
    ];
    for (by, found) in all {
        let Some(found) = found else { continue };
        let _ = writeln!(text, "{:<32} {:>12}", format!("integrator, {by}"), "distance");
        // The rest is on the page.
        for candidate in found.candidates.iter().take(4) {
            let agrees = if found.methods.contains(&candidate.method) { "agrees" } else { "" };
            let _ = writeln!(
                text,
                "  {:<30} {:>12} {agrees}",
                candidate.method,
                format!("{:.2e}", candidate.distance)
            );
        }
    }
}
