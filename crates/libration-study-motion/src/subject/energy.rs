//! The energy error of a method over a turn and over a long horizon.

use libration::number::TwoFloat;
use libration::simulation::{EnergyDrift, Sample, SimulationError};
use libration::{Float, Hamiltonian, Method, Model, Scalar, State};
use libration_study::{Fit, StudyError, log_spaced_steps};

use super::{Halvings, Problem};

/// Turns over which the mean change of the energy is taken. A method of first order needs few,
/// since its change is of the order of its swing, and small steps, since both are large.
fn turns(method: Method) -> u64 {
    if method.order() == 1 { 2 } else { 16 }
}

/// How much further a method of first order may halve its steps. It runs in `f64`, whose rounding
/// is far below its errors.
const FIRST_ORDER: u64 = 64;

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
pub(super) fn changes<M: Model<D>, const D: usize>(
    problem: &Problem<M, D>,
    change: Change,
    method: Method,
    halvings: Halvings,
) -> Result<Changes, StudyError> {
    let mut changes = Changes::default();
    let first = method.order() == 1;
    let finest = if first { FIRST_ORDER * halvings.finest } else { halvings.finest };
    for steps in (Halvings { finest, ..halvings }).steps() {
        let size = match (change, first) {
            (Change::Swing, true) => swing::<f64, _, _>(problem, method, steps),
            (Change::Swing, false) => swing::<TwoFloat, _, _>(problem, method, steps),
            (Change::Rate, true) => rate::<f64, _, _>(problem, method, steps),
            (Change::Rate, false) => rate::<TwoFloat, _, _>(problem, method, steps),
        };
        changes.dt.push(problem.step(steps));
        changes.size.push(match size {
            Err(SimulationError::NotFinite { .. }) => f64::NAN,
            other => other?,
        });
        if Fit::is_settled(&changes.dt, &changes.size) {
            break;
        }
    }
    Ok(changes)
}

/// `(E − E₀)/|E₀|` with all digits of `S`; absolute where `E₀` is zero.
fn drift<S: Float, const D: usize>(
    system: impl Hamiltonian<S, D>,
    start: &State<S, D>,
) -> impl Fn(&State<S, D>) -> f64 {
    let initial = system.energy(start);
    let scale = match initial.to_f64().abs() {
        0.0 => 1.0,
        size => size,
    };
    move |state| (system.energy(state) - initial).to_f64() / scale
}

fn swing<S: Float, M: Model<D>, const D: usize>(
    problem: &Problem<M, D>,
    method: Method,
    steps: u64,
) -> Result<f64, SimulationError> {
    let start = problem.start.map(S::from_f64);
    let drift = drift(problem.model.on::<S>(), &start);
    let mut largest = 0.0_f64;
    let mut watch = |s: &Sample<S, D>| largest = largest.max(drift(&s.state).abs());
    problem.run(method, start, problem.step(steps), steps, &mut watch)?;
    Ok(largest)
}

/// The difference of two smooth means, half the horizon apart: what swings within a turn averages
/// out of each, however the turn ends.
fn rate<S: Float, M: Model<D>, const D: usize>(
    problem: &Problem<M, D>,
    method: Method,
    steps: u64,
) -> Result<f64, SimulationError> {
    let start = problem.start.map(S::from_f64);
    let drift = drift(problem.model.on::<S>(), &start);
    let turns = turns(method);
    let all = steps * turns;
    let mut sums = [[0.0_f64; 2]; 2];
    let mut watch = |s: &Sample<S, D>| {
        let place = 2.0 * s.step as f64 / all as f64;
        let half = usize::from(place >= 1.0);
        // sin⁴ and its first three derivatives vanish at both ends of a half.
        let weight = (std::f64::consts::PI * place).sin().powi(4);
        sums[half][0] += weight * drift(&s.state);
        sums[half][1] += weight;
    };
    problem.run(method, start, problem.step(steps), all, &mut watch)?;
    let [early, late] = sums.map(|[sum, weight]| sum / weight);
    Ok((late - early).abs() / (turns as f64 / 2.0))
}

/// The running maximum over `turns` turns in `f64`.
pub(super) fn horizon<M: Model<D>, const D: usize>(
    problem: &Problem<M, D>,
    method: Method,
    steps: u64,
    turns: u64,
) -> Result<Horizon, StudyError> {
    let last = steps * turns;
    let step = log_spaced_steps(last, PER_DECADE);
    let mut drift = EnergyDrift::new(problem.model.on::<f64>(), &problem.start);
    let mut largest = Vec::with_capacity(step.len());
    let mut watch = |s: &Sample<f64, D>| {
        libration::simulation::Observer::observe(&mut drift, s);
        if step.get(largest.len()) == Some(&s.step) {
            largest.push(drift.largest());
        }
    };
    // An overflow is a result: the maxima until then are kept.
    match problem.run(method, problem.start, problem.step(steps), last, &mut watch) {
        Ok(_) | Err(SimulationError::NotFinite { .. }) => {}
        Err(error) => return Err(error.into()),
    }
    largest.resize(step.len(), f64::NAN);
    Ok(Horizon { step, largest })
}

/// Whether the orbit returns to its start after a turn, or must return because it has one degree
/// of freedom.
pub(super) fn closes<M: Model<D>, const D: usize>(problem: &Problem<M, D>) -> bool {
    let system = problem.model.on::<TwoFloat>();
    let start = problem.start.map(TwoFloat::from_f64);
    let turn = TwoFloat::from_f64(problem.turn);
    let (end, _) = super::flow::flow(&system, start, turn);
    D == 1 || super::flow::distance(&end, &start) < 1e-6 * super::flow::size(&start)
}
