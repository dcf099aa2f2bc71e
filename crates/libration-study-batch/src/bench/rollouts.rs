//! Rates of rollouts, relative to fills.

use std::hint::black_box;

use libration::State;
use libration::ensemble::{
    All, Buffer, EnsembleError, Execution, InsufficientMemory, Pages, stream_repeatedly,
};
use libration::integrator::SymplecticEuler;
use libration::rl::policy::{Linear, Random};
use libration::rl::start::{FixedStart, UniformStart};
use libration::rl::task::{Regulate, SwingUp};
use libration::rl::{
    Environment, EnvironmentError, Environments, Layout, Plan, Policy, Rollout, TransitionWork,
    World, Writes,
};
use libration::system::{Oscillator, Pendulum};
use libration_study::{Lab, Machine, StudyError};

use super::{Contestant, Rates, Turns, race};

/// The task of the environments of a rollout.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RolloutTask {
    /// The source's case: an oscillator under linear feedback, 17 bytes a transition.
    Regulate,
    /// A pendulum under random torques, with its own sine, random starts and a time limit.
    SwingUp,
}

impl RolloutTask {
    /// Its name in tables and JSON.
    pub fn name(self) -> &'static str {
        match self {
            RolloutTask::Regulate => "regulate",
            RolloutTask::SwingUp => "swing-up",
        }
    }
}

/// A rollout to be timed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RolloutCase {
    /// The task.
    pub task: RolloutTask,
    /// Number of environments.
    pub environments: usize,
    /// Actions of each.
    pub horizon: usize,
}

/// Transitions that fit the last caches of most machines: 1024 × 512 transitions of the source's case, and some more.
const CACHED: usize = 12 << 20;

impl RolloutCase {
    /// Those of the source's table 9.11, one that no cache holds, two that the nearest do, and a swing-up.
    pub const ALL: [RolloutCase; 8] = {
        const fn of(task: RolloutTask, environments: usize, horizon: usize) -> RolloutCase {
            RolloutCase { task, environments, horizon }
        }
        [
            of(RolloutTask::Regulate, 256, 16),
            of(RolloutTask::Regulate, 512, 64),
            of(RolloutTask::Regulate, 256, 512),
            of(RolloutTask::Regulate, 1024, 512),
            of(RolloutTask::Regulate, 2048, 1024),
            of(RolloutTask::Regulate, 4096, 1024),
            of(RolloutTask::Regulate, 16384, 2048),
            of(RolloutTask::SwingUp, 4096, 64),
        ]
    };

    /// Whether it can be timed here.
    ///
    /// # Errors
    /// If there is not the memory: that of the rollout in both ways to write it, and as much for each of two fills.
    pub fn check(&self) -> Result<(), EnsembleError> {
        Ok(InsufficientMemory::check(4 * self.all_bytes())?)
    }

    /// Returns the number of transitions.
    pub fn transitions(&self) -> usize {
        self.environments.saturating_mul(self.horizon)
    }

    /// Returns the size in bytes.
    pub(crate) fn plan(&self) -> Plan {
        let plan = Plan::new(self.horizon, self.environments);
        if self.task == RolloutTask::SwingUp { plan.truncated() } else { plan }
    }

    /// Bytes of the rollout.
    pub fn bytes(&self) -> usize {
        usize::try_from(self.all_bytes()).unwrap_or(usize::MAX)
    }

    /// The fill that its speed is measured by: a plain one as long as a last cache of a few MiB holds it, one past the caches beyond.
    pub fn against(&self) -> Writes {
        if self.bytes() <= CACHED { Writes::Plain } else { Writes::Past }
    }

    fn all_bytes(&self) -> u128 {
        let observation = if self.task == RolloutTask::SwingUp { 3 } else { 2 };
        self.plan().bytes(observation, 1, size_of::<f32>())
    }
}

/// Returns the faster kind of stores for a rollout of a size.
pub(crate) fn suited(bytes: usize) -> Writes {
    let caches = Machine::detect().caches;
    let near = caches.iter().rev().find(|cache| cache.level <= 2);
    Writes::suited(bytes as u128, near.map_or(1 << 20, |cache| cache.bytes))
}

/// Rate of a rollout, with the faster kind of stores.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RolloutRate {
    /// The measured case.
    pub case: RolloutCase,
    /// Layout of the tensors.
    pub layout: Layout,
    /// Kind of stores.
    pub writes: Writes,
    /// On how many threads: a small one takes no more than it is worth.
    pub threads: usize,
    /// Transitions a second: the median of the rounds.
    pub median: f64,
    /// Distance of the quartiles of the rounds.
    pub spread: f64,
    /// The share of a fill of as many bytes, by as many threads, written as [`against`](RolloutCase::against) says: the median of the
    /// rounds.
    pub share: f64,
    /// Distance of the quartiles of the shares.
    pub share_spread: f64,
}

/// Times rollouts, each on one core and on all, in turn with fills of as much memory.
///
/// # Errors
/// If the run is to stop, or there is no memory.
pub fn rollouts(lab: &Lab<'_>, cases: &[RolloutCase]) -> Result<Vec<RolloutRate>, StudyError> {
    let serial = lab.alone()?;
    let parallel = serial.clone().threads(0)?;
    let (rounds, seconds) = lab.effort.choose((5, 5e-3), (15, 20e-3), (31, 40e-3));
    let turns = Turns { rounds, seconds };
    let mut rates = Vec::new();
    for &case in cases {
        for execution in [&serial, &parallel].into_iter().take(parallel.thread_count().min(2)) {
            rates.extend(timed(lab, turns, case, execution)?);
        }
    }
    Ok(rates)
}

/// Rates of a case in both layouts.
fn timed(
    lab: &Lab<'_>,
    turns: Turns,
    case: RolloutCase,
    execution: &Execution,
) -> Result<Vec<RolloutRate>, StudyError> {
    const WAYS: [Writes; 2] = [Writes::Plain, Writes::Past];
    let mut rates = Vec::new();
    for layout in [Layout::Interleaved, Layout::Planes] {
        let mut contestants = Vec::new();
        for writes in WAYS {
            let plan = case.plan().layout(layout).writes(writes);
            contestants.push(rollout(case, plan, execution)?);
            contestants.push(fill(case, writes, execution)?);
        }
        let measured = race(lab, turns, &mut contestants)?;
        let [plain, plain_fill, past, past_fill] = &measured[..] else { continue };
        let fill = if case.against() == Writes::Past { past_fill } else { plain_fill };
        let (writes, rate) = if past.median() > plain.median() {
            (Writes::Past, past)
        } else {
            (Writes::Plain, plain)
        };
        let share: Rates = rate.over(fill);
        rates.push(RolloutRate {
            case,
            layout,
            writes,
            threads: case.plan().threads(execution, TransitionWork::SHORTEST),
            median: rate.median(),
            spread: rate.spread(),
            share: share.median(),
            share_spread: share.spread(),
        });
    }
    Ok(rates)
}

/// The source's oscillator as an environment.
pub(crate) fn regulating() -> impl World<f32, 2, 1> + 'static {
    regulating_from(1.0)
}

/// The same from another place.
pub(crate) fn regulating_from(q: f64) -> impl World<f32, 2, 1> + 'static {
    let task = Regulate { position: 1.0, velocity: 0.1, effort: 0.0, bound: 10.0 };
    let (system, start) =
        (All(Oscillator { omega2: OMEGA2 }), FixedStart(State { q: [q], v: [0.0] }));
    Environment::new(system, SymplecticEuler, 0.01, task, start)
}

/// What is done there: it does not damp, since what decays comes to numbers so small that processors take a slow path.
pub(crate) const FEEDBACK: Linear<2, 1> = Linear { weights: [[-2.0, 0.0]], bias: [0.0] };

const OMEGA2: f32 = 10.0;

/// A rollout, again and again into the same memory.
pub(crate) fn rollout(
    case: RolloutCase,
    plan: Plan,
    execution: &Execution,
) -> Result<Contestant<'static>, EnvironmentError> {
    match case.task {
        RolloutTask::Regulate => contestant(regulating(), FEEDBACK, case, plan, execution),
        RolloutTask::SwingUp => {
            let task = SwingUp { velocity: 0.1, effort: 0.001 };
            let corner = |sign: f64| State { q: [sign * 3.0], v: [sign] };
            let start = UniformStart(corner(-1.0), corner(1.0));
            let policy = Random::between([-2.0], [2.0]);
            let system = All(Pendulum { omega2: OMEGA2 });
            let world = Environment::new(system, SymplecticEuler, 0.05, task, start).limit(200);
            contestant::<_, _, 3>(world, policy, case, plan, execution)
        }
    }
}

fn contestant<E, P, const O: usize>(
    world: E,
    policy: P,
    case: RolloutCase,
    plan: Plan,
    execution: &Execution,
) -> Result<Contestant<'static>, EnvironmentError>
where
    E: World<f32, O, 1> + 'static,
    P: Policy<f32, O, 1> + 'static,
{
    let mut all = Environments::new(world, case.environments, 7, execution.clone())?;
    let mut rollout = Rollout::new(plan)?;
    // Pages come to be where they are first written.
    all.rollout(policy, &mut rollout)?;
    Ok(Contestant::new(case.transitions() as f64, move |times| {
        for _ in 0..times {
            // It went well before, and nothing has changed.
            let _ = black_box(all.rollout(policy, &mut rollout));
        }
    }))
}

/// As many bytes as the rollout has, and nothing but written.
pub(crate) fn fill(
    case: RolloutCase,
    writes: Writes,
    execution: &Execution,
) -> Result<Contestant<'static>, EnsembleError> {
    /// Bytes that the first cache holds beside what is written.
    const PATTERN: usize = 4096;
    let mut memory = Buffer::<u8>::new(case.bytes(), Pages::Huge)?;
    memory.fill(1);
    let pattern = vec![2_u8; PATTERN];
    let execution = execution.clone();
    let threads = case.plan().threads(&execution, TransitionWork::SHORTEST);
    let part = case.bytes().div_ceil(threads).next_multiple_of(PATTERN);
    Ok(Contestant::new(case.transitions() as f64, move |times| {
        for _ in 0..times {
            execution.each(memory.chunks_mut(part).collect(), |part: &mut [u8]| match writes {
                Writes::Past => stream_repeatedly(&pattern, part),
                // In pieces: with all at once the library might go past the caches as well.
                Writes::Plain => part.chunks_mut(PATTERN).for_each(|piece| piece.fill(2)),
            });
            black_box(&*memory);
        }
    }))
}
