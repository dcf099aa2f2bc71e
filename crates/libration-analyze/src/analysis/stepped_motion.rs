//! The motion of a system under steps of an integrator: order, errors and energy, predicted and measured.

use std::sync::atomic::AtomicBool;

use libration::equations::StepProgram;
use libration::{AnyMethod, Float};
use libration_settings::equations::{EquationSystem, NamedState};
use serde::Serialize;

use crate::motion::{
    EnergyChange, MotionExamination, MotionState, MotionSubject, StepRun, examine, most_steps,
};
use crate::step::{AnalyzeError, lost_order, spectral_radius, step_order};

/// The motion from the start of a system.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SteppedMotion {
    /// The name of the integrator.
    pub integrator: &'static str,
    /// The time step in s.
    pub dt: f64,
    /// The order of the integrator if forces depend on positions alone.
    pub classical_order: u32,
    /// The order on this system; none if a step is exact or a derivative does not exist.
    pub order: Option<u32>,
    /// Whether the order is that of the certificate of a table. Others are those of a step of this system in 1024-bit arithmetic.
    pub order_is_certified: bool,
    /// The operations of a step.
    pub operations_per_step: usize,
    /// The largest size of an eigenvalue of the derivative of a step at the equilibrium; none without one.
    pub spectral_radius: Option<f64>,
    /// Steps over which errors are estimated.
    pub error_steps: u64,
    /// The least factor by which a halved step reduces errors, predicted for small steps: 2 to the power of the order.
    pub predicted_reduction: Option<f64>,
    /// The states in these steps, and what halved steps change.
    pub errors: Vec<StateError>,
    /// All steps of the request beside the exact motion.
    pub examination: MotionExamination,
    /// The drift of the energy; none if the system has no energy.
    pub energy: Option<EnergyChange>,
    /// The first step after which a state is not finite; none if there is none.
    pub diverged_at_step: Option<u64>,
}

/// The error of a state, estimated by halved steps.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StateError {
    /// The name of the state.
    pub name: String,
    /// Its unit; empty without one.
    pub unit: String,
    /// The value in the end.
    pub value: f64,
    /// The largest error in these steps, as halved steps have it. They may agree on something wrong; the examination is independent.
    pub error: f64,
    /// The factor by which halved steps reduce the largest error, measured; none where rounding hides it.
    pub reduction: Option<f64>,
}

/// The most steps over which errors are estimated.
const ERROR_STEPS: u64 = 1000;

/// Changes below this many roundings of a value are rounding: each of up to 4000 steps rounds a state two times or more.
const ROUNDINGS: f64 = 1e4;

impl SteppedMotion {
    /// Follows the motion for `steps` steps of `dt` seconds, or fewer if they take long. `equilibrium` has positions, velocities and
    /// inputs.
    ///
    /// # Errors
    /// [`AnalyzeError::Interrupted`].
    pub fn new(
        system: &EquationSystem,
        method: AnyMethod,
        dt: f64,
        steps: u64,
        equilibrium: Option<&[f64]>,
        stop: &AtomicBool,
    ) -> Result<Self, AnalyzeError> {
        let step = StepProgram::of(method, system.equations.dynamics());
        let operations = step.program().operations();
        let error_steps = steps.min(ERROR_STEPS).min(most_steps(&step));
        let places: Vec<usize> = system.states.iter().map(|state| state.place).collect();
        let certified_order = match method {
            AnyMethod::Explicit(method) => {
                method.certified_order(system.equations.dynamics().is_positional())
            }
            AnyMethod::Implicit(_) => None,
        };
        let start = system.start();
        let supposes_positional_forces = matches!(
            method,
            AnyMethod::Explicit(method) if method.supposes_positional_forces()
        );
        let order = certified_order.or_else(|| match supposes_positional_forces {
            true => Some(lost_order(&step, &start, &places, dt).unwrap_or(method.order())),
            false => step_order(&step, &start, &places, dt),
        });
        let predicted_reduction = order.map(|order| 2_f64.powi(order as i32));
        let runs = [0, 1, 2].map(|halvings| StepRun {
            start: &start,
            step: &step,
            dt: dt / f64::from(1 << halvings),
            substeps: 1 << halvings,
        });
        let errors = errors(system, &runs, error_steps, predicted_reduction, stop)?;
        let states = MotionState::all(system);
        let subject = MotionSubject {
            dynamics: system.equations.dynamics(),
            start: &start,
            states: &states,
            is_affine: system.is_linear(),
            energy_unit: &system.energy_unit,
        };
        let mut examination = examine(&subject, &step, dt, steps, stop)?;
        let mut energy = examination.energy.take();
        if let Some(change) = &mut energy {
            let fine = largest_energy_change(system, &runs[1], change.steps, stop)?;
            let size = change.scale.unwrap_or_default().max(change.start.abs());
            let rounding = ROUNDINGS * f64::UNIT_ROUNDOFF * size;
            change.reduction = (fine > rounding).then(|| change.largest / fine);
        }
        Ok(SteppedMotion {
            integrator: method.name(),
            dt,
            classical_order: method.order(),
            order,
            order_is_certified: certified_order.is_some(),
            operations_per_step: operations,
            spectral_radius: equilibrium.and_then(|at| spectral_radius(&step, system, at, dt)),
            error_steps,
            predicted_reduction,
            errors,
            diverged_at_step: examination.diverged_at_step,
            examination,
            energy,
        })
    }
}

/// The states after steps, and what two and four steps in their place change, in the largest sizes over all steps.
fn errors(
    system: &EquationSystem,
    runs: &[StepRun<'_>; 3],
    steps: u64,
    predicted_reduction: Option<f64>,
    stop: &AtomicBool,
) -> Result<Vec<StateError>, AnalyzeError> {
    let mut all: [Vec<Vec<f64>>; 3] = Default::default();
    for (run, states) in runs.iter().zip(&mut all) {
        run.follow(steps, stop, |_, state| states.push(state.to_vec()))?;
    }
    let [coarse, middle, fine] = &all;
    let state = |state: &NamedState| {
        let place = state.place;
        let largest = |values: &mut dyn Iterator<Item = f64>| {
            values.fold(0.0_f64, |most, x| if x > most || x.is_nan() { x } else { most })
        };
        let apart = |a: &[Vec<f64>], b: &[Vec<f64>]| {
            largest(&mut a.iter().zip(b).map(|(a, b)| (a[place] - b[place]).abs()))
        };
        let (first, second) = (apart(coarse, middle), apart(middle, fine));
        let size = largest(&mut coarse.iter().map(|state| state[place].abs()));
        let rounding = ROUNDINGS * f64::UNIT_ROUNDOFF * size;
        let reduction = (second > rounding).then(|| first / second);
        let factor = predicted_reduction.unwrap_or(2.0);
        StateError {
            name: state.name.clone(),
            unit: state.unit.clone(),
            value: coarse.last().map_or(state.start, |state| state[place]),
            error: first * factor / (factor - 1.0),
            reduction: reduction.filter(|reduction| reduction.is_finite()),
        }
    };
    Ok(system.states.iter().map(state).collect())
}

/// The largest change of the energy under steps.
fn largest_energy_change(
    system: &EquationSystem,
    run: &StepRun<'_>,
    steps: u64,
    stop: &AtomicBool,
) -> Result<f64, AnalyzeError> {
    let program = system.equations.dynamics().energy();
    let mut energy = program.map(|energy| energy.on::<f64>());
    let mut of = |state: &[f64]| {
        energy.as_mut().and_then(|energy| energy.run(state).next()).unwrap_or(f64::NAN)
    };
    let (start, mut largest) = (of(run.start), 0.0_f64);
    run.follow(steps, stop, |_, state| {
        let change = (of(state) - start).abs();
        largest = if change > largest || change.is_nan() { change } else { largest };
    })?;
    Ok(largest)
}
