//! The functions `run_lab` and `advise` for Python.

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::sync::{Mutex, PoisonError};

use libration_advise as advise;
use libration_advise::{Measure, Request, Tolerance, linear};
use libration_lab::output::Output;
use libration_lab::results::Results;
use libration_lab::{STUDIES, SystemStudies, session};
use libration_study::{Config, Effort, Lab, Progress};
use libration_study_motion::Problem;
use libration_work::Work;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::background::run_in_background;
use crate::equations::{AnySystem, Description, EquationText, any_system, equations};
use crate::error::{Raised, unknown, value_error};

/// Progress: study, its number, number of studies, current work, items done and number of items.
type Position = (String, usize, usize, String, usize, usize);

/// Latest progress, and whether it is new.
#[derive(Default)]
struct ProgressState(Mutex<(Position, bool)>);

impl ProgressState {
    fn set(&self, set: impl FnOnce(&mut Position)) {
        let mut state = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        set(&mut state.0);
        state.1 = true;
    }

    /// Calls `callback` with new progress.
    fn report(&self, py: Python<'_>, callback: Option<&Py<PyAny>>) -> PyResult<()> {
        let news = {
            let mut state = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            std::mem::take(&mut state.1).then(|| state.0.clone())
        };
        match (news, callback) {
            (Some(far), Some(callback)) => callback.call1(py, far).map(|_| ()),
            _ => Ok(()),
        }
    }
}

impl Progress for ProgressState {
    fn study(&self, name: &str, number: usize, of: usize) {
        self.set(|far| *far = (name.to_owned(), number, of, String::new(), 0, 0));
    }

    fn begin(&self, what: &str, total: usize) {
        self.set(|far| (far.3, far.4, far.5) = (what.to_owned(), 0, total));
    }

    fn advance(&self) {
        self.set(|far| far.4 += 1);
    }

    fn end(&self) {
        self.set(|far| far.4 = far.5);
    }
}

/// Advises on what a file asks. Gives JSON, whether all holds, and a page if one is wanted.
#[pyfunction]
pub(crate) fn _advise(
    py: Python<'_>,
    config: &str,
    page: bool,
    redesign: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<(String, bool, Option<String>)> {
    if linear::is_linear(config) {
        return advise_linear(py, config, [page, redesign], progress);
    }
    if redesign {
        return Err(value_error("redesign requires a linear plant".to_owned()));
    }
    let mut request = advise::parse(config, "config.toml").map_err(Raised::raised)?;
    request.map = page;
    advised(py, &request, page, progress)
}

/// The advice as JSON, whether it holds, and its page.
fn advised(
    py: Python<'_>,
    request: &Request,
    page: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<(String, bool, Option<String>)> {
    let state = ProgressState::default();
    let advice = run_in_background(
        py,
        |stop| advise::advise(&Work::new(&state, stop), request),
        |py| state.report(py, progress.as_ref()),
    )?;
    let advice = advice.map_err(Raised::raised)?;
    let json = serde_json::to_string(&advice).map_err(|error| value_error(error.to_string()))?;
    Ok((json, advice.holds(), page.then(|| advise::page(&advice))))
}

/// Advises on a simulation of a system by equations, with its start; `tolerance` is a measure and its largest value.
#[pyfunction]
pub(crate) fn _advise_equations(
    py: Python<'_>,
    system: AnySystem,
    tolerance: (String, f64),
    horizon: f64,
    page: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<(String, bool, Option<String>)> {
    let (measure, most) = tolerance;
    let of = Measure::ALL.into_iter().find(|known| known.name() == measure);
    let of = of.ok_or_else(|| unknown("tolerance", &measure, Measure::ALL.map(Measure::name)))?;
    let options = options_of(&system);
    let request = Request {
        invocation: format!(
            "libration advise {options} --tolerance {measure}={most:e} --horizon {horizon}"
        ),
        options: Some(options),
        ..Request::new(any_system(&system)?, Tolerance { of, most }, horizon)
    };
    advised(py, &request, page, progress)
}

/// The options of the command line that stand for a system and its start.
fn options_of((description, q, v): &AnySystem) -> String {
    let (system, set) = match description {
        // A system that was made in Python has no file.
        Description::Equations((_, file, set)) if file.ends_with(".toml") => (file.as_str(), set),
        Description::Equations((_, _, set)) => ("FILE", set),
        Description::Name((name, set)) => (name.as_str(), set),
    };
    let set: String = set.iter().map(|(name, x)| format!(" --set {name}={x}")).collect();
    let start = |flag: &str, values: &Option<Vec<f64>>| {
        let list =
            values.iter().map(|x| x.iter().map(f64::to_string).collect::<Vec<_>>().join(","));
        list.map(|list| format!(" {flag} {list}")).collect::<String>()
    };
    format!("--system {system}{set}{}{}", start("--q", q), start("--v", v))
}

/// Advises on a loop around a linear plant.
fn advise_linear(
    py: Python<'_>,
    config: &str,
    [page, redesign]: [bool; 2],
    progress: Option<Py<PyAny>>,
) -> PyResult<(String, bool, Option<String>)> {
    let mut request = linear::parse(config, "config.toml").map_err(Raised::raised)?;
    (request.map, request.redesign) = (page, redesign);
    let state = ProgressState::default();
    let advice = run_in_background(
        py,
        |stop| linear::advise(&Work::new(&state, stop), &request),
        |py| state.report(py, progress.as_ref()),
    )?;
    let advice = advice.map_err(Raised::raised)?;
    let json = serde_json::to_string(&advice).map_err(|error| value_error(error.to_string()))?;
    Ok((json, advice.holds(), page.then(|| linear::page(&advice))))
}

/// A series: its study, its name and its columns, each with its unit.
type Series<'py> = (String, String, Bound<'py, PyDict>, Bound<'py, PyDict>);

/// A system by equations, and the keys of a configuration that have to have an effect on its studies.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct LabSystem {
    equations: EquationText,
    keys: Vec<String>,
}

/// Runs studies and writes what they find into a folder. Gives what is in `results.json`, and all series.
#[pyfunction]
pub(crate) fn _run_lab<'py>(
    py: Python<'py>,
    config: &str,
    system: Option<LabSystem>,
    names: Option<Vec<String>>,
    effort: Option<String>,
    out: PathBuf,
    progress: Option<Py<PyAny>>,
) -> PyResult<(String, Vec<Series<'py>>)> {
    let mut config = STUDIES.parse(config, "config.toml").map_err(Raised::raised)?;
    config.studies = names.unwrap_or(config.studies);
    let effort = effort.map(|name| {
        let effort = Effort::from_name(&name);
        effort.ok_or_else(|| unknown("effort", &name, Effort::ALL.map(Effort::name)))
    });
    let effort = effort.transpose()?;
    config.effort = effort.unwrap_or(config.effort);
    STUDIES.check(&config).map_err(|error| value_error(error.to_string()))?;
    let state = ProgressState::default();
    let run = |stop: &AtomicBool| match &system {
        None => {
            let output = Output::open(out).map_err(Raised::raised)?;
            let lab = Lab::new(&config, config.effort, &state, stop);
            session::run(&lab, &STUDIES.chosen(&config), &output).map_err(Raised::raised)
        }
        Some(system) => run_on_system(system, (config, effort), out, (&state, stop)),
    };
    let results = run_in_background(py, run, |py| state.report(py, progress.as_ref()))??;
    let json = serde_json::to_string(&results).map_err(|error| value_error(error.to_string()))?;
    let mut all = Vec::new();
    for record in &results.studies {
        for series in &record.series {
            let (columns, units) = (PyDict::new(py), PyDict::new(py));
            for column in &series.columns {
                columns.set_item(&column.name, PyArray1::from_slice(py, &column.values))?;
                units.set_item(&column.name, &column.unit)?;
            }
            all.push((record.name.clone(), series.name.clone(), columns, units));
        }
    }
    Ok((json, all))
}

/// Runs the studies of a system by equations.
fn run_on_system(
    LabSystem { equations: source, keys }: &LabSystem,
    (config, effort): (Config, Option<Effort>),
    out: PathBuf,
    (state, stop): (&ProgressState, &AtomicBool),
) -> PyResult<Results> {
    let (_, file, set) = source;
    let system = equations(source)?;
    let problem = Problem::of_equations(&system);
    let all = SystemStudies::new(&system, &problem);
    // A system that was made in Python has no file.
    let file = if file.ends_with(".toml") { file } else { "FILE" };
    let all = all.with_command(file, set, effort);
    for key in keys {
        if let Some(reason) = all.reason_without_effect(key) {
            return Err(value_error(format!("config has `{key}`, which has no effect: {reason}")));
        }
    }
    let (studies, config) = all
        .configured(config)
        .map_err(|other| value_error(format!("studies: {}", other.sentence(&system.name))))?;
    let output = Output::open(out).map_err(Raised::raised)?;
    let lab = Lab::new(&config, config.effort, state, stop);
    session::run_system(&lab, &all, &studies, &output).map_err(Raised::raised)
}
