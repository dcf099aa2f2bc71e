//! `libration probe`.

use std::path::Path;
use std::time::Instant;

use libration::linear::{Matrix, Signal};
use libration_probe::{
    BlackBox, BlackBoxError, ChildProcess, Description, Matrices, MatrixStep, ProbeReport, Subject,
    page, probe,
};
use libration_report::notation::plural;
use libration_report::printable::{printable, toml_string};
use libration_report::verdict::{GOOD, exit_code};
use libration_settings::linear_loop::read_plant;

use super::mujoco;
use super::probe_text::describe;
use super::repeat_command::command_line;
use super::result_file::ResultFile;
use super::watched::Watched;
use crate::args::{Coordinates, ProbeArgs, quoted};
use crate::error::Failure;
use crate::terminal;

/// Audits the step of a simulator and prints the report.
pub(crate) fn run(args: &ProbeArgs, quiet: bool) -> Result<(), Failure> {
    let start = Instant::now();
    check_suffix(args.save_plant.as_deref())?;
    let file = ResultFile::create("--page", args.page.as_deref())?;
    let plant_file = ResultFile::create("--save-plant", args.save_plant.as_deref())?;
    let (black_box, mut subject) = simulator(args, start + args.time_limit)?;
    subject.invocation = command_line();
    if args.moving {
        subject.equilibrium = Some(false);
    }
    subject.is_conservative |= args.conservative;
    subject.check().map_err(|error| Failure::usage(named(&error.to_string())))?;
    if !quiet {
        terminal::say(&format!("auditing the step of {}", subject.title));
    }
    let mut watched = Watched::new(black_box, start, args.time_limit, quiet);
    let report = probe(&mut watched, &subject).map_err(|error| failure(args, &error))?;
    drop(watched);
    let text = match args.json {
        true => serde_json::to_string_pretty(&report).map_err(Failure::run)? + "\n",
        false => describe(&report),
    };
    terminal::print(&text)?;
    file.write(|| page(&report))?;
    if plant_file.is_wanted() && report.inputs.is_empty() {
        return Err(Failure::run(
            "--save-plant: the step has no actions; a plant requires an input",
        ));
    }
    if plant_file.is_wanted() {
        let plant = report.modified_flow.as_ref().ok_or_else(|| {
            Failure::run("--save-plant: the step is no exact step of a plant in continuous time: a mode changes its sign from step to step, or the step was not linearised")
        })?;
        let silent =
            (0..plant.b.columns()).find(|&j| (0..plant.b.rows()).all(|i| plant.b[(i, j)] == 0.0));
        if let Some(j) = silent {
            return Err(Failure::run(format!(
                "--save-plant: the effect of `{}` is zero in the matrices of the step; expected an action to which a small step responds",
                report.inputs[j]
            )));
        }
        let neutral = report.neutral_states();
        if !neutral.is_empty() && !args.without_neutral && !quiet {
            terminal::say(&format!(
                "note: nothing depends on {} of the plant; --without-neutral leaves such states out, which `advise` cannot stabilise without an input on them",
                neutral.join(", ")
            ));
        }
        let reduced = report.without_neutral().filter(|_| args.without_neutral);
        let all: Vec<usize> = (0..report.states.len()).collect();
        let (plant, kept) = match &reduced {
            Some(reduced) => (&reduced.plant, &reduced.kept),
            None => (plant, &all),
        };
        plant_file.write(|| plant_text(&report, plant, kept))?;
    }
    match exit_code([&report.verdict]) {
        GOOD => Ok(()),
        _ => Err(Failure::Disagreement),
    }
}

/// Checks that `advise --plant` will know the format of a plant. A pipe or device needs no suffix.
fn check_suffix(path: Option<&Path>) -> Result<(), Failure> {
    let is_toml = |path: &Path| path.extension().is_some_and(|suffix| suffix == "toml");
    let is_pipe = |path: &Path| {
        path.starts_with("/dev") || path.exists() && !path.is_file() && !path.is_dir()
    };
    match path.filter(|path| !is_toml(path) && !is_pipe(path)) {
        None => Ok(()),
        Some(path) => Err(Failure::usage(format!(
            "cannot write `{}` (--save-plant): plants are TOML; expected a file name that ends in .toml",
            path.display()
        ))),
    }
}

/// The failure of an audit. Only simulators of `--command` have options for their typical deviations and their state.
fn failure(args: &ProbeArgs, error: &BlackBoxError) -> Failure {
    let message = error.to_string();
    let [scale, state] = match (&args.command, &args.mujoco) {
        (Some(_), _) => [" (--state-scale)", " (--state, --action)"],
        (None, Some(_)) => [" (--state-scale)", ""],
        (None, None) => [""; 2],
    };
    Failure::run(message.replace(" (state_scale)", scale).replace(" (state, action)", state))
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
fn simulator(args: &ProbeArgs, deadline: Instant) -> Result<(Box<dyn BlackBox>, Subject), Failure> {
    match (&args.command, &args.mujoco, &args.matrices) {
        (Some(words), _, _) => {
            let subject = described(args, &quoted(words.0.clone()))?;
            let mut child = ChildProcess::start(&words.0, Vec::new(), args.timeout)
                .map_err(|error| Failure::usage(format!("{error} (--command)")))?;
            child.set_deadline(deadline);
            Ok((Box::new(child), subject))
        }
        (_, Some(path), _) => mujoco_model(args, path, deadline),
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
fn mujoco_model(
    args: &ProbeArgs,
    path: &Path,
    deadline: Instant,
) -> Result<(Box<dyn BlackBox>, Subject), Failure> {
    let mut options = Vec::new();
    let mut option = |name: &str, value: Option<String>| {
        options.extend(value.into_iter().flat_map(|value| [format!("--{name}"), value]));
    };
    option("keyframe", args.keyframe.clone());
    option("dt", args.dt.map(|dt| format!("{dt:?}")));
    option(
        "state-scale",
        args.state_scale.as_ref().map(|scale| {
            scale.values().iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(",")
        }),
    );
    if args.settle {
        options.push("--settle".into());
    }
    let (mut child, text) =
        mujoco::start(&args.python, path, &options, args.timeout, Some(deadline))?;
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
                "--{option} has {}; expected {count}",
                plural(given, "number")
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

/// The plant as the keys of a plant file.
fn plant_text(report: &ProbeReport, plant: &Matrices, kept: &[usize]) -> String {
    let matrix = |matrix: &Matrix| {
        let row = |i: usize| {
            let numbers: Vec<String> = matrix.row(i).iter().map(|x| format!("{x:?}")).collect();
            format!("    [{}],\n", numbers.join(", "))
        };
        (0..matrix.rows()).map(row).collect::<String>()
    };
    // Names of a plant are text on one line.
    let names = |names: &[String]| {
        names.iter().map(|name| toml_string(&printable(name))).collect::<Vec<_>>().join(", ")
    };
    format!(
        "# Deviations from the point of `{}`, in steps of {} s: exact steps of this plant are those of the simulator.\n\
         states = [{}]\ninputs = [{}]\na = [\n{}]\nb = [\n{}]\n",
        printable(&report.title),
        report.dt,
        names(&kept.iter().map(|k| report.states[*k].clone()).collect::<Vec<_>>()),
        names(&report.inputs),
        matrix(&plant.a),
        matrix(&plant.b),
    )
}
