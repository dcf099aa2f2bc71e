//! The energy error of a method over a turn and over a long horizon.

use libration::equations::Evaluation;
use libration::number::TwoFloat;
use libration::simulation::SimulationError;
use libration::{Float, Method, Scalar};
use libration_study::{Fit, StudyError, log_spaced_steps};

use super::{Halvings, Problem};
use libration_analyze::reference_flow::{Rates, distance, flow, size};

/// Turns over which the mean change of the energy is taken. A method of first order needs few,
/// since its change is of the order of its swing, and small steps, since both are large.
fn turns(method: Method) -> u64 {
    if method.order() == 1 { 2 } else { 16 }
}

/// How much further a method of first order may halve its steps. It runs in `f64`, whose rounding
/// is far below its errors.
const FIRST_ORDER: u64 = 64;

/// Changes below these are rounding of many thousands of steps: in double-double, and in `f64`.
const ROUNDING: [f64; 2] = [1e-24, 1e-11];

/// Samples of a running maximum for each decade of steps.
const PER_DECADE: f64 = 16.0;

/// The kind of a change of the energy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// The largest relative drift within a turn.
    Swing,
    /// The mean relative change in a turn, over several turns.
    Rate,
}

/// A change of the energy at ever smaller steps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Changes {
    /// Time steps in s, each half of the one before.
    pub dt: Vec<f64>,
    /// The size of the change.
    pub size: Vec<f64>,
}

/// The running maximum of the energy drift along a horizon.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Horizon {
    /// Steps at which it was taken, evenly spaced in their logarithm.
    pub step: Vec<u64>,
    /// The maximum so far; NaN after an overflow.
    pub largest: Vec<f64>,
}

/// The change of the energy until its order settles, or the steps are as small as they may be.
pub(super) fn changes(
    problem: &Problem,
    change: Change,
    method: Method,
    halvings: Halvings,
) -> Result<Changes, StudyError> {
    let mut changes = Changes::default();
    let first = method.order() == 1;
    let finest = if first { FIRST_ORDER * halvings.finest } else { halvings.finest };
    for steps in (Halvings { finest, ..halvings }).steps() {
        let size = match (change, first) {
            (Change::Swing, true) => swing::<f64>(problem, method, steps),
            (Change::Swing, false) => swing::<TwoFloat>(problem, method, steps),
            (Change::Rate, true) => rate::<f64>(problem, method, steps),
            (Change::Rate, false) => rate::<TwoFloat>(problem, method, steps),
        };
        changes.dt.push(problem.step(steps));
        changes.size.push(match size {
            Err(SimulationError::NotFinite { .. }) => f64::NAN,
            // Rounding of a run is no change.
            Ok(size) if size < ROUNDING[usize::from(first)] => 0.0,
            other => other?,
        });
        if Fit::is_settled(&changes.dt, &changes.size) {
            break;
        }
    }
    Ok(changes)
}

/// `(E − E₀)/|E₀|` with all digits of `S`; absolute where `E₀` is zero. NaN without an energy.
pub(super) struct Drift<'p, S> {
    energy: Option<Evaluation<'p, S>>,
    initial: S,
    scale: f64,
}

impl<'p, S: Float> Drift<'p, S> {
    pub(super) fn new(problem: &'p Problem, start: &[S]) -> Self {
        let energy = problem.dynamics.energy().map(|energy| energy.on::<S>());
        let mut drift = Drift { energy, initial: S::zero(), scale: 1.0 };
        drift.initial = drift.energy(start);
        let size = drift.initial.to_f64().abs();
        drift.scale = if size == 0.0 { 1.0 } else { size };
        drift
    }

    /// The energy at the start.
    pub(super) fn initial(&self) -> S {
        self.initial
    }

    pub(super) fn energy(&mut self, state: &[S]) -> S {
        let energy = self.energy.as_mut().and_then(|energy| energy.run(state).next());
        energy.unwrap_or_else(|| S::from_f64(f64::NAN))
    }

    pub(super) fn of(&mut self, state: &[S]) -> f64 {
        (self.energy(state) - self.initial).to_f64() / self.scale
    }
}

/// The start on numbers of type `S`.
fn start<S: Scalar>(problem: &Problem) -> Vec<S> {
    problem.start.iter().map(|&x| S::from_f64(x)).collect()
}

fn swing<S: Float>(problem: &Problem, method: Method, steps: u64) -> Result<f64, SimulationError> {
    let start = start::<S>(problem);
    let mut drift = Drift::new(problem, &start);
    let mut largest = 0.0_f64;
    let mut watch = |_, state: &[S]| largest = largest.max(drift.of(state).abs());
    problem.run(method, &start, problem.step(steps), steps, &mut watch)?;
    Ok(largest)
}

/// The difference of two smooth means, half the horizon apart: what swings within a turn averages
/// out of each, however the turn ends.
fn rate<S: Float>(problem: &Problem, method: Method, steps: u64) -> Result<f64, SimulationError> {
    let start = start::<S>(problem);
    let mut drift = Drift::new(problem, &start);
    let turns = turns(method);
    let all = steps * turns;
    let mut sums = [[0.0_f64; 2]; 2];
    let mut watch = |step: u64, state: &[S]| {
        let place = 2.0 * step as f64 / all as f64;
        let half = usize::from(place >= 1.0);
        // sin⁴ and its first three derivatives vanish at both ends of a half.
        let weight = (std::f64::consts::PI * place).sin().powi(4);
        sums[half][0] += weight * drift.of(state);
        sums[half][1] += weight;
    };
    problem.run(method, &start, problem.step(steps), all, &mut watch)?;
    let [early, late] = sums.map(|[sum, weight]| sum / weight);
    Ok((late - early).abs() / (turns as f64 / 2.0))
}

/// The running maximum over `turns` turns in `f64`.
pub(super) fn horizon(
    problem: &Problem,
    method: Method,
    steps: u64,
    turns: u64,
) -> Result<Horizon, StudyError> {
    let last = steps * turns;
    let step = log_spaced_steps(last, PER_DECADE);
    let mut drift = Drift::new(problem, &problem.start);
    let mut so_far = 0.0_f64;
    let mut largest = Vec::with_capacity(step.len());
    let mut watch = |n: u64, state: &[f64]| {
        let size = drift.of(state).abs();
        // What is no number is the largest.
        if size > so_far || size.is_nan() {
            so_far = size;
        }
        if step.get(largest.len()) == Some(&n) {
            largest.push(so_far);
        }
    };
    // An overflow is a result: the maxima until then are kept.
    match problem.run(method, &problem.start, problem.step(steps), last, &mut watch) {
        Ok(_) | Err(SimulationError::NotFinite { .. }) => {}
        Err(error) => return Err(error.into()),
    }
    largest.resize(step.len(), f64::NAN);
    Ok(Horizon { step, largest })
}

/// The largest relative change of the energy along the reference orbit; none without an energy.
pub(super) fn change_of_flow(problem: &Problem) -> Option<f64> {
    problem.dynamics.energy()?;
    let states = problem.orbit().states();
    let mut drift = Drift::new(problem, &states[0]);
    let changes = states.iter().map(|state| drift.of(state).abs());
    Some(changes.fold(0.0, |most, x| if x > most || x.is_nan() { x } else { most }))
}

/// Turns of the search for a bound.
const BOUND_TURNS: u64 = 64;

/// Whether no position in the second half of some turns is more than twice as far from the start as in the first half.
pub(super) fn is_bounded(problem: &Problem) -> bool {
    let (start, degrees) = (&problem.start, problem.degrees());
    let (dt, steps) = (problem.step(RETURN_STEPS), BOUND_TURNS * RETURN_STEPS);
    let places: Vec<usize> =
        problem.states.iter().map(|state| state.place).filter(|&place| place < degrees).collect();
    let mut furthest = [0.0_f64; 2];
    let mut watch = |step: u64, state: &[f64]| {
        let off = places.iter().map(|&i| (state[i] - start[i]).abs()).fold(0.0, f64::max);
        let half = &mut furthest[usize::from(2 * step > steps)];
        *half = half.max(off);
    };
    let is_finite = problem.run(Method::Rk4, start, dt, steps, &mut watch).is_ok();
    is_finite && furthest[1] < 2.0 * furthest[0]
}

/// Turns within which an orbit in one degree of freedom is expected back.
const RETURN_TURNS: u64 = 16;

/// Steps a turn of that search.
const RETURN_STEPS: u64 = 400;

/// Whether the orbit is closed: in one degree of freedom if it comes back to its start, in more if it does so after a turn.
pub(super) fn closes(problem: &Problem) -> bool {
    if problem.degrees() == 1 {
        return comes_back(problem);
    }
    let start = start::<TwoFloat>(problem);
    let turn = TwoFloat::from_f64(problem.turn);
    let (end, _) = flow(&mut Rates::new(&problem.dynamics), &start, turn);
    distance(&end, &start) < 1e-6 * size(&start)
}

/// Whether an orbit in one degree of freedom crosses the line through its start, across the flow and near the start, in the
/// direction of the flow.
fn comes_back(problem: &Problem) -> bool {
    let (start, omega) = (&problem.start, problem.omega());
    let rate = Rates::new(&problem.dynamics).at(start);
    let (mut furthest, mut ahead, mut is_back) = (0.0_f64, true, false);
    let mut watch = |_, state: &[f64]| {
        let (dq, dv) = (state[0] - start[0], (state[1] - start[1]) / omega);
        let was_ahead = std::mem::replace(&mut ahead, dq * rate[0] + dv * rate[1] / omega >= 0.0);
        let off = dq.hypot(dv);
        furthest = furthest.max(off);
        is_back |= ahead && !was_ahead && off < furthest / 4.0;
    };
    let (dt, steps) = (problem.step(RETURN_STEPS), RETURN_TURNS * RETURN_STEPS);
    problem.run(Method::Rk4, start, dt, steps, &mut watch).is_ok() && is_back
}
