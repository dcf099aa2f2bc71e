//! `libration identify`.

use libration_identify::{
    IdentifyError, KnownPlant, Recording, RecordingError, Request, ResponseKind, identify,
    loop_file, page,
};
use libration_logs::{Log, ReadOptions};
use libration_report::verdict;
use libration_settings::linear_loop::read_plant;
use libration_work::Work;

use super::identify_text::describe;
use super::log_warnings;
use super::repeat_command::command_line;
use super::result_file::ResultFile;
use crate::args::{IdentifyArgs, TimeUnitName};
use crate::error::Failure;
use crate::progress::{Reporter, reading};
use crate::{interrupt, terminal};

/// Identifies a loop from a log and prints its numbers.
pub(crate) fn run(args: &IdentifyArgs, quiet: bool) -> Result<(), Failure> {
    check(args)?;
    let request = request(args)?;
    let (recording, warnings) = recording(args, quiet)?;
    let page_file = ResultFile::create("--page", args.page.as_deref())?;
    let saved = ResultFile::create("--save-loop", args.save_loop.as_deref())?;
    // Before this computation there is nothing to keep: a signal ends the process while it reads.
    let reporter = Reporter::new(quiet);
    let found =
        interrupt::compute(|stop| identify(&recording, &request, &Work::new(&reporter, stop)));
    reporter.clear();
    let mut found = found.map_err(failure)?;
    found.repeat_command = command_line();
    // They are on stderr, and not a second time in the text.
    let text = describe(&found);
    found.warnings.splice(0..0, warnings);
    let text = match args.json {
        true => serde_json::to_string_pretty(&found).map_err(Failure::run)? + "\n",
        false => text,
    };
    terminal::print(&text)?;
    if found.has_loop() {
        saved.write(|| loop_file(&found))?;
    } else if let Some(path) = &args.save_loop {
        let path = path.display();
        let why = match found.depends_on_command {
            true => "the dead time is unknown",
            false => "there is no model",
        };
        terminal::warn(&format!("`{path}` (--save-loop) is not written: {why}"));
    }
    page_file.write(|| page(&found))?;
    match verdict::exit_code([&found.verdict]) {
        verdict::GOOD => Ok(()),
        _ => Err(Failure::Disagreement),
    }
}

/// Fails for options that contradict each other.
fn check(args: &IdentifyArgs) -> Result<(), Failure> {
    if args.command == args.response {
        return Err(Failure::usage(format!(
            "--command and --response are both {}; expected two signals",
            args.command
        )));
    }
    let is_delay = args.model.0.iter().all(|model| model.name() == "delay") && args.plant.is_none();
    if is_delay && args.lag.is_some() {
        return Err(Failure::usage(
            "--lag is given, but --model delay has no lag; expected --model lag",
        ));
    }
    if is_delay && args.noise.0.iter().all(|noise| noise.name() == "disturbance") {
        return Err(Failure::usage(
            "--noise is disturbance, but --model delay has no plant that it could disturb; expected white or coloured",
        ));
    }
    let log = args.log.canonicalize().ok();
    let outputs = [("--page", &args.page), ("--save-loop", &args.save_loop)];
    for (option, path) in outputs {
        let path = path.as_ref().and_then(|path| path.canonicalize().ok());
        if path.is_some() && path == log {
            return Err(Failure::usage(format!(
                "{option} is the log itself, `{}`; expected another file",
                args.log.display()
            )));
        }
    }
    match args.page.is_some() && args.page == args.save_loop {
        true => {
            Err(Failure::usage("--page and --save-loop name the same file; expected two files"))
        }
        false => Ok(()),
    }
}

fn failure(error: IdentifyError) -> Failure {
    match error {
        IdentifyError::Interrupted(_) => Failure::Interrupted("interrupted".into()),
        error @ IdentifyError::Budget(_) => Failure::run(error),
        IdentifyError::Value { name, value, expected } => {
            let option = format!("--{}", name.replace(' ', "-"));
            Failure::usage(format!("{option} is {value}; expected {expected}"))
        }
        error => Failure::usage(error),
    }
}

fn request(args: &IdentifyArgs) -> Result<Request, Failure> {
    let responses = match &args.plant {
        None => args.model.0.clone(),
        Some(_) => vec![ResponseKind::Plant(Box::new(plant(args)?))],
    };
    Ok(Request {
        responses,
        noises: args.noise.0.clone(),
        holds: args.hold.0.clone(),
        dead_time: args.dead_time,
        lag: args.lag,
        gain: args.gain,
        largest_dead_time: args.largest_dead_time,
        // All of them are the default.
        start: match &args.start.0[..] {
            [start] => Some(*start),
            _ => None,
        },
        budget: args.budget,
        arrivals: !args.certain_arrivals,
        details: true,
        bootstrap: args.bootstrap,
        seed: args.seed,
    })
}

/// The signals of the options, and the warnings about the log, which are printed.
fn recording(args: &IdentifyArgs, quiet: bool) -> Result<(Recording, Vec<String>), Failure> {
    let path = args.log.display();
    let time_unit = args.time_unit.map(TimeUnitName::unit);
    let options = ReadOptions { time: args.time.clone(), time_unit, clock: args.clock.choice() };
    let log = reading(quiet, &args.log, || Log::open(&args.log, &options))
        .map_err(|error| Failure::usage(format!("cannot read `{path}`: {error}")))?;
    let warnings = log_warnings::warn(&args.log, &log.warnings());
    let series = |option: &str, name: &str| {
        log.series(name).map_err(|error| Failure::usage(format!("`{path}` ({option}): {error}")))
    };
    let command = series("--command", &args.command)?;
    let response = series("--response", &args.response)?;
    let [times, commands] = [&command.time, &command.values];
    let [response_times, responses] = [&response.time, &response.values];
    let recording = match args.command_before {
        Some(before) => Recording::behind(before, times, commands, response_times, responses),
        None => Recording::new(times, commands, response_times, responses),
    };
    recording.map(|recording| (recording, warnings)).map_err(|error| {
        let option = match error {
            RecordingError::ConstantCommand(_) if args.command_before.is_none() => {
                " with --command-before"
            }
            _ => "",
        };
        Failure::usage(format!("`{path}`: {error}{option}"))
    })
}

/// The channel of the plant of the options.
fn plant(args: &IdentifyArgs) -> Result<KnownPlant, Failure> {
    let Some(path) = &args.plant else {
        return Err(Failure::usage("--plant is missing; expected a file"));
    };
    let plant = read_plant(path)
        .and_then(|table| table.plant().map_err(|fault| fault.to_string()))
        .map_err(|why| {
            Failure::usage(format!("cannot use `{}` (--plant): {why}", path.display()))
        })?;
    let place = |option: &str, of: &str, wanted: &Option<String>, names: Vec<&str>| match wanted {
        None if names.len() == 1 => Ok(0),
        None => Err(Failure::usage(format!(
            "{option} is missing; expected one of the {of} {}",
            names.join(", ")
        ))),
        Some(wanted) => names.iter().position(|name| name == wanted).ok_or_else(|| {
            Failure::usage(format!("{option} is {wanted}; expected one of {}", names.join(", ")))
        }),
    };
    let names = |signals: &'_ [libration::linear::Signal]| -> Vec<String> {
        signals.iter().map(|signal| signal.name.clone()).collect()
    };
    let (inputs, outputs) = (names(&plant.inputs), names(&plant.outputs));
    let input = place(
        "--plant-input",
        "inputs",
        &args.plant_input,
        inputs.iter().map(String::as_str).collect(),
    )?;
    let output = place(
        "--plant-output",
        "outputs",
        &args.plant_output,
        outputs.iter().map(String::as_str).collect(),
    )?;
    KnownPlant::new(&plant, input, output).ok_or_else(|| {
        Failure::usage("the plant (--plant) is sampled; expected one in continuous time")
    })
}
