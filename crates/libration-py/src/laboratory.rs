//! The laboratory and its advice, as Python runs them.

use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use libration_advise as advise;
use libration_lab::output::Output;
use libration_lab::{STUDIES, session};
use libration_study::{Effort, Lab, Progress, Study};
use libration_work::Work;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::{Raised, refused, unknown};
use crate::work::work;

/// How far work is: what is being done, its number and of how many, the part of it that is being done, and how many parts of how many are.
type Far = (String, usize, usize, String, usize, usize);

/// What was told last, for whoever looks at it now and then.
#[derive(Default)]
struct Told(Mutex<(Far, bool)>);

impl Told {
    fn set(&self, set: impl FnOnce(&mut Far)) {
        let mut told = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        set(&mut told.0);
        told.1 = true;
    }

    /// Calls `callback` if there is news.
    fn tell(&self, py: Python<'_>, callback: Option<&Py<PyAny>>) -> PyResult<()> {
        let news = {
            let mut told = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            std::mem::take(&mut told.1).then(|| told.0.clone())
        };
        match (news, callback) {
            (Some(far), Some(callback)) => callback.call1(py, far).map(|_| ()),
            _ => Ok(()),
        }
    }
}

impl Progress for Told {
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
    asked: &str,
    page: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<(String, bool, Option<String>)> {
    let mut request = advise::parse(asked, "asked.toml").map_err(Raised::raised)?;
    request.map = page;
    let told = Told::default();
    let advice = work(
        py,
        |stop| advise::advise(&Work::new(&told, stop), &request),
        |py| told.tell(py, progress.as_ref()),
    )?;
    let advice = advice.map_err(Raised::raised)?;
    let json = serde_json::to_string(&advice).map_err(|error| refused(error.to_string()))?;
    Ok((json, advice.holds(), page.then(|| advise::page(&advice))))
}

/// A series: its study, its name and its columns, each with its unit.
type Series<'py> = (String, String, Bound<'py, PyDict>, Bound<'py, PyDict>);

/// Runs studies and writes what they find into a folder. Gives what is in `results.json`, and all series.
#[pyfunction]
pub(crate) fn _run_lab<'py>(
    py: Python<'py>,
    asked: &str,
    names: Option<Vec<String>>,
    effort: Option<String>,
    out: PathBuf,
    progress: Option<Py<PyAny>>,
) -> PyResult<(String, Vec<Series<'py>>)> {
    let mut config = STUDIES.parse(asked, "config.toml").map_err(Raised::raised)?;
    config.studies = names.unwrap_or(config.studies);
    config.effort = match effort {
        Some(name) => Effort::from_name(&name)
            .ok_or_else(|| unknown("effort", &name, Effort::ALL.map(Effort::name)))?,
        None => config.effort,
    };
    STUDIES.check(&config).map_err(|error| refused(error.to_string()))?;
    let chosen: Vec<&'static dyn Study> = match config.studies.as_slice() {
        [] => STUDIES.studies.to_vec(),
        names => names.iter().filter_map(|name| STUDIES.by_name(name)).collect(),
    };
    let output = Output::open(out).map_err(Raised::raised)?;
    let told = Told::default();
    let results = work(
        py,
        |stop| session::run(&Lab::new(&config, config.effort, &told, stop), &chosen, &output),
        |py| told.tell(py, progress.as_ref()),
    )?;
    let results = results.map_err(Raised::raised)?;
    let json = serde_json::to_string(&results).map_err(|error| refused(error.to_string()))?;
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
