//! The definition of environments by programs.

use libration_core::Method;
use libration_core::control::Jitter;
use libration_core::control::clock::{Jittered, Skewed};
use libration_equations::{Dynamics, TaskPrograms};

use super::answer_times::AnswerTimes;
use super::episodes::{NoStart, NoSystem, NoTask};
use crate::ensemble::All;
use crate::rl::history::History;
use crate::rl::{Autoreset, Delays, Environment, EpisodeNumber, ErrorScale};

/// Environments of a system and a task by their programs. The actions are the inputs of the system.
///
/// ```
/// use libration::Method;
/// use libration::ensemble::Execution;
/// use libration::equations::{Definitions, Equations, TaskDefinitions, TaskPrograms};
/// use libration::rl::{Plan, ProgramEnvironment, ProgramEnvironments, ProgramPolicy, ProgramRollout};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let system = Definitions {
///     coordinates: vec!["x".into()],
///     accelerations: vec![("x".into(), "-10*sin(x) + u".into())],
///     inputs: vec!["u".into()],
///     ..Definitions::default()
/// };
/// let equations = Equations::new(&system)?;
/// let task = TaskDefinitions {
///     observe: vec!["x".into(), "x'".into()],
///     reward: "-x^2 - 0.01*u^2".into(),
///     terminated: vec!["abs(x) > 3".into()],
///     ..TaskDefinitions::default()
/// };
/// let task = TaskPrograms::new(&task, &system, &equations)?;
/// let environment = ProgramEnvironment {
///     start: vec![[-1.0, 1.0], [0.0, 0.0]],
///     limit: Some(200),
///     ..ProgramEnvironment::new(equations.dynamics().clone(), task, Method::Rk4, 0.01)
/// };
/// let mut all = ProgramEnvironments::<f32>::shard(environment, 0, 1000, 7, Execution::serial())?;
/// let mut rollout = ProgramRollout::new(Plan::new(256, 1000).truncated(), [2, 1])?;
/// all.rollout(ProgramPolicy::Linear { weights: &[-5.0, -1.0], bias: &[0.0] }, &mut rollout)?;
/// // Every episode was cut off once.
/// assert_eq!(rollout.ends().ends.len(), 1000);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ProgramEnvironment {
    /// The system, with at least one input and at most [`MAX_DEGREES`](ProgramEnvironment::MAX_DEGREES) degrees of freedom.
    pub dynamics: Dynamics,
    /// Observation, reward and termination.
    pub task: TaskPrograms,
    /// The integrator.
    pub method: Method,
    /// Its step, in seconds.
    pub dt: f64,
    /// Steps of the integrator for which an action is held; at least 1.
    pub substeps: u32,
    /// The lengths of these steps in seconds where they differ, so that latencies need not be whole parts; empty for steps of `dt`.
    pub lengths: Vec<f64>,
    /// The range of each position, then of each velocity, from which the start of an episode is drawn uniformly.
    pub start: Vec<[f64; 2]>,
    /// The time limit: the number of actions after which an episode is truncated.
    pub limit: Option<u32>,
    /// The reset after the end of an episode.
    pub autoreset: Autoreset,
    /// The latencies of observations and actions.
    pub delays: Delays,
    /// The times from observation to action that are drawn for every action; none for the latency of the episode alone.
    pub answers: Option<AnswerTimes>,
    /// The largest command of each input, of either sign; the reward uses the saturated command. Infinite for no limit.
    pub saturation: Vec<EpisodeNumber>,
    /// Steps of the integrator for which a command of an inner controller is held, at least 1. Each action begins with a new command.
    pub inner_steps: u32,
    /// The values of commands, ascending: an action becomes the nearest, of two as near the larger. Empty for any value.
    pub levels: Vec<f64>,
    /// The parameters of the system that vary: its last inputs, which are no actions.
    pub parameters: Vec<EpisodeNumber>,
    /// The law of `δ` in `Δt·(1 + δ)`, drawn per episode.
    pub skew: Jitter,
    /// The law of `ε` in `Δt·(1 + ε)`, drawn per step of the integrator.
    pub jitter: Jitter,
    /// The law of the noise of each observed number; empty without noise.
    pub noise: Vec<Jitter>,
    /// The error scales of the clock and of the sensor, drawn for every episode.
    pub error_scale: ErrorScale,
}

/// The number of actions of a task on a system without parameters that vary.
fn actions(dynamics: &Dynamics, task: &TaskPrograms) -> usize {
    task.inner.as_ref().map_or(dynamics.inputs(), |_| task.targets)
}

/// The clock of the environments.
pub(super) type Clock = (Skewed, Jittered<Jitter>);

/// What environments have besides system, task and start.
pub(super) type World = Environment<NoSystem, All<NoSystem>, Method, NoTask, NoStart, Clock>;

impl ProgramEnvironment {
    /// The most degrees of freedom: an episode has an address for the start of each position and velocity.
    pub const MAX_DEGREES: usize = 32;

    /// An ideal environment without a time limit that starts at zero and whose actions are held for one step of `dt` seconds.
    pub fn new(dynamics: Dynamics, task: TaskPrograms, method: Method, dt: f64) -> Self {
        let none = Jitter::Gaussian(0.0);
        ProgramEnvironment {
            start: vec![[0.0; 2]; 2 * dynamics.degrees()],
            saturation: vec![f64::INFINITY.into(); actions(&dynamics, &task)],
            inner_steps: 1,
            levels: Vec::new(),
            parameters: Vec::new(),
            dynamics,
            task,
            method,
            dt,
            substeps: 1,
            lengths: Vec::new(),
            limit: None,
            autoreset: Autoreset::SameStep,
            delays: Delays::default(),
            answers: None,
            skew: none,
            jitter: none,
            noise: Vec::new(),
            error_scale: ErrorScale::default(),
        }
    }

    /// The number of observed numbers.
    pub fn observations(&self) -> usize {
        self.task.observation.outputs().len()
    }

    /// The number of positions and velocities.
    pub(super) fn coordinates(&self) -> usize {
        2 * self.dynamics.degrees()
    }

    /// The number of actions: inputs that are not parameters, or targets of the inner controller.
    pub fn actions(&self) -> usize {
        actions(&self.dynamics, &self.task).saturating_sub(match self.task.inner {
            Some(_) => 0,
            None => self.parameters.len(),
        })
    }

    /// What each episode has numbers for: parameters, then the largest commands unless all of them are constants.
    pub(super) fn numbers(&self) -> impl Iterator<Item = &EpisodeNumber> {
        let varies = self.saturation.iter().any(|most| most.as_constant().is_none());
        let saturation = if varies { &self.saturation[..] } else { &[] };
        self.parameters.iter().chain(saturation)
    }

    /// Whether the lengths of steps are drawn.
    pub(super) fn is_jittered(&self) -> bool {
        self.skew.rms() != 0.0 || self.jitter.rms() != 0.0
    }

    /// Whether each step is `Δt` long.
    pub(super) fn is_even(&self) -> bool {
        !self.is_jittered() && self.lengths.is_empty() && self.waits() == 0
    }

    /// The steps of the integrator in which the system waits for its action.
    pub(super) fn waits(&self) -> u32 {
        self.answers.map_or(0, |answers| answers.waits)
    }

    /// The inputs of observation and verdict that are the time.
    pub(super) fn time_inputs(&self) -> [usize; 2] {
        let seen = self.coordinates() + self.parameters.len();
        [seen, seen + self.coordinates() + self.actions()]
    }

    /// The layout of the past of a block.
    pub(super) fn history(&self) -> History {
        let ProgramEnvironment { mut delays, substeps, .. } = *self;
        let late = self.answers.filter(|answers| answers.waits == 0);
        delays.action[1] =
            delays.action[1].saturating_add(late.map_or(0, |late| late.most_steps(self.dt)));
        let own = usize::from(late.is_some() && delays.action[1] > 0);
        History::new(delays, substeps, [self.coordinates(), self.actions() + own])
    }

    /// The time from action to action, in seconds.
    pub(super) fn period(&self) -> f64 {
        self.time_of(self.substeps)
    }

    /// The time from an action to the beginning of a substep, in seconds.
    pub(super) fn time_of(&self, substep: u32) -> f64 {
        match self.lengths.as_slice() {
            [] => self.dt * f64::from(substep),
            lengths => lengths[..substep as usize].iter().sum(),
        }
    }

    /// Whether observations have noise.
    pub(super) fn is_noisy(&self) -> bool {
        self.noise.iter().any(|law| law.rms() != 0.0)
    }

    pub(super) fn world(&self) -> World {
        let mut world = Environment::new(All(NoSystem), self.method, self.dt, NoTask, NoStart)
            .substeps(self.substeps)
            .autoreset(self.autoreset)
            .delays(self.delays)
            .error_scale(self.error_scale)
            .clock((Skewed(self.skew), Jittered(self.jitter)));
        world.limit = self.limit;
        world
    }
}
