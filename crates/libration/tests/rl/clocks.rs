//! Clocks of environments.

use libration::State;
use libration::control::Jitter;
use libration::control::clock::{Drifting, Recorded, Skewed};
use libration::ensemble::{All, Execution};
use libration::integrator::SymplecticEuler;
use libration::rl::start::UniformStart;
use libration::rl::task::Regulate;
use libration::rl::{ActionSample, Environment, Environments, Plan, Policy, Rollout, StepIndex};
use libration::system::{BaselineOnly, Oscillator};

use crate::TASK;

/// Three clocks in one, so that environments are compiled once for all of them.
type Clocks<'a> = (Recorded<'a>, (Drifting, Skewed));

/// One whose steps are all of length 1: a clock of a test takes the place of a part of it.
pub(crate) fn even<'a>() -> Clocks<'a> {
    let none = Jitter::Gaussian(0.0);
    (Recorded::repeated(&[1.0]), (Drifting(none), Skewed(none)))
}

/// Does nothing, and takes a word for it without saying so.
#[derive(Clone, Copy)]
pub(crate) struct Idle {
    /// The words that it says it takes.
    pub(crate) words: usize,
}

impl Policy<f32, 2, 1> for Idle {
    fn words(&self) -> usize {
        self.words
    }

    fn act(
        &self,
        _: StepIndex,
        _: &[f32; 2],
        word: &mut impl FnMut() -> u32,
    ) -> ActionSample<f32, 1> {
        ActionSample::deterministic([0.0 * word() as f32])
    }
}

/// How far something of velocity 1 goes in each step: as far as the step is long.
fn steps(clock: Clocks<'_>, limit: u32, horizon: usize, count: usize) -> Vec<Vec<f32>> {
    let free = Oscillator { omega2: 0.0_f32 };
    let task = Regulate { bound: f64::INFINITY, ..TASK };
    let at = State { q: [0.0], v: [1.0] };
    let start = UniformStart(at, at);
    let world = Environment::new(All(BaselineOnly(free)), SymplecticEuler, 1.0, task, start)
        .limit(limit)
        .clock(clock);
    let mut all = Environments::new(world, count, 3, Execution::serial()).unwrap();
    let mut rollout = Rollout::<f32, 2, 1>::new(Plan::new(horizon, count).truncated()).unwrap();
    all.rollout(Idle { words: 0 }, &mut rollout).unwrap();
    let ends = |t, n| rollout.finals().iter().find(|end| (end.step, end.environment) == (t, n));
    let length = |t, n| {
        let after = ends(t, n).map_or_else(|| rollout.seen(t + 1, n), |end| end.observation);
        after[0] - rollout.seen(t, n)[0]
    };
    (0..count).map(|n| (0..horizon - 1).map(|t| length(t, n)).collect()).collect()
}

#[test]
fn steps_that_are_a_small_part_of_the_time_step_are_as_long_as_they_were_recorded() {
    for ratio in [1e-3_f64, 1e-5, 1e-8] {
        let steps = steps((Recorded::repeated(&[ratio]), even().1), 10, 10, 1);
        let first = steps[0][0];
        assert_eq!(first, ratio as f32);
    }
}

#[test]
fn a_drifting_clock_begins_to_drift_with_every_episode() {
    let (one, (_, even)) = even();
    let found = steps((one, (Drifting(Jitter::Gaussian(1e-3)), even)), 50, 2000, 5);
    for steps in &found {
        for episode in steps.chunks(50) {
            // Positions up to 50 have a spacing of 4·10⁻⁶, the difference of two twice as much.
            assert!((episode[0] - 1.0).abs() < 1e-5, "{}", episode[0]);
            let slope = episode.get(48).map_or(0.0, |last| (last - 1.0) / 48.0);
            let middle = episode.get(24).map_or(0.0, |middle| (middle - 1.0) / 24.0);
            assert!((slope - middle).abs() < 1e-6, "{slope} {middle}");
        }
    }
    assert_ne!(found[0][40], found[0][90]);
}

#[test]
fn the_rate_of_a_clock_follows_from_the_number_of_the_episode_and_not_from_when_it_begins() {
    let rates = |limit| -> Vec<f32> {
        let (one, (even, _)) = even();
        let found = steps((one, (even, Skewed(Jitter::Gaussian(0.1)))), limit, 61, 1);
        found[0].iter().step_by(limit as usize).copied().take(6).collect()
    };
    let (short, long) = (rates(3), rates(10));
    assert_eq!(short, long);
    assert!(short.windows(2).all(|pair| pair[0] != pair[1]), "{short:?}");
}
