//! `libration simulate`.

use std::io;
use std::io::{BufWriter, ErrorKind, IsTerminal, Write};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use indicatif::ProgressBar;
use libration::control::clock::Recorded;
use libration_advise::linear::{self, LinearRequest, RequestFile};
use libration_analyze::adaptive;
use libration_analyze::export::ExportError;
use libration_analyze::linear_trajectory;
use libration_analyze::trajectory;
use libration_analyze::trajectory::{
    Divergence, Format, Monitor, Outcome, Request, TrajectoryError,
};
use libration_settings::{Document, Fault};

use super::{adaptive_steps, config_file, equation_file, equation_loop, time_stamps};
use crate::args::{SimulateArgs, option_of};
use crate::error::Failure;
use crate::output_file::OutputFile;
use crate::{interrupt, progress, terminal};

/// Bytes that are gathered before they are written.
const BUFFER: usize = 1 << 18;

/// Simulates a trajectory and writes its rows.
pub(crate) fn run(args: &SimulateArgs, quiet: bool) -> Result<(), Failure> {
    args.topic.ensure_file("--time-stamps", args.time_stamps.as_deref())?;
    let format = format(args)?;
    let read = |path: &Path, change: &dyn Fn(&mut RequestFile)| {
        let request = linear_file(path, change)?;
        if request.misses_deadlines() && !quiet {
            terminal::say(
                "note: a simulation misses no deadlines; `deadline-misses`, `overrun` and `overrun-probability` have no effect",
            );
        }
        Ok(request)
    };
    if let Some(request) = args.linear_request(read) {
        let request = request?;
        return write(args, quiet, (format, request.steps), &|out, watcher| {
            linear_trajectory::write(&request, format, out, watcher)
        });
    }
    if let Some(request) = equation_loop::request(args) {
        let request = request?;
        return write(args, quiet, (format, request.steps), &|out, watcher| {
            linear_trajectory::write(&request, format, out, watcher)
        });
    }
    if let Some(control) = args.adaptive {
        let request = adaptive_steps::request(args, control)?;
        if let Some(reason) = request.irreversibility().filter(|_| !quiet) {
            terminal::say(&format!("note: the steps are not reversible: {reason}"));
        }
        return write(args, quiet, (format, request.steps), &|out, watcher| {
            adaptive::write(&request, format, out, watcher)
        });
    }
    let request = request(args)?;
    if let Some(caveat) = request.caveat().filter(|_| !quiet) {
        terminal::say(&format!("note: {caveat}"));
    }
    write(args, quiet, (format, request.steps), &|out, watcher| {
        trajectory::write(&request, format, out, watcher)
    })
}

/// Writes rows into `out`.
type WriteRows<'a> =
    &'a dyn Fn(&mut (dyn Write + Send), &Watcher) -> Result<Outcome, TrajectoryError>;

/// Writes the rows to the output and says how they ended.
///
/// # Errors
/// [`Failure::Disagreement`] if a state stopped being finite: the rows before it are kept.
fn write(
    args: &SimulateArgs,
    quiet: bool,
    (format, steps): (Format, u64),
    rows: WriteRows<'_>,
) -> Result<(), Failure> {
    // Rows on the same terminal would break a bar.
    let rows_shown = args.output.is_none() && io::stdout().is_terminal();
    let watcher = Watcher::new(quiet || rows_shown, steps, interrupt::listen());
    let outcome = match &args.output {
        Some(path) => into_file(path, rows, &watcher),
        None => into_stdout(rows, format, &watcher),
    };
    watcher.clear();
    let outcome = outcome?;
    let unsolved = outcome.newton_residual().and_then(|residual| residual.error());
    let unsolved = unsolved.map(Failure::run);
    let warning = match outcome {
        Outcome::Complete | Outcome::Iterated(_) => return unsolved.map_or(Ok(()), Err),
        Outcome::EnergyDiverges { verdict, .. } => format!("warning: {}", verdict.evidence),
        Outcome::Diverged(Divergence { step, t, reason, .. }) => {
            let last = step - 1;
            format!("warning: the last row is step {last}: at step {step} (t = {t} s) {reason}")
        }
        Outcome::NotFinite { count, first, reason, .. } => {
            let named: Vec<String> = first.iter().map(usize::to_string).collect();
            let more = if count > first.len() { ", …" } else { "" };
            let are = if count == 1 { "trajectory is" } else { "trajectories are" };
            let why = reason.map_or_else(String::new, |reason| format!(": {reason}"));
            format!("warning: {count} {are} not finite in the end: {}{more}{why}", named.join(", "))
        }
    };
    if !quiet {
        terminal::say(&warning);
    }
    Err(unsolved.unwrap_or(Failure::Disagreement))
}

/// Returns the format of `--format` or of the extension of `--output`; both must agree.
fn format(args: &SimulateArgs) -> Result<Format, Failure> {
    match args.output.as_deref() {
        Some(path) => format_of(path, args.format),
        None => Ok(args.format.unwrap_or_default()),
    }
}

/// Returns the format of rows in a file.
pub(super) fn format_of(path: &Path, format: Option<Format>) -> Result<Format, Failure> {
    match (format, Format::of_path(path)) {
        (Some(named), Some(ending)) if named != ending => Err(Failure::usage(format!(
            "--format {} contradicts --output `{}`, whose extension is .{}",
            named.name(),
            path.display(),
            ending.name()
        ))),
        (None, None) if path.extension().is_some() => {
            let endings = Format::ALL.map(|format| format!(".{}", format.name())).join(", ");
            Err(Failure::usage(format!(
                "--output `{}` has an unknown extension; expected one of {endings}, or --format",
                path.display()
            )))
        }
        (named, ending) => Ok(named.or(ending).unwrap_or_default()),
    }
}

fn request(args: &SimulateArgs) -> Result<Request, Failure> {
    let (Some(system), Some(step)) = (&args.system, &args.step) else {
        return Err(Failure::usage(
            "--system, --integrator and --dt are required without --plant and --config",
        ));
    };
    let system = equation_file::any_system(system)?;
    Ok(Request {
        system,
        stepping: step.integrator,
        float: args.dtype,
        dt: step.dt,
        steps: args.steps_of(step.dt)?,
        every: args.every,
        ensemble: args.ensemble()?,
        timing: args.timing.timing(),
        record: args
            .time_stamps
            .as_deref()
            .map(|path| recorded(path, args, step.dt))
            .transpose()?,
        seed: args.seed,
    })
}

/// Reads the loop of a request file, which `change` changes.
pub(super) fn linear_file(
    path: &Path,
    change: &dyn Fn(&mut RequestFile),
) -> Result<LinearRequest, Failure> {
    config_file::read(path, |text, name| {
        if !linear::is_linear(text) {
            let document = Document::parse(text, name)?;
            return Err(document.locate(Fault::new(
                "system",
                "there is no linear plant; expected the table [system.linear]",
            )));
        }
        linear::parse_changed(text, name, change)
    })
}

/// The steps between the time stamps of a file, in multiples of `dt` seconds.
fn recorded(path: &Path, args: &SimulateArgs, dt: f64) -> Result<Vec<f64>, Failure> {
    time_stamps::read(path, "--time-stamps", &args.topic.options(), |stamps| {
        Recorded::steps_in(&stamps.seconds, dt)
    })
}

fn into_file(path: &Path, rows: WriteRows<'_>, watcher: &Watcher) -> Result<Outcome, Failure> {
    let unwritable =
        |error: io::Error| format!("cannot write `{}` (--output): {error}", path.display());
    let file = OutputFile::create(path).map_err(|error| Failure::usage(unwritable(error)))?;
    let mut out = BufWriter::with_capacity(BUFFER, file);
    let outcome = rows(&mut out, watcher).map_err(|error| match error {
        TrajectoryError::Export(ExportError::Io(error)) => Failure::run(unwritable(error)),
        TrajectoryError::Interrupted => {
            Failure::Interrupted(format!("interrupted; `{}` is unchanged", path.display()))
        }
        error => failure(error),
    })?;
    let written = out.into_inner().map_err(|error| error.into_error());
    written.and_then(OutputFile::keep).map_err(|error| Failure::run(unwritable(error)))?;
    Ok(outcome)
}

fn into_stdout(rows: WriteRows<'_>, format: Format, watcher: &Watcher) -> Result<Outcome, Failure> {
    if format.is_binary() && io::stdout().is_terminal() {
        let name = format.name();
        return Err(Failure::usage(format!(
            "--format {name} is binary, and standard output is a terminal; \
             expected a file (--output FILE.{name}) or a pipe"
        )));
    }
    let mut out = BufWriter::with_capacity(BUFFER, io::stdout());
    match rows(&mut out, watcher) {
        // A closed pipe is not an error.
        Err(TrajectoryError::Export(ExportError::Io(error)))
            if error.kind() == ErrorKind::BrokenPipe =>
        {
            drop(out.into_parts());
            Ok(Outcome::Complete)
        }
        Err(TrajectoryError::Export(ExportError::Io(error))) => {
            drop(out.into_parts());
            Err(error.into())
        }
        Err(TrajectoryError::Interrupted) => {
            // The rows so far are whole; if they cannot be written, nobody reads them.
            let _ = out.flush();
            Err(Failure::Interrupted("interrupted".to_owned()))
        }
        outcome => outcome.map_err(failure),
    }
}

/// Progress of the steps, on a terminal.
pub(super) struct Watcher {
    bar: Option<ProgressBar>,
    stop: &'static AtomicBool,
}

impl Watcher {
    pub(super) fn new(quiet: bool, steps: u64, stop: &'static AtomicBool) -> Self {
        Watcher { bar: (!quiet && progress::has_bars()).then(|| progress::steps(steps)), stop }
    }

    pub(super) fn clear(&self) {
        self.bar.iter().for_each(ProgressBar::finish_and_clear);
    }
}

impl Monitor for Watcher {
    fn on_step(&self, step: u64) {
        self.bar.iter().for_each(|bar| bar.set_position(step));
    }

    fn should_stop(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

/// Converts an error of a request or of its run.
pub(super) fn failure(error: TrajectoryError) -> Failure {
    if let Some(shortage) = error.missing_memory() {
        return Failure::out_of_memory(shortage, &error);
    }
    match error {
        TrajectoryError::Ensemble(error) => Failure::ensemble(&error),
        TrajectoryError::Value { name, value, allowed } => {
            Failure::usage(format!("--{} is {value}; expected {allowed}", option_of(name)))
        }
        TrajectoryError::Parameter { .. } => Failure::usage(format!("{error} (--dtype)")),
        TrajectoryError::Bodies(_)
        | TrajectoryError::Catalog(_)
        | TrajectoryError::Simulation(_)
        | TrajectoryError::ExcessiveLatency(_)
        | TrajectoryError::LinearLoops(_) => Failure::usage(error),
        TrajectoryError::Memory(_) | TrajectoryError::Export(_) | TrajectoryError::Interrupted => {
            Failure::run(error)
        }
    }
}
