//! Errors of a method at halved time steps, without visible rounding.

use libration::number::TwoFloat;
use libration::simulation::SimulationError;
use libration::{Float, Method};
use libration_study::{Fit, StudyError};

use super::{Halvings, Problem, StudiedState};
use libration_analyze::reference_flow::{Rates, flow};

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
    /// Errors of each state.
    pub states: Vec<Vec<f64>>,
}

impl Errors {
    fn new(states: usize) -> Self {
        Errors { states: vec![Vec::new(); states], ..Errors::default() }
    }

    /// Adds the mean squares of the errors of all states.
    fn push(&mut self, problem: &Problem, dt: f64, squares: &[f64]) {
        let root = |is_own: &dyn Fn(&StudiedState) -> bool| -> f64 {
            let own = problem.states.iter().zip(squares).filter(|(state, _)| is_own(state));
            own.map(|(_, square)| square).sum::<f64>().sqrt()
        };
        let q = root(&|state| state.place < problem.degrees());
        let v = root(&|state| state.place >= problem.degrees());
        self.dt.push(dt);
        self.position.push(q);
        self.velocity.push(v);
        self.together.push(q.hypot(v / problem.omega()));
        self.states.iter_mut().zip(squares).for_each(|(errors, x)| errors.push(x.sqrt()));
    }
}

/// The errors of `method` until their order settles, or the steps are as small as they may be.
pub(super) fn measure(
    problem: &Problem,
    kind: Kind,
    method: Method,
    halvings: Halvings,
) -> Result<Errors, StudyError> {
    let mut errors = Errors::new(problem.states.len());
    for steps in halvings.steps() {
        let found = match kind {
            Kind::Local => local(problem, method, steps),
            Kind::Global => global(problem, method, steps, &STARTS),
            Kind::FromStart => global(problem, method, steps, &[0]),
        };
        let found = match found {
            // A step so large that the orbit overflows has no error that is a number.
            Err(SimulationError::NotFinite { .. }) => vec![f64::NAN; problem.states.len()],
            other => other?,
        };
        errors.push(problem, problem.step::<f64>(steps), &found);
        if Fit::is_settled(&errors.dt, &errors.together) {
            break;
        }
    }
    Ok(errors)
}

/// The mean squares of the errors at each sample, over all samples after each start.
fn global(
    problem: &Problem,
    method: Method,
    steps: u64,
    starts: &[usize],
) -> Result<Vec<f64>, SimulationError> {
    let dt = problem.step::<TwoFloat>(steps);
    let stride = steps / Halvings::SAMPLES;
    let exact = problem.orbit().states();
    let mut mean = MeanSquares::new(&problem.states);
    for &start in starts {
        let mut state = exact[start].clone();
        for exact in &exact[start + 1..] {
            state = problem.run(method, &state, dt, stride, &mut |_, _| {})?;
            mean.add(&state, exact);
        }
    }
    Ok(mean.all())
}

/// The mean squares of the errors of a single step from each sample.
fn local(problem: &Problem, method: Method, steps: u64) -> Result<Vec<f64>, SimulationError> {
    let dt = problem.step::<TwoFloat>(steps);
    let mut rates = Rates::new(&problem.dynamics);
    let mut mean = MeanSquares::new(&problem.states);
    for at in &problem.orbit().states()[1..] {
        let stepped = problem.run(method, at, dt, 1, &mut |_, _| {})?;
        mean.add(&stepped, &flow(&mut rates, at, dt).0);
    }
    Ok(mean.all())
}

/// The mean squares of the differences of states.
struct MeanSquares<'p> {
    states: &'p [StudiedState],
    sums: Vec<f64>,
    count: f64,
}

impl<'p> MeanSquares<'p> {
    fn new(states: &'p [StudiedState]) -> Self {
        MeanSquares { states, sums: vec![0.0; states.len()], count: 0.0 }
    }

    fn add(&mut self, a: &[TwoFloat], b: &[TwoFloat]) {
        for (sum, state) in self.sums.iter_mut().zip(self.states) {
            *sum += (a[state.place] - b[state.place]).to_f64().powi(2);
        }
        self.count += 1.0;
    }

    fn all(self) -> Vec<f64> {
        self.sums.iter().map(|sum| sum / self.count).collect()
    }
}
