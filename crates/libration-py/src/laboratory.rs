//! The functions `run_lab` and `advise` for Python.

use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use libration_advise as advise;
use libration_advise::linear;
use libration_lab::output::Output;
use libration_lab::{STUDIES, session};
use libration_study::{Effort, Lab, Progress, Study};
use libration_work::Work;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::background::run_in_background;
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
    let state = ProgressState::default();
    let advice = run_in_background(
        py,
        |stop| advise::advise(&Work::new(&state, stop), &request),
        |py| state.report(py, progress.as_ref()),
    )?;
    let advice = advice.map_err(Raised::raised)?;
    let json = serde_json::to_string(&advice).map_err(|error| value_error(error.to_string()))?;
    Ok((json, advice.holds(), page.then(|| advise::page(&advice))))
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

/// Runs studies and writes what they find into a folder. Gives what is in `results.json`, and all series.
#[pyfunction]
pub(crate) fn _run_lab<'py>(
    py: Python<'py>,
    config: &str,
    names: Option<Vec<String>>,
    effort: Option<String>,
    out: PathBuf,
    progress: Option<Py<PyAny>>,
) -> PyResult<(String, Vec<Series<'py>>)> {
    let mut config = STUDIES.parse(config, "config.toml").map_err(Raised::raised)?;
    config.studies = names.unwrap_or(config.studies);
    config.effort = match effort {
        Some(name) => Effort::from_name(&name)
            .ok_or_else(|| unknown("effort", &name, Effort::ALL.map(Effort::name)))?,
        None => config.effort,
    };
    STUDIES.check(&config).map_err(|error| value_error(error.to_string()))?;
    let chosen: Vec<&'static dyn Study> = match config.studies.as_slice() {
        [] => STUDIES.studies.to_vec(),
        names => names.iter().filter_map(|name| STUDIES.by_name(name)).collect(),
    };
    let output = Output::open(out).map_err(Raised::raised)?;
    let state = ProgressState::default();
    let results = run_in_background(
        py,
        |stop| session::run(&Lab::new(&config, config.effort, &state, stop), &chosen, &output),
        |py| state.report(py, progress.as_ref()),
    )?;
    let results = results.map_err(Raised::raised)?;
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
