//! Results of an analysis.

use std::collections::BTreeMap;

use libration::Scalar;
use libration::analysis::{DriftForecast, LinearMap, QuadraticForm};
use libration::number::Wide;
use serde::{Serialize, Serializer};
use serde_json::value::RawValue;

use super::{LargestDt, LoopAnalysis, OrderOfWord, Request, StepMatrix, StepVerdicts};
use crate::motion::MotionExamination;
use crate::newton_residual::NewtonResidual;

/// The analysis of one step; the fields are the keys of `analyze --json`.
#[derive(Debug, Serialize)]
pub struct Analysis {
    /// The request.
    #[serde(flatten)]
    pub request: RequestSummary,
    /// The step as a matrix.
    #[serde(flatten)]
    pub matrix: StepMatrix,
    /// The update matrix of the oscillator with ω = 1 as exact polynomials in `z = ωΔt`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub update_matrix_in_z: Option<Vec<Vec<String>>>,
    /// Whether every orbit stays bounded; unknown for nonlinear systems and for marginal coupled modes.
    pub bounded: Option<bool>,
    /// The intervals `[from, to]` of Δt in s within which every orbit of an uncoupled linear system stays
    /// bounded, isolated exactly; of a free mass, whose exact motions are not bounded, those within which steps
    /// add no growth. A missing end is `null`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stability_windows: Option<Vec<[Option<f64>; 2]>>,
    /// The largest time steps of an oscillator that meet the criteria of the request.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest_dt: Option<LargestDt>,
    /// The quadratic form that a symplectic linear step conserves.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub modified_hamiltonian: Option<ModifiedHamiltonian>,
    /// The order of a splitting method by the expansion of its word of kicks and drifts.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub order_of_word: Option<OrderOfWord>,
    /// The energy drift; none if the initial energy is zero.
    #[serde(flatten, serialize_with = "drift_or_nulls")]
    pub drift: Option<Drift>,
    /// The motion of a nonlinear system beside the exact one, without a loop.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motion: Option<MotionExamination>,
    /// The verdicts on the step, the motion and the loop.
    pub verdicts: StepVerdicts,
    /// What the Newton steps of an implicit integrator leave in the motion of a nonlinear system; none without an iteration.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub newton_residual: Option<NewtonResidual>,
    /// The analysis of the loop, if the request has timing options.
    #[serde(flatten)]
    pub timing: Option<LoopAnalysis>,
}

/// Serialises a drift, or its keys with `null`.
fn drift_or_nulls<S: Serializer>(drift: &Option<Drift>, serializer: S) -> Result<S::Ok, S::Error> {
    if let Some(drift) = drift {
        return drift.serialize(serializer);
    }
    let keys = ["max_energy_drift", "log10_max_energy_drift", "max_energy_drift_step"];
    serializer.collect_map(keys.map(|key| (key, None::<f64>)))
}

/// The request of an analysis.
#[derive(Debug, Serialize)]
pub struct RequestSummary {
    /// The system.
    pub system: String,
    /// Its parameters.
    pub parameters: BTreeMap<String, f64>,
    /// The integrator.
    pub integrator: &'static str,
    /// The time step, in s.
    pub dt: f64,
    /// Initial positions.
    pub q: Vec<f64>,
    /// Initial velocities.
    pub v: Vec<f64>,
    /// Number of steps of the drift.
    pub steps: u64,
    /// Whether the system is linear. If not, the matrix belongs to the linearisation at `q`, `v`.
    pub linear: bool,
    /// Caveats about the numbers, if there are any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
}

impl RequestSummary {
    pub(super) fn new(request: &Request) -> Self {
        let linear = request.system.is_linear();
        RequestSummary {
            system: request.system.name.clone(),
            parameters: parameters(request),
            integrator: request.stepping.name(),
            dt: request.dt,
            q: request.system.q.clone(),
            v: request.system.v.clone(),
            steps: request.steps,
            linear,
            note: note(request),
        }
    }
}

/// The parameters of the system; those of a compiled one include its mass and stiffness where they are given.
fn parameters(request: &Request) -> BTreeMap<String, f64> {
    let owned = |(name, value): (&'static str, f64)| (name.to_owned(), value);
    match request.compiled() {
        Some(system) => request.actuation().parameters(system).into_iter().map(owned).collect(),
        None => request.system.definitions.parameters.iter().cloned().collect(),
    }
}

fn note(request: &Request) -> Option<String> {
    let linearised = "the system is not linear: matrix, eigenvalues and defects are those of the linearisation of one step at \
                      the given state; the energy drift is simulated in f64";
    let caveat = request
        .stepping
        .method()
        .zip(request.compiled())
        .and_then(|(method, system)| system.caveat(method));
    let linearised = (!request.system.is_linear()).then(|| linearised.to_owned());
    let notes: Vec<String> = linearised.into_iter().chain(caveat).collect();
    (!notes.is_empty()).then(|| notes.join("; "))
}

/// The quadratic form `qq·q² + 2·qv·q·v + vv·v²` per unit mass that a symplectic step conserves in place of the
/// energy, for each degree of freedom. It is scaled to `vv = ½`.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct ModifiedHamiltonian {
    /// Coefficient of `q²`, in s⁻².
    pub qq: f64,
    /// Half the coefficient of `q·v`, in s⁻¹.
    pub qv: f64,
    /// Coefficient of `v²`.
    pub vv: f64,
}

impl ModifiedHamiltonian {
    /// The form of a linear step; none if the step does not conserve areas in each degree of
    /// freedom, or if `q` does not depend on `v`.
    pub(super) fn of(step: &LinearMap, conserves: bool) -> Option<Self> {
        let blocks = step.decoupled()?;
        let form = QuadraticForm::carried_by(&blocks[0]);
        let scaled = |x: Wide| (x / form.vv).ratio(1, 2).to_f64();
        // A cross term that symmetry forbids comes out as rounding of the 1024 bits.
        let (cross, square) = (form.qv * form.qv, form.qq * form.vv);
        let rounding = match (cross.exponent(), square.exponent()) {
            (Some(cross), Some(square)) => cross < square - 1800,
            _ => false,
        };
        let qv = if rounding { 0.0 } else { scaled(form.qv) };
        (conserves && !form.vv.is_zero()).then(|| ModifiedHamiltonian {
            qq: scaled(form.qq),
            qv,
            vv: scaled(form.vv),
        })
    }
}

/// The largest relative energy drift over a number of steps.
#[derive(Debug, Serialize)]
pub struct Drift {
    /// `max |E_n − E₀| / |E₀|`, as a decimal that may exceed the range of an `f64`.
    pub max_energy_drift: Box<RawValue>,
    /// Its decimal logarithm; none if there is no drift at all.
    pub log10_max_energy_drift: Option<f64>,
    /// The step with this drift.
    pub max_energy_drift_step: u64,
    /// `exact` or `simulated`.
    pub max_energy_drift_method: &'static str,
    /// The step at which the simulation left the range of `f64`, if it did.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stopped_at_step: Option<u64>,
}

impl From<DriftForecast> for Drift {
    fn from(forecast: DriftForecast) -> Self {
        let value = forecast.drift.to_f64();
        let decimal =
            if value.is_infinite() { forecast.drift.to_decimal(17) } else { format!("{value:?}") };
        Drift {
            max_energy_drift: raw(decimal),
            log10_max_energy_drift: (!forecast.drift.is_zero())
                .then(|| forecast.drift.log10().to_f64()),
            max_energy_drift_step: forecast.at_step,
            max_energy_drift_method: "exact",
            stopped_at_step: None,
        }
    }
}

impl Drift {
    /// The largest drift of a simulation, which may have left the range of `f64` at a step.
    pub(super) fn simulated(largest: f64, at_step: u64, stopped: Option<u64>) -> Self {
        let shown = if largest.is_finite() { format!("{largest:?}") } else { "null".into() };
        Drift {
            max_energy_drift: raw(shown),
            log10_max_energy_drift: Some(largest.log10()).filter(|x| x.is_finite()),
            max_energy_drift_step: at_step,
            max_energy_drift_method: "simulated",
            stopped_at_step: stopped,
        }
    }
}

/// A JSON number from its digits.
fn raw(decimal: String) -> Box<RawValue> {
    RawValue::from_string(decimal).unwrap_or_else(|_| RawValue::NULL.to_owned())
}
