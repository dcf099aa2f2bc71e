//! The motion of a system by equations under steps of an integrator: order, errors and energy, predicted and measured.

use std::sync::atomic::{AtomicBool, Ordering};

use libration::equations::StepProgram;
use libration::{AnyMethod, Float};
use libration_settings::equations::EquationSystem;
use serde::Serialize;

use super::step::{lost_order, spectral_radius, step_order};
use crate::AnalyzeError;

/// The motion from the start of a system.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EquationMotion {
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
    /// The errors of states after these steps.
    pub errors: Vec<StateError>,
    /// The drift of the energy; none if the system has no energy.
    pub energy: Option<EnergyChange>,
    /// The first step after which a state is not finite; none if there is none.
    pub diverged_at_step: Option<u64>,
}

impl EquationMotion {
    /// Whether a measured reduction is that of small steps: at least half of the predicted one.
    pub fn is_resolved(&self, reduction: Option<f64>) -> bool {
        reduction.is_none_or(|x| self.predicted_reduction.is_none_or(|least| x > least / 2.0))
    }
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
    /// The error of the value.
    pub error: f64,
    /// The factor by which a halved step reduces it, measured; none where rounding hides it.
    pub reduction: Option<f64>,
}

/// The largest change of the energy.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EnergyChange {
    /// The energy at the start.
    pub start: f64,
    /// The unit; empty without one.
    pub unit: String,
    /// Number of steps.
    pub steps: u64,
    /// The largest absolute change.
    pub largest: f64,
    /// The step at which it occurs.
    pub largest_at_step: u64,
    /// The change in the end.
    pub last: f64,
    /// The factor by which a halved step reduces the largest change over the same time, measured; none without a change.
    pub reduction: Option<f64>,
}

/// The most steps over which errors are estimated.
const ERROR_STEPS: u64 = 1000;

/// Operations of all steps of a motion: less than a second.
const MOST_OPERATIONS: u64 = 1 << 29;

/// Steps between two checks of the stop flag.
const CHUNK: u64 = 1 << 12;

/// Changes below this many roundings of a value are rounding: each of up to 4000 steps rounds a state two times or more.
const ROUNDINGS: f64 = 1e4;

impl EquationMotion {
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
        // Three runs, with steps of which two and four take the time of one.
        let most = (MOST_OPERATIONS / (operations.max(1) as u64 * 7)).max(1);
        let steps = steps.min(most);
        let error_steps = steps.min(ERROR_STEPS);
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
        let runs = [0, 1, 2].map(|halvings| Run {
            system,
            step: &step,
            dt: dt / f64::from(1 << halvings),
            substeps: 1 << halvings,
        });
        let mut ends = Vec::new();
        for run in &runs {
            ends.push(run.end(error_steps, stop)?);
        }
        let errors = system.states.iter().map(|state| {
            let [coarse, middle, fine] = [0, 1, 2].map(|i| ends[i].state[state.place]);
            let (first, second) = (coarse - middle, middle - fine);
            let rounding = ROUNDINGS * f64::UNIT_ROUNDOFF * coarse.abs().max(middle.abs());
            let reduction = (second.abs() > rounding).then(|| first / second);
            let factor = predicted_reduction.unwrap_or(2.0);
            StateError {
                name: state.name.clone(),
                unit: state.unit.clone(),
                value: coarse,
                error: (first * factor / (factor - 1.0)).abs(),
                reduction,
            }
        });
        let errors = errors.collect();
        let energy = match system.equations.dynamics().energy().is_some() {
            true => {
                let [coarse, fine] = [runs[0].energy(steps, stop)?, runs[1].energy(steps, stop)?];
                let rounding = ROUNDINGS * f64::UNIT_ROUNDOFF * coarse.start.abs();
                let reduction = (fine.largest > rounding).then(|| coarse.largest / fine.largest);
                Some(EnergyChange { reduction, ..coarse })
            }
            false => None,
        };
        Ok(EquationMotion {
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
            energy,
            diverged_at_step: ends[0].diverged_at,
        })
    }
}

/// The motion under steps of one length.
struct Run<'a> {
    system: &'a EquationSystem,
    step: &'a StepProgram,
    dt: f64,
    /// Steps that take the time of one of the request.
    substeps: u64,
}

struct End {
    state: Vec<f64>,
    diverged_at: Option<u64>,
}

impl Run<'_> {
    fn end(&self, steps: u64, stop: &AtomicBool) -> Result<End, AnalyzeError> {
        let mut end = End { state: self.system.start(), diverged_at: None };
        self.follow(steps, stop, |step, state| {
            end.state = state.to_vec();
            end.diverged_at = state.iter().any(|x| !x.is_finite()).then_some(step);
        })?;
        Ok(end)
    }

    fn energy(&self, steps: u64, stop: &AtomicBool) -> Result<EnergyChange, AnalyzeError> {
        let program = self.system.equations.dynamics().energy();
        let mut energy = program.map(|energy| energy.on::<f64>());
        let mut of = |state: &[f64]| {
            energy.as_mut().and_then(|energy| energy.run(state).next()).unwrap_or(f64::NAN)
        };
        let start = of(&self.system.start());
        let unit = self.system.energy_unit.clone();
        let mut change = EnergyChange {
            start,
            unit,
            steps,
            largest: 0.0,
            largest_at_step: 0,
            last: 0.0,
            reduction: None,
        };
        self.follow(steps, stop, |step, state| {
            change.last = of(state) - start;
            // What is no number is the largest.
            if change.last.is_nan() || change.last.abs() > change.largest {
                (change.largest, change.largest_at_step) = (change.last.abs(), step);
            }
        })?;
        Ok(change)
    }

    /// Shows positions and velocities with the inputs after each step of the request, until one is not finite.
    fn follow(
        &self,
        steps: u64,
        stop: &AtomicBool,
        mut show: impl FnMut(u64, &[f64]),
    ) -> Result<(), AnalyzeError> {
        let mut run = self.step.program().on::<f64>();
        let mut inputs = self.system.start();
        let last = inputs.len();
        inputs.push(self.dt);
        let mut next = Vec::with_capacity(last);
        for step in 1..=steps {
            if step % CHUNK == 0 && stop.load(Ordering::Relaxed) {
                return Err(AnalyzeError::Interrupted);
            }
            for _ in 0..self.substeps {
                next.clear();
                next.extend(run.run(&inputs));
                inputs[..next.len()].copy_from_slice(&next);
            }
            show(step, &inputs[..last]);
            if next.iter().any(|x| !x.is_finite()) {
                break;
            }
        }
        Ok(())
    }
}
