//! Requests of simulations and analyses from Python.

use std::ffi::CString;
use std::ops::RangeInclusive;

use libration::catalog::Actuation;
use libration::control::{Feedback, Jitter, LqrWeights};
use libration::{AnyMethod, AnySystem, Method, catalog};
use libration_analyze::{LatencyOption, Stepping, Timing};
use libration_settings::equations::EquationSystem;
use libration_settings::limits::{MOST_GAIN, MOST_RMS};
use libration_settings::suggestions;
use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;

use crate::error::{Raised, unknown, value_error};

/// The name of a system, and those of its parameters that are not the default.
pub(crate) type SystemRequest = (String, Vec<(String, f64)>);

/// A loop and its imperfections.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Loop {
    feedback: Option<[f64; 2]>,
    latency: Option<(String, f64)>,
    jitter: Option<(String, f64)>,
    skew: Option<(String, f64)>,
    loss: Option<f64>,
    cost_weights: Option<[f64; 3]>,
}

/// The system of that name.
pub(crate) fn system((name, parameters): &SystemRequest) -> PyResult<(AnySystem, Actuation)> {
    let parameters: Vec<_> = parameters.iter().map(|(name, value)| (name, *value)).collect();
    catalog::build(name, &parameters)
        .map_err(|error| value_error(format!("{error}{}", suggestions::catalog_help(&error))))
}

/// The integrator of that name, or exact steps.
pub(crate) fn stepping(name: &str) -> PyResult<Stepping> {
    Stepping::from_name(name).ok_or_else(|| unknown_integrator(name, true))
}

/// The integrator of that name, explicit or implicit.
pub(crate) fn any_method(name: &str) -> PyResult<AnyMethod> {
    if name == Stepping::EXACT {
        let what = "are those of simulate and analyze only, of linear systems";
        return Err(value_error(format!("integrator is `{name}`, but exact steps {what}")));
    }
    AnyMethod::from_name(name).ok_or_else(|| unknown_integrator(name, false))
}

/// The error for an unknown integrator: the nearest of all, and a list without the published splitting methods.
fn unknown_integrator(name: &str, with_exact: bool) -> PyErr {
    let near = suggestions::nearest(
        name,
        AnyMethod::all().chain(AnyMethod::tables()).map(AnyMethod::name),
    );
    let near = near.map_or_else(String::new, |near| format!("did you mean `{near}`? "));
    let short = AnyMethod::all().map(AnyMethod::name);
    let short = short.chain(with_exact.then_some(Stepping::EXACT)).map(|name| format!("`{name}`"));
    let short = short.collect::<Vec<_>>().join(", ");
    value_error(format!(
        "unknown integrator `{name}`: {near}the integrators are {short}, and those of libration.SPLITTING_METHODS and libration.RUNGE_KUTTA_METHODS"
    ))
}

/// The explicit integrator of that name.
pub(crate) fn method(name: &str) -> PyResult<Method> {
    match any_method(name)? {
        AnyMethod::Explicit(method) => Ok(method),
        AnyMethod::Implicit(_) => {
            let known = Method::ALL.map(Method::name).join(", ");
            Err(value_error(format!(
                "integrator is `{name}`, but implicit ones are those of simulate and analyze only; expected one of {known}, or a name of libration.SPLITTING_METHODS or libration.RUNGE_KUTTA_METHODS"
            )))
        }
    }
}

/// Warns of a caveat of an integrator on a system, if there is one.
pub(crate) fn warn_of(py: Python<'_>, caveat: Option<String>) -> PyResult<()> {
    let Some(caveat) = caveat else { return Ok(()) };
    let category = py.get_type::<PyUserWarning>();
    // Of who called the function of the package.
    PyErr::warn(py, &category, &CString::new(caveat)?, 3)
}

/// A system of the catalogue at its start; the catalogue supplies missing coordinates.
pub(crate) fn of_catalogue(
    request: &SystemRequest,
    q: Option<&[f64]>,
    v: Option<&[f64]>,
) -> PyResult<EquationSystem> {
    let system = system(request)?;
    if let (Some(q), Some(v)) = (q, v)
        && q.len() != v.len()
    {
        let (q, v) = (q.len(), v.len());
        return Err(value_error(format!(
            "q has {q} coordinates and v has {v}, but they must have equally many"
        )));
    }
    EquationSystem::of_catalogue(system, q, v).map_err(Raised::raised)
}

impl Loop {
    pub(crate) fn timing(&self) -> PyResult<Timing> {
        let gains = -MOST_GAIN..=MOST_GAIN;
        let weights = 0.0..=MOST_GAIN;
        let feedback = self.feedback.map(|gain| {
            within("feedback", &gain, &gains)
                .map(|()| Feedback { position: gain[0], velocity: gain[1] })
        });
        let cost = self.cost_weights.map(|weight| {
            within("cost_weights", &weight, &weights).map(|()| {
                let [position, velocity, command] = weight;
                LqrWeights { position, velocity, command }
            })
        });
        let loss = self.loss.map(|loss| match (0.0..1.0).contains(&loss) {
            true => Ok(loss),
            false => {
                Err(value_error(format!("loss is {loss}, but it must be at least 0 and below 1")))
            }
        });
        let of = |name, value: &Option<(String, f64)>| {
            value.as_ref().map(|(kind, rms)| law(name, kind, *rms)).transpose()
        };
        let timing = Timing {
            feedback: feedback.transpose()?,
            latency: self.latency.as_ref().map(late).transpose()?,
            jitter: of("jitter", &self.jitter)?,
            skew: of("skew", &self.skew)?,
            loss: loss.transpose()?,
            weights: cost.transpose()?,
        };
        let needs = [
            ("latency", timing.latency.is_some()),
            ("loss", timing.loss.is_some()),
            ("cost_weights", timing.weights.is_some()),
        ];
        match needs.into_iter().find(|(_, given)| *given && timing.feedback.is_none()) {
            Some((name, _)) => Err(value_error(format!(
                "{name} is given, but there is no loop: it needs feedback"
            ))),
            None => Ok(timing),
        }
    }
}

fn late((unit, number): &(String, f64)) -> PyResult<LatencyOption> {
    if !(*number >= 0.0 && number.is_finite()) {
        return Err(value_error(format!(
            "latency is {number}, but it must be finite and at least 0"
        )));
    }
    Ok(if unit == "steps" {
        LatencyOption::Steps(*number)
    } else {
        LatencyOption::Seconds(*number)
    })
}

/// A law with mean zero.
pub(crate) fn law(name: &str, kind: &str, rms: f64) -> PyResult<Jitter> {
    within(name, &[rms], &(0.0..=MOST_RMS))?;
    match kind {
        "gaussian" => Ok(Jitter::Gaussian(rms)),
        "uniform" => Ok(Jitter::Uniform(rms)),
        other => Err(unknown(&format!("law of {name}"), other, ["gaussian", "uniform"])),
    }
}

/// Fails if a number is outside the allowed range.
pub(crate) fn within(name: &str, numbers: &[f64], allowed: &RangeInclusive<f64>) -> PyResult<()> {
    match numbers.iter().find(|x| !allowed.contains(x)) {
        Some(x) => {
            let (least, most) = (allowed.start(), allowed.end());
            Err(value_error(format!("{name} is {x:?}, but it must be {least:?} to {most:?}")))
        }
        None => Ok(()),
    }
}
