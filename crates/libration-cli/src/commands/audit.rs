//! `libration audit`.

use std::path::Path;

use libration_energy::{EnergyTrace, Requirement, audit, page};
use libration_logs::{Log, LogError, ReadOptions};
use libration_report::notation::plural;

use super::audit_text::describe;
use super::log_warnings;
use super::repeat_command::command_line;
use super::result_file::ResultFile;
use crate::args::{AuditArgs, TimeUnitName};
use crate::error::Failure;
use crate::terminal;

/// The column with the time step of a file.
const TIME_STEP: &str = "dt";

/// Audits energies and prints the report.
pub(crate) fn run(args: &AuditArgs) -> Result<(), Failure> {
    let file = ResultFile::create("--page", args.page.as_deref())?;
    if !args.dt.is_empty() && args.dt.len() != args.files.len() {
        return Err(Failure::usage(format!(
            "--dt has {} for {}; expected one for each file",
            plural(args.dt.len(), "time step"),
            plural(args.files.len(), "file")
        )));
    }
    let mut traces = Vec::with_capacity(args.files.len());
    let mut warnings = Vec::new();
    for (i, path) in args.files.iter().enumerate() {
        let (trace, own) = read(args, path, args.dt.get(i).copied())
            .map_err(|error| Failure::usage(format!("cannot use `{}`: {error}", path.display())))?;
        traces.push(trace);
        warnings.extend(log_warnings::warn(path, &own));
    }
    let requirement =
        Requirement { tolerance: args.tolerance, horizon: args.horizon, scale: args.scale };
    let mut report = audit(&traces, requirement).map_err(Failure::usage)?;
    report.repeat_command = command_line();
    report.warnings = warnings;
    let text = match args.json {
        true => serde_json::to_string_pretty(&report).map_err(Failure::run)? + "\n",
        false => describe(&report),
    };
    terminal::print(&text)?;
    file.write(|| page(&report))?;
    if report.holds() { Ok(()) } else { Err(Failure::Disagreement) }
}

/// The energies of a file, and the warnings about it. Without `dt` the time step is that of a column, if there is one.
fn read(
    args: &AuditArgs,
    path: &Path,
    dt: Option<f64>,
) -> Result<(EnergyTrace, Vec<String>), LogError> {
    let time_unit = args.time_unit.map(TimeUnitName::unit);
    let options = ReadOptions { time: args.time.clone(), time_unit, ..ReadOptions::default() };
    let log = Log::open(path, &options)?;
    if log.is_time(&args.energy) {
        return Err(LogError::Damaged(format!(
            "--energy is `{}`, the column of time; expected a column of energies; help: choose another column of time with --time",
            args.energy
        )));
    }
    let energies = log.series(&args.energy)?;
    let has_steps = log.signals().iter().any(|signal| signal.name == TIME_STEP);
    let dt = match dt {
        None if has_steps => log.series(TIME_STEP)?.values.first().copied(),
        dt => dt,
    };
    let title = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
    let trace = EnergyTrace { title, dt, times: energies.time, energies: energies.values };
    Ok((trace, log.warnings_in_own_unit()))
}
