//! Analysis of linear plants, of steps of integrators on them and of loops around them: the output of `libration analyze --plant`.

mod closed_loop;
mod error;
mod mode;
mod motion_end;
mod plant_verdict;
mod simulated_mode;
mod step;
mod system_motion;
mod verdicts;

use std::sync::atomic::{AtomicBool, Ordering};

use libration::AnyMethod;
use libration::analysis::{LinearStepper, without_rounding};
use libration::linear::{
    Complex64, DiscreteController, LinearLoop, LinearPlant, LoopTiming, Matrix, ModeDetails, Signal,
};
use libration_settings::linear_loop::OperatingPoint;
use libration_work::{Silent, Work};
use serde::Serialize;

use crate::Stepping;
pub use closed_loop::{
    ClosedLoop, LoopMode, NOT_SIMULATED, StateDeviation, hidden_loop, loop_verdict,
};
pub use error::LinearAnalysisError;
pub use mode::Mode;
pub use motion_end::{Excursion, MotionEnd, SystemMotion};
pub use simulated_mode::SimulatedMode;
pub use step::{ModeUnderSteps, StepAnalysis};
pub use system_motion::{MEMORIES, SystemLoop};
pub use verdicts::LinearVerdicts;

/// Version of the JSON format.
pub const SCHEMA: &str = "libration.linear-analysis/1";

/// A linear plant to analyse.
#[derive(Clone, Debug)]
pub struct LinearRequest {
    /// The plant with the loop around it; without a controller its commands are zero.
    pub linear: LinearLoop,
    /// The timing of the loop; none without a controller.
    pub timing: Option<LoopTiming>,
    /// The time step of integrators in s.
    pub dt: Option<f64>,
    /// The integrator, or exact steps; none for all.
    pub integrator: Option<Stepping>,
    /// The operating point, if the plant is a linearisation.
    pub operating_point: Option<OperatingPoint>,
    /// Whether the plant is the linearisation of a nonlinear system.
    pub is_linearised: bool,
    /// The system by equations that the plant is the linearisation of.
    pub system: Option<SystemLoop>,
    /// A restriction of the numbers.
    pub note: Option<String>,
}

/// The analysis of a linear plant; the fields are the keys of `analyze --plant --json`.
#[derive(Clone, Debug, Serialize)]
pub struct LinearAnalysis {
    /// The version of this format.
    pub schema: &'static str,
    /// The states of the plant, those of lags and filters last.
    pub states: Vec<SignalName>,
    /// Its inputs.
    pub inputs: Vec<SignalName>,
    /// Its outputs.
    pub outputs: Vec<SignalName>,
    /// The period of a sampled plant in s; none in continuous time.
    pub sampling_period: Option<f64>,
    /// Whether half of the states are rates of the other half, so that each integrator applies.
    pub mechanical: bool,
    /// The equilibrium at which the plant is a linearisation; none of other plants.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub operating_point: Option<OperatingPoint>,
    /// Whether the plant is a linearisation that is zero to rounding, so that it decides nothing.
    #[serde(skip)]
    pub decides_nothing: bool,
    /// The modes of the plant, the one that grows fastest first; of a pair one.
    pub modes: Vec<Mode>,
    /// The largest size of an eigenvalue in 1/s.
    pub fastest_rate: f64,
    /// The smallest size of an eigenvalue other than zero in 1/s; none if all are zero.
    pub slowest_rate: Option<f64>,
    /// The ratio of the two.
    pub stiffness: Option<f64>,
    /// The time step of integrators in s.
    pub dt: Option<f64>,
    /// Steps of the integrators: exact steps first; empty for a sampled plant.
    pub steps: Vec<StepAnalysis>,
    /// The integrators that do not apply to the plant.
    pub not_applicable: Vec<&'static str>,
    /// The closed loop; none without a controller.
    #[serde(rename = "loop")]
    pub closed_loop: Option<ClosedLoop>,
    /// The verdicts on the plant, on the step of the request and on the loop.
    pub verdicts: LinearVerdicts,
    /// A restriction of the numbers, if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
}

/// The name and unit of a signal.
#[derive(Clone, Debug, Serialize)]
pub struct SignalName {
    /// The name.
    pub name: String,
    /// The unit; empty if it is unknown.
    pub unit: String,
}

impl SignalName {
    fn all(signals: &[Signal]) -> Vec<SignalName> {
        let one =
            |Signal { name, unit }: &Signal| SignalName { name: name.clone(), unit: unit.clone() };
        signals.iter().map(one).collect()
    }
}

/// Analyses a linear plant until `stop` is set.
///
/// # Errors
/// [`LinearAnalysisError`]: values that do not fit the plant, before any work, or an interruption.
pub fn analyze(
    request: &LinearRequest,
    stop: &AtomicBool,
) -> Result<LinearAnalysis, LinearAnalysisError> {
    let plant = request.linear.plant();
    let stepper = request.stepper()?;
    let mut details = plant.mode_details();
    if details.is_empty() {
        return Err(LinearAnalysisError::Eigenvalues);
    }
    // Of a sampled plant, a mode of factor zero is infinitely fast: beside it all others would be roundings.
    let mut finite: Vec<&mut Complex64> = details.iter_mut().map(|mode| &mut mode.value).collect();
    finite.retain(|value| value.is_finite());
    let values: Vec<Complex64> = finite.iter().map(|value| **value).collect();
    finite.into_iter().zip(without_rounding(&values)).for_each(|(own, value)| *own = value);
    plant_verdict::remove_rounding(plant, &mut details);
    let modes: Vec<Mode> = details.iter().map(Mode::from).collect();
    let point = request.operating_point.as_ref();
    let sizes = details.iter().map(|mode| mode.value.norm());
    let fastest = sizes.clone().fold(0.0, f64::max);
    let slowest = sizes.filter(|size| *size > 0.0).reduce(f64::min);
    let mut steps = Vec::new();
    let shapes = shapes(&details);
    let decides_nothing = plant_verdict::decides_nothing(&modes, point);
    let subject =
        step::Subject { plant, stepper: stepper.as_ref(), shapes: &shapes, decides_nothing };
    for stepping in request.steppings(stepper.as_ref()) {
        if stop.load(Ordering::Relaxed) {
            return Err(LinearAnalysisError::Interrupted);
        }
        steps.push(subject.analyze(stepping, request.dt, request.integrator.is_some()));
    }
    let applies = |method: &AnyMethod| stepper.as_ref().is_some_and(|own| own.applies(*method));
    let not_applicable = match request.integrator {
        None => AnyMethod::all().filter(|method| !applies(method)).collect(),
        Some(_) => Vec::new(),
    };
    let closed_loop = match &request.timing {
        Some(timing) => Some(ClosedLoop::new(request, timing, &Work::new(&Silent, stop))?),
        None => None,
    };
    let verdicts = LinearVerdicts::new(
        plant_verdict::of_modes(&modes, point),
        request.integrator.and(steps.first()),
        closed_loop.as_ref(),
    );
    Ok(LinearAnalysis {
        schema: SCHEMA,
        states: SignalName::all(&plant.states),
        inputs: SignalName::all(&plant.inputs),
        outputs: SignalName::all(&plant.outputs),
        sampling_period: plant.sampling_period,
        mechanical: stepper.as_ref().is_some_and(LinearStepper::is_mechanical),
        operating_point: point.cloned(),
        decides_nothing,
        modes,
        fastest_rate: fastest,
        slowest_rate: slowest,
        stiffness: slowest.map(|slowest| fastest / slowest),
        dt: request.dt,
        not_applicable: not_applicable.into_iter().map(AnyMethod::name).collect(),
        verdicts,
        steps,
        closed_loop,
        note: request.note.clone(),
    })
}

/// Eigenvalues and shapes.
fn shapes(details: &[ModeDetails]) -> Vec<(Complex64, Vec<Complex64>)> {
    details.iter().map(|mode| (mode.value, mode.shape.clone())).collect()
}

impl LinearRequest {
    /// A plant whose commands are zero, under steps of `dt` seconds of an integrator, or without one of all.
    ///
    /// # Errors
    /// [`LinearAnalysisError`]: a plant that cannot be analysed.
    pub fn open_loop(
        plant: LinearPlant,
        dt: f64,
        integrator: Option<Stepping>,
    ) -> Result<Self, LinearAnalysisError> {
        let [n, m, p] = [&plant.states, &plant.inputs, &plant.outputs].map(Vec::len);
        let silent = DiscreteController::gain(Matrix::zeros(m, p));
        let linear = LinearLoop::new(plant, silent, dt, Matrix::identity(n + m), vec![0.0; p])?;
        Ok(LinearRequest {
            linear,
            timing: None,
            dt: Some(dt),
            integrator,
            operating_point: None,
            is_linearised: false,
            system: None,
            note: None,
        })
    }

    fn plant(&self) -> &LinearPlant {
        self.linear.plant()
    }

    /// The steps of integrators on the plant; none of a sampled plant.
    fn stepper(&self) -> Result<Option<LinearStepper>, LinearAnalysisError> {
        if let Some(dt) = self.dt.filter(|dt| !(dt.is_finite() && *dt > 0.0)) {
            return Err(LinearAnalysisError::Dt(dt));
        }
        if let Some(period) = self.plant().sampling_period {
            return match (self.dt, self.integrator) {
                (None, None) => Ok(None),
                (Some(_), _) => Err(LinearAnalysisError::Sampled { option: "dt", period }),
                (None, Some(_)) => {
                    Err(LinearAnalysisError::Sampled { option: "integrator", period })
                }
            };
        }
        let plant = self.plant();
        let stepper = match plant.has_first_order_states {
            false => LinearStepper::new(&plant.a),
            true => LinearStepper::of_first_order(&plant.a),
        };
        let stepper = stepper.ok_or(LinearAnalysisError::Eigenvalues)?;
        match self.integrator.and_then(Stepping::any_method) {
            Some(method) if !stepper.applies(method) => {
                let allowed = AnyMethod::all().filter(|method| stepper.applies(*method));
                let allowed = allowed.map(AnyMethod::name).chain([Stepping::EXACT]).collect();
                Err(LinearAnalysisError::Integrator { name: method.name(), allowed })
            }
            _ => Ok(Some(stepper)),
        }
    }

    /// The integrators to analyse. With a controller they require a time step.
    fn steppings(&self, stepper: Option<&LinearStepper>) -> Vec<Stepping> {
        let Some(stepper) = stepper else { return Vec::new() };
        match self.integrator {
            Some(one) => vec![one],
            None if self.timing.is_some() && self.dt.is_none() => Vec::new(),
            None => {
                let methods = AnyMethod::all().filter(|method| stepper.applies(*method));
                [Stepping::Exact].into_iter().chain(methods.map(Stepping::from)).collect()
            }
        }
    }
}
