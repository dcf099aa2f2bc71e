//! The motion of a system by equations under steps of an integrator: order, errors and energy, predicted and measured.

use std::sync::atomic::{AtomicBool, Ordering};

use libration::equations::StepProgram;
use libration::linear::{Matrix, eigenvalues};
use libration::number::{Dual, Wide};
use libration::{Elementary, Float, Method, Scalar};
use libration_settings::equations::EquationSystem;
use serde::Serialize;

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
    /// The order on this system, by 1024-bit arithmetic; none if a step is exact or a derivative does not exist.
    pub order: Option<u32>,
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

/// Operations of all steps of a motion: some seconds.
const MOST_OPERATIONS: u64 = 1 << 31;

/// Steps between two checks of the stop flag.
const CHUNK: u64 = 1 << 12;

/// The powers of two by which the time step is multiplied to find the order. The next term of the error is about 2⁻¹⁰ of the first; in
/// steps that were much smaller, the rounding of weights of a method to `f64` would be its largest error.
const SMALL: [i64; 2] = [-10, -11];

/// Distances of the places at which the order is computed from the start. At the nearer one, functions are defined where they are at
/// the start.
const SHIFTS: [f64; 2] = [1.0, 0.01];

/// Changes below this many roundings of a value are rounding.
const ROUNDINGS: f64 = 1e4;

impl EquationMotion {
    /// Follows the motion for `steps` steps of `dt` seconds, or fewer if they take long. `equilibrium` has positions, velocities and
    /// inputs.
    ///
    /// # Errors
    /// [`AnalyzeError::Interrupted`].
    pub fn new(
        system: &EquationSystem,
        method: Method,
        dt: f64,
        steps: u64,
        equilibrium: Option<&[f64]>,
        stop: &AtomicBool,
    ) -> Result<Self, AnalyzeError> {
        let step = StepProgram::new(method, system.equations.dynamics());
        let operations = step.program().operations();
        // Three runs, with steps of which two and four take the time of one.
        let most = (MOST_OPERATIONS / (operations.max(1) as u64 * 7)).max(1);
        let steps = steps.min(most);
        let error_steps = steps.min(ERROR_STEPS);
        let order = order(&step, system, dt);
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

/// The order of a step on a system, from the error of a small step against two of half the length, and that of a smaller one. It is
/// the least of all states at two places near the start, since in special states, such as at rest, terms of the error vanish.
fn order(step: &StepProgram, system: &EquationSystem, dt: f64) -> Option<u32> {
    SHIFTS.into_iter().filter_map(|shift| order_at(step, system, dt, shift)).min()
}

/// The order at a state that is the start but for parts of the golden ratio, `shift` times as large as a coordinate or as 1.
fn order_at(step: &StepProgram, system: &EquationSystem, dt: f64, shift: f64) -> Option<u32> {
    let degrees = system.equations.degrees().len();
    let mut run = step.program().on::<Wide>();
    let mut state: Vec<Wide> = system.start().into_iter().map(Wide::from_f64).collect();
    for named in &system.states {
        let part = (0.618_033_988_749_895 * (1.0 + named.place as f64)).fract() - 0.5;
        let near = named.start + shift * part * named.start.abs().max(1.0);
        state[named.place] = Wide::from_f64(near);
    }
    let inputs = state.split_off(2 * degrees);
    let dt = Wide::from_f64(dt);
    let mut after = |state: &[Wide], power: i64, count: u32| -> Vec<Wide> {
        (0..count).fold(state.to_vec(), |state, _| {
            let dt = dt.scaled(power);
            let all: Vec<Wide> = state.iter().chain(&inputs).copied().chain([dt]).collect();
            run.run(&all).collect()
        })
    };
    let [larger, smaller] = SMALL.map(|power| -> Vec<Wide> {
        let (one, two) = (after(&state, power, 1), after(&state, power - 1, 2));
        one.iter().zip(&two).map(|(&one, &two)| one - two).collect()
    });
    let orders = system.states.iter().filter_map(|named| {
        let [larger, smaller] = [larger[named.place], smaller[named.place]];
        // Errors below 2⁻⁹⁰⁰ are rounding: the step has no other.
        let is_error = larger.exponent().is_some_and(|exponent| exponent > -900);
        let ratio = (larger * smaller.recip()).abs().to_f64();
        (is_error && ratio.is_finite()).then(|| ratio.log2().round() - 1.0)
    });
    let least = orders.reduce(f64::min)?;
    (least >= 0.0).then_some(least as u32)
}

/// The largest size of an eigenvalue of a step at a state: positions, velocities and inputs.
fn spectral_radius(
    step: &StepProgram,
    system: &EquationSystem,
    at: &[f64],
    dt: f64,
) -> Option<f64> {
    let mut run = step.program().on::<Dual<f64>>();
    let mut inputs: Vec<Dual<f64>> = at.iter().map(|&x| Dual::constant(x)).collect();
    inputs.push(Dual::constant(dt));
    let mut columns: Vec<Vec<f64>> = Vec::new();
    for named in &system.states {
        inputs[named.place] = Dual::variable(at[named.place]);
        let end: Vec<f64> = run.run(&inputs).map(|x| x.du).collect();
        columns.push(system.states.iter().map(|state| end[state.place]).collect());
        inputs[named.place] = Dual::constant(at[named.place]);
    }
    let matrix = Matrix::from_fn(columns.len(), columns.len(), |i, j| columns[j][i]);
    eigenvalues(&matrix)?.into_iter().map(|value| value.norm()).reduce(f64::max)
}
