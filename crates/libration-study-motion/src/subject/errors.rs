//! Errors of a method at halved time steps, without visible rounding.

use libration::number::TwoFloat;
use libration::simulation::SimulationError;
use libration::{Float, Method, Model, State};
use libration_study::{Fit, StudyError};

use super::flow::flow;
use super::{Halvings, Problem};

/// Samples from which orbits start. The configured start itself may be special: where the force or
/// the velocity vanishes, symplectic Euler is of order two in one of the coordinates. Of two points
/// of an orbit that are an eighth of a turn apart, one at least is not.
const STARTS: [usize; 2] = [1, 3];

/// The kind of an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Error of one step from a point of the exact orbit.
    Local,
    /// Error of orbits after many steps, from generic points of the exact orbit.
    Global,
    /// Error of the orbit from the configured start, which may be special.
    FromStart,
}

/// The root of the mean square of an error over the samples of an orbit, step by step.
///
/// Over the whole orbit, because at single points an error may be of higher order by accident.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Errors {
    /// Time steps in s, each half of the one before.
    pub dt: Vec<f64>,
    /// Errors in position.
    pub position: Vec<f64>,
    /// Errors in velocity.
    pub velocity: Vec<f64>,
    /// Errors in phase space, with velocities times `turn/2π`.
    pub together: Vec<f64>,
}

impl Errors {
    fn push(&mut self, dt: f64, [q, v]: [f64; 2], turn: f64) {
        self.dt.push(dt);
        self.position.push(q);
        self.velocity.push(v);
        self.together.push(q.hypot(v * turn / std::f64::consts::TAU));
    }
}

/// The errors of `method` until their order settles, or the steps are as small as they may be.
pub(super) fn measure<M: Model<D>, const D: usize>(
    problem: &Problem<M, D>,
    kind: Kind,
    method: Method,
    halvings: Halvings,
) -> Result<Errors, StudyError> {
    let mut errors = Errors::default();
    for steps in halvings.steps() {
        let found = match kind {
            Kind::Local => local(problem, method, steps),
            Kind::Global => global(problem, method, steps, &STARTS),
            Kind::FromStart => global(problem, method, steps, &[0]),
        };
        let found = match found {
            // A step so large that the orbit overflows has no error that is a number.
            Err(SimulationError::NotFinite { .. }) => [f64::NAN; 2],
            other => other?,
        };
        errors.push(problem.step::<f64>(steps), found, problem.turn);
        if Fit::is_settled(&errors.dt, &errors.together) {
            break;
        }
    }
    Ok(errors)
}

/// Position and velocity of the error at each sample, over all samples after each start.
fn global<M: Model<D>, const D: usize>(
    problem: &Problem<M, D>,
    method: Method,
    steps: u64,
    starts: &[usize],
) -> Result<[f64; 2], SimulationError> {
    let dt = problem.step::<TwoFloat>(steps);
    let stride = steps / Halvings::SAMPLES;
    let exact = problem.orbit().states();
    let mut mean = MeanSquare::default();
    for &start in starts {
        let mut state = exact[start];
        for exact in &exact[start + 1..] {
            state = problem.run(method, state, dt, stride, &mut |_| {})?;
            mean.add(&state, exact);
        }
    }
    Ok(mean.root())
}

/// Returns the error of a single step from each sample.
fn local<M: Model<D>, const D: usize>(
    problem: &Problem<M, D>,
    method: Method,
    steps: u64,
) -> Result<[f64; 2], SimulationError> {
    let dt = problem.step::<TwoFloat>(steps);
    let system = problem.model.on::<TwoFloat>();
    let mut mean = MeanSquare::default();
    for &at in &problem.orbit().states()[1..] {
        let stepped = problem.run(method, at, dt, 1, &mut |_| {})?;
        mean.add(&stepped, &flow(&system, at, dt).0);
    }
    Ok(mean.root())
}

/// The mean square of differences of position and velocity.
#[derive(Default)]
struct MeanSquare {
    sums: [f64; 2],
    count: f64,
}

impl MeanSquare {
    fn add<const D: usize>(&mut self, a: &State<TwoFloat, D>, b: &State<TwoFloat, D>) {
        let square = |a: [TwoFloat; D], b: [TwoFloat; D]| -> f64 {
            a.iter().zip(b).map(|(&a, b)| (a - b).to_f64().powi(2)).sum()
        };
        self.sums[0] += square(a.q, b.q);
        self.sums[1] += square(a.v, b.v);
        self.count += 1.0;
    }

    fn root(&self) -> [f64; 2] {
        self.sums.map(|sum| (sum / self.count).sqrt())
    }
}
