//! A system with a start and the time of a turn.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use libration::equations::{Dynamics, StepProgram};
use libration::number::TwoFloat;
use libration::simulation::SimulationError;
use libration::{Float, Method, Model, Scalar, State};
use libration_analyze::reference_flow::Rates;

use super::orbit::Orbit;
use crate::program_stepper::ProgramStepper;

/// A system of any kind under study: all that the laboratory must know of it.
///
/// It holds the program of the system, which has the bits of the compiled one on each number type, so that its instruments are
/// compiled once for all systems.
///
/// ```
/// use libration::{State, system::Duffing};
/// use libration_study_motion::{Convergence, Nonlinear, Problem};
///
/// let wells = Duffing { alpha: -1.0, beta: 1.0 };
/// let own = [Problem::new("wells", wells, State { q: [1.5], v: [0.0] }, 4.4)];
/// let studies = (Convergence::of(&own), Nonlinear::of(&own));
/// # let _ = studies;
/// ```
#[derive(Debug)]
pub struct Problem {
    pub(super) name: String,
    pub(super) title: String,
    pub(super) dynamics: Dynamics,
    /// Positions, then velocities.
    pub(super) start: Vec<f64>,
    pub(super) turn: f64,
    pub(super) equilibrium: Option<Vec<f64>>,
    /// The states under study: all positions and velocities but for those that only carry time or an integral.
    pub(super) states: Vec<StudiedState>,
    orbit: OnceLock<Orbit>,
    steps: Mutex<BTreeMap<Method, Arc<StepProgram>>>,
}

/// A position, a velocity or a state of first order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StudiedState {
    /// The place among all positions and velocities.
    pub place: usize,
    /// The name.
    pub name: String,
    /// The unit; empty without one.
    pub unit: String,
}

impl Problem {
    /// `model` from `start`; a revolution takes about `turn` seconds.
    ///
    /// Characters of `name` other than letters and digits become hyphens.
    pub fn new<const D: usize>(
        name: &str,
        model: impl Model<D>,
        start: State<f64, D>,
        turn: f64,
    ) -> Self {
        let named = |letter: char| {
            move |i: usize| match D {
                1 => letter.to_string(),
                _ => format!("{letter}{}", subscript(i)),
            }
        };
        let names = (0..D).map(named('q')).chain((0..D).map(named('v')));
        let states = names.enumerate().map(|(place, name)| StudiedState {
            place,
            name,
            unit: String::new(),
        });
        let dynamics = Dynamics::of(&model, None);
        Problem::of_program(name, dynamics, start.coordinates().collect(), turn, states.collect())
    }

    /// The system of a program whose inputs are zero, from positions and velocities.
    pub(super) fn of_program(
        name: &str,
        dynamics: Dynamics,
        start: Vec<f64>,
        turn: f64,
        states: Vec<StudiedState>,
    ) -> Self {
        let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '-' };
        Problem {
            // Names of files have it.
            name: name.chars().map(plain).take(LONGEST_NAME).collect(),
            title: name.into(),
            dynamics,
            start,
            turn,
            equilibrium: None,
            states,
            orbit: OnceLock::new(),
            steps: Mutex::default(),
        }
    }

    /// With a name for running text.
    #[must_use]
    pub fn titled(mut self, title: &str) -> Self {
        self.title = title.into();
        self
    }

    /// With a stable equilibrium, about which the step of lost stability is predicted. It has the degrees of freedom of the start;
    /// another one is ignored.
    #[must_use]
    pub fn with_equilibrium<const D: usize>(mut self, equilibrium: State<f64, D>) -> Self {
        let equilibrium: Vec<f64> = equilibrium.coordinates().collect();
        self.equilibrium = Some(equilibrium).filter(|at| at.len() == self.start.len());
        self
    }

    /// Degrees of freedom of the program.
    pub(super) fn degrees(&self) -> usize {
        self.dynamics.degrees()
    }

    /// The angular frequency of a turn, in rad/s.
    pub(super) fn omega(&self) -> f64 {
        std::f64::consts::TAU / self.turn
    }

    /// The reference orbit, computed once.
    pub(super) fn orbit(&self) -> &Orbit {
        self.orbit.get_or_init(|| {
            let start = self.start.iter().map(|&x| TwoFloat::from_f64(x)).collect();
            Orbit::new(&mut Rates::new(&self.dynamics), start, TwoFloat::from_f64(self.turn))
        })
    }

    /// The program of a step, made once.
    pub(super) fn step_program(&self, method: Method) -> Arc<StepProgram> {
        let mut steps = self.steps.lock().unwrap_or_else(PoisonError::into_inner);
        let new = || Arc::new(StepProgram::new(method, &self.dynamics));
        Arc::clone(steps.entry(method).or_insert_with(new))
    }

    /// `turn / steps` on numbers of type `S`.
    pub(super) fn step<S: Scalar>(&self, steps: u64) -> S {
        S::from_f64(self.turn).ratio(1, i32::try_from(steps).unwrap_or(i32::MAX))
    }

    /// Runs `method` and returns the last state; `watch` sees the start and every state after it with the number of its step.
    pub(super) fn run<S: Float>(
        &self,
        method: Method,
        start: &[S],
        dt: S,
        steps: u64,
        watch: &mut dyn FnMut(u64, &[S]),
    ) -> Result<Vec<S>, SimulationError> {
        if !(dt > S::zero() && dt.is_finite()) {
            return Err(SimulationError::TimeStep { dt: dt.to_f64(), float: S::NAME });
        }
        let step = self.step_program(method);
        let mut stepper = ProgramStepper::new(&step, &self.dynamics, start);
        watch(0, stepper.state());
        for step in 1..=steps {
            stepper.step(dt);
            if !stepper.state().iter().all(|x| x.is_finite()) {
                let time = step as f64 * dt.to_f64();
                return Err(SimulationError::NotFinite { step, time });
            }
            watch(step, stepper.state());
        }
        Ok(stepper.state().to_vec())
    }
}

/// The most characters of a name in identifiers and names of files.
const LONGEST_NAME: usize = 60;

/// A number in small digits below the line.
fn subscript(n: usize) -> String {
    let below = |digit: char| {
        let digit = digit.to_digit(10).and_then(|digit| char::from_u32('₀' as u32 + digit));
        digit.unwrap_or('ₙ')
    };
    n.to_string().chars().map(below).collect()
}

#[cfg(test)]
mod tests {
    use libration::simulation::Simulator;
    use libration::system::{Kepler, Pendulum};

    use super::*;

    /// Whether a run has the bits of the compiled system, on numbers of type `S`.
    fn has_bits_of_compiled<S: Float, const D: usize>(
        problem: &Problem,
        model: impl Model<D>,
        start: State<f64, D>,
        method: Method,
    ) -> bool {
        let (start, dt) = (start.map(S::from_f64), problem.step::<S>(64));
        let mut compiled = Simulator::new(model.on::<S>(), method, start, dt).unwrap();
        compiled.run(100, &mut ()).unwrap();
        let start: Vec<S> = start.coordinates().collect();
        let end = problem.run(method, &start, dt, 100, &mut |_, _| {}).unwrap();
        end.into_iter().eq(compiled.sample().state.coordinates())
    }

    #[test]
    fn a_program_has_the_bits_of_the_compiled_system_in_every_float_type() {
        let (pendulum, swing) = (Pendulum { omega2: 9.81 }, State { q: [2.0], v: [0.3] });
        let (kepler, perihelion) = (Kepler { mu: 1.1 }, State { q: [0.4, 0.0], v: [0.1, 2.0] });
        let first = Problem::new("pendulum", pendulum, swing, 2.0);
        let second = Problem::new("kepler", kepler, perihelion, 6.3);
        for method in Method::ALL {
            assert!(has_bits_of_compiled::<f64, 1>(&first, pendulum, swing, method), "{method:?}");
            assert!(has_bits_of_compiled::<f32, 1>(&first, pendulum, swing, method), "{method:?}");
            assert!(has_bits_of_compiled::<TwoFloat, 1>(&first, pendulum, swing, method));
            assert!(has_bits_of_compiled::<f64, 2>(&second, kepler, perihelion, method));
            assert!(has_bits_of_compiled::<TwoFloat, 2>(&second, kepler, perihelion, method));
        }
    }

    #[test]
    fn the_index_of_a_coordinate_is_below_the_line() {
        assert_eq!(subscript(0) + &subscript(27), "₀₂₇");
    }
}
