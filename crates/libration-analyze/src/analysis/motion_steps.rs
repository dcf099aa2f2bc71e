//! Stable steps along the motion of a system.

use std::sync::atomic::{AtomicBool, Ordering};

use libration::analysis::{
    LinearStepper, StabilityFunction, StepLimits, jacobian, without_rounding,
};
use libration::equations::{Degree, StepProgram};
use libration::linear::eigenvalues;
use libration::{AnyMethod, Method};
use libration_settings::equations::EquationSystem;
use serde::Serialize;

use crate::step::AnalyzeError;

/// The largest stable steps of linearisations along the motion from the start of a system.
///
/// Each is that of the linear system with the coefficients of one state. As these change, it is an estimate and no bound.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MotionSteps {
    /// The least of the largest stable steps in s; none if none is limited.
    pub largest_stable_dt: Option<f64>,
    /// The time in s of the state with the least.
    pub at_time: f64,
    /// The number of states.
    pub states: usize,
    /// The number of those at which it is not known.
    pub unknown_states: usize,
    /// The end in s of the part of the motion that was examined.
    pub until: f64,
}

/// The most states, and the most over the square of their dimension.
const MOST_STATES: usize = 64;
const MOST_WORK: usize = 20_000;

/// The most states of a plant whose stable steps are searched at each state of the motion.
const MOST_SEARCHED: usize = 24;

/// Operations of the motion: less than a second.
const MOST_OPERATIONS: usize = 1 << 27;

/// Steps of the motion.
const MOST_STEPS: usize = 100_000;

/// The error of a step relative to a state, and to the largest.
const TOLERANCE: f64 = 1e-6;

/// Steps between two checks of the stop flag.
const CHUNK: usize = 1 << 8;

impl MotionSteps {
    /// Follows the motion for `horizon` seconds, or less where that takes long.
    ///
    /// # Errors
    /// [`AnalyzeError::Interrupted`].
    pub fn new(
        system: &EquationSystem,
        method: AnyMethod,
        horizon: f64,
        stop: &AtomicBool,
    ) -> Result<Self, AnalyzeError> {
        let (samples, until) = samples(system, horizon, stop)?;
        let mut found = MotionSteps {
            largest_stable_dt: None,
            at_time: 0.0,
            states: samples.len(),
            unknown_states: 0,
            until,
        };
        let limits = StepLimits::searched(method);
        for (time, state) in &samples {
            if stop.load(Ordering::Relaxed) {
                return Err(AnalyzeError::Interrupted);
            }
            match largest_stable_step(system, (method, &limits), state) {
                None => found.unknown_states += 1,
                Some(dt) if dt < found.largest_stable_dt.unwrap_or(f64::INFINITY) => {
                    (found.largest_stable_dt, found.at_time) = (Some(dt), *time);
                }
                Some(_) => {}
            }
        }
        Ok(found)
    }

    /// Whether steps of `dt` seconds are stable at all examined states.
    pub(super) fn allows(&self, dt: f64) -> bool {
        self.unknown_states == 0 && self.largest_stable_dt.is_none_or(|limit| dt < limit)
    }
}

/// The end of the stable steps that begin at 0, of the linearisation at a state; zero if there are none. None if it is not known.
fn largest_stable_step(
    system: &EquationSystem,
    (method, limits): (AnyMethod, &StepLimits),
    state: &[f64],
) -> Option<f64> {
    let a = system.state_matrix(&jacobian(system.equations.dynamics(), state));
    let is_first_order = system.equations.degrees().iter().any(|d| matches!(d, Degree::State(_)));
    let stepper = match is_first_order {
        false => LinearStepper::new(&a)?,
        true => LinearStepper::of_first_order(&a)?,
    };
    if !stepper.applies(method) {
        return None;
    }
    let mut values = without_rounding(&eigenvalues(&a)?);
    if StabilityFunction::of(method).is_none() {
        if system.equations.dynamics().is_positional() {
            // Pairs ±σ of real rates grow as those of the exact system do.
            values.retain(|value| value.im.abs() > value.re.abs());
            if values.iter().any(|value| value.re.abs() > 1e-9 * value.norm()) {
                return None;
            }
        } else if values.len() > MOST_SEARCHED
            || values.iter().any(|value| value.re == 0.0 && value.im != 0.0)
        {
            // A search, in exact arithmetic for the latter, takes too long at each state.
            return None;
        }
    }
    let windows = limits.of(&stepper, &values)?;
    let first = windows.first().filter(|window| window.from == 0.0);
    Some(first.map_or(0.0, |window| window.to))
}

/// Times and states of the motion with their inputs, and the time of the last one.
type Samples = (Vec<(f64, Vec<f64>)>, f64);

/// States at about equal numbers of steps of RK4, whose length follows their error, so that fast parts of the motion have more of them.
fn samples(
    system: &EquationSystem,
    horizon: f64,
    stop: &AtomicBool,
) -> Result<Samples, AnalyzeError> {
    let dynamics = system.equations.dynamics();
    let program = StepProgram::new(Method::Rk4, dynamics);
    let mut run = program.program().on::<f64>();
    let (n, start) = (2 * dynamics.degrees(), system.start());
    let mut after = |state: &[f64], dt: f64| -> Vec<f64> {
        let mut inputs = state.to_vec();
        inputs.push(dt);
        let mut next: Vec<f64> = run.run(&inputs).collect();
        next.extend_from_slice(&state[n..]);
        next
    };
    let most_steps = MOST_OPERATIONS / (3 * program.program().operations().max(1));
    let most_steps = most_steps.min(MOST_STEPS);
    let most = (MOST_WORK / n.pow(2).max(1)).clamp(8, MOST_STATES);
    let size = system.state_matrix(&jacobian(dynamics, &start)).row_sum_norm();
    let mut dt = if size > 0.0 && size.is_finite() { (0.1 / size).min(horizon) } else { horizon };
    let (mut time, mut state) = (0.0, start.clone());
    let mut found = vec![(time, state.clone())];
    // One state in so many steps is kept, so that they are spread over all steps.
    let (mut steps, mut every) = (0, 1);
    for number in 1..=most_steps {
        if number % CHUNK == 0 && stop.load(Ordering::Relaxed) {
            return Err(AnalyzeError::Interrupted);
        }
        if time >= horizon {
            break;
        }
        dt = dt.min(horizon - time);
        let whole = after(&state, dt);
        let half = after(&state, 0.5 * dt);
        let halves = after(&half, 0.5 * dt);
        let largest = halves.iter().map(|x| x.abs()).fold(0.0, f64::max);
        let error = system
            .states
            .iter()
            .map(|own| {
                let (a, b) = (whole[own.place], halves[own.place]);
                (a - b).abs() / (TOLERANCE * (b.abs() + 1e-3 * largest) + f64::MIN_POSITIVE)
            })
            .fold(0.0, |most: f64, x| if x.is_nan() { f64::INFINITY } else { most.max(x) });
        if error > 15.0 {
            dt *= if error.is_finite() { (0.9 * (15.0 / error).powf(0.2)).max(0.1) } else { 0.1 };
            if time + dt == time {
                break;
            }
            continue;
        }
        (time, state) = (if dt == horizon - time { horizon } else { time + dt }, halves);
        steps += 1;
        if steps % every == 0 {
            found.push((time, state.clone()));
        }
        if found.len() > 4 * most {
            let mut kept = (0..).map(|k| k % 2 == 0);
            found.retain(|_| kept.next().unwrap_or(true));
            every *= 2;
        }
        dt *= if error > 0.0 { (0.9 * (15.0 / error).powf(0.2)).min(4.0) } else { 4.0 };
    }
    if found.last().is_some_and(|(last, _)| *last != time) {
        found.push((time, state));
    }
    let last = found.len() - 1;
    let part = (last as f64 / (most - 1) as f64).max(1.0);
    let places = (0..most).map(|k| (k as f64 * part).round() as usize);
    let mut kept: Vec<usize> = places.filter(|&k| k <= last).chain([last]).collect();
    kept.dedup();
    Ok((kept.into_iter().map(|k| found[k].clone()).collect(), time))
}
