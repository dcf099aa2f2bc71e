//! Checkpoints of environments and replay buffers.

use libration::State;
use libration::checkpoint::{Checkpoint, CheckpointError};
use libration::control::Jitter;
use libration::control::clock::{Correlated, Drifting, Gaussian, Jittered, Skewed, Uniform};
use libration::ensemble::{All, Execution};
use libration::integrator::VelocityVerlet;
use libration::replay::{Batch, Capacity, Draw, Lookahead, ReplayBuffer};
use libration::rl::policy::{GaussianExploration, Linear};
use libration::rl::sensor::Noisy;
use libration::rl::start::UniformStart;
use libration::rl::task::Regulate;
use libration::rl::variation::RandomParameters;
use libration::rl::{
    Autoreset, Delays, Distribution, Environment, Environments, ErrorScale, Plan, Rollout, World,
};
use libration::system::{BaselineOnly, Oscillator};

use super::{executions, refused};

const COUNT: usize = 150;

/// One for all tests: environments are compiled for each policy.
const POLICY: GaussianExploration<Linear<2, 1>, 1> =
    GaussianExploration { policy: Linear { weights: [[-3.0, 0.5]], bias: [0.25] }, sigma: [2.0] };

/// With all that an environment can remember.
fn world(autoreset: Autoreset) -> impl World<f32, 2, 1> {
    let task = Regulate { position: 1.0, velocity: 0.1, effort: 0.01, bound: 1.5 };
    let start = UniformStart(State { q: [-1.0], v: [-2.0] }, State { q: [1.0], v: [2.0] });
    let jittered = (Jittered(Gaussian(0.1)), Correlated { rms: 0.1, correlation: 0.9 });
    let uneven = (Skewed(Jitter::Uniform(0.01)), Drifting(Jitter::Gaussian(1e-4)));
    let system = All(BaselineOnly(Oscillator { omega2: 10.0_f32 }));
    Environment::new(system, VelocityVerlet, 0.02, task, start)
        .substeps(3)
        .limit(60)
        .autoreset(autoreset)
        .delays(Delays { observation: [0, 4], action: [2, 7] })
        .clock((uneven, jittered))
        .sensor(Noisy([Uniform(0.05), Uniform(0.1)]))
        .error_scale(ErrorScale { clock: [0.0, 2.0], sensor: [0.5, 1.5] })
        .variation(RandomParameters {
            numbers: [Distribution::Uniform(8.0, 12.0)],
            apply: |[omega2]: [f32; 1], _: BaselineOnly<Oscillator<f32>>, task: Regulate| {
                (BaselineOnly(Oscillator { omega2 }), task)
            },
        })
}

type Told = (Vec<f32>, Vec<f32>, Vec<f32>, Vec<u8>, Vec<(usize, usize, f64, u64)>);

/// What they do in so many steps.
fn told<E: World<f32, 2, 1>>(all: &mut Environments<f32, E, 2, 1>, steps: usize) -> Told {
    let mut rollout =
        Rollout::new(Plan::new(steps, all.len()).truncated().log_probabilities()).unwrap();
    all.rollout(POLICY, &mut rollout).unwrap();
    let ends = rollout.finals().iter();
    let ends = ends.map(|end| (end.step, end.environment, end.episode_return, end.length));
    let flags = [rollout.terminated(), rollout.truncated()].concat();
    let probabilities = rollout.log_probability().to_vec();
    (
        rollout.observation().to_vec(),
        probabilities,
        rollout.reward().to_vec(),
        flags,
        ends.collect(),
    )
}

#[test]
fn environments_go_on_bit_for_bit_wherever_they_are_taken_up() {
    for autoreset in [Autoreset::SameStep, Autoreset::NextStep, Autoreset::Disabled] {
        let make = |execution| Environments::new(world(autoreset), COUNT, 9, execution).unwrap();
        let mut whole = make(Execution::serial());
        // Across the end of an epoch of random words, and from within one.
        told(&mut whole, 143);
        let state = whole.to_bytes();
        let expected = told(&mut whole, 200);
        assert!(autoreset == Autoreset::Disabled || expected.4.len() > COUNT);
        for execution in executions() {
            // At another step, and at the same step in other episodes.
            for after in [31, 100] {
                let mut other = make(execution.clone());
                told(&mut other, 43);
                other.reset(&[true; COUNT]).unwrap();
                told(&mut other, after);
                other.restore(&state).unwrap();
                assert!(other.to_bytes() == state);
                assert!(told(&mut other, 200) == expected, "{autoreset:?} {after}");
                assert!(other.to_bytes() == whole.to_bytes(), "{autoreset:?} {after}");
            }
        }
    }
}

#[test]
fn a_state_of_other_environments_or_a_damaged_one_is_refused_and_changes_nothing() {
    let make = |count, seed| {
        Environments::new(world(Autoreset::SameStep), count, seed, Execution::serial()).unwrap()
    };
    let (one, mut other) = (make(COUNT, 9), make(COUNT, 9));
    told(&mut other, 5);
    let before = other.to_bytes();
    assert_eq!(
        refused(&make(COUNT + 1, 9), &one),
        "the state does not match: its number of environments is 151; it must be 150"
    );
    assert!(refused(&make(COUNT, 8), &one).contains("its seed is 8; it must be 9"));
    let state = one.to_bytes();
    let length = other.restore(&state[1..]).unwrap_err();
    let [found, wanted] = [state.len() - 1, state.len()];
    assert_eq!(length, CheckpointError::Length { found, wanted });
    // An episode that begins after all steps; a latency beyond the longest.
    let blocks = state.len() - 8 - 3 * (5 * 2 + 4) * 64 * 4;
    assert_eq!(blocks % 3, 0, "{blocks}");
    let end = 8 + blocks / 3;
    for at in [end - 64 - 4 * 64 * 8 + 7, end - 64 - 4 * 64 * 8 - 4] {
        let mut damaged = state.clone();
        damaged[at] = 0x7f;
        let error = other.restore(&damaged).unwrap_err().to_string();
        assert!(error.contains("environments from number 0 on is inconsistent"), "{error}");
        assert_eq!(other.to_bytes(), before);
    }
}

#[test]
fn a_replay_buffer_goes_on_bit_for_bit() {
    let serial = Execution::serial();
    let make = || ReplayBuffer::<f32>::new([2, 1], Capacity::new(40, COUNT).priorities()).unwrap();
    let mut all = Environments::new(world(Autoreset::SameStep), COUNT, 9, serial.clone()).unwrap();
    let (mut whole, mut other) = (make(), make());
    let mut insert = |into: [Option<&mut ReplayBuffer<f32>>; 2]| {
        let mut rollout = Rollout::new(Plan::new(7, COUNT).truncated()).unwrap();
        all.rollout(POLICY, &mut rollout).unwrap();
        let mut next = vec![0.0; 2 * COUNT];
        all.observe(&mut next).unwrap();
        for replay in into.into_iter().flatten() {
            replay.insert(&rollout, &next, &serial).unwrap();
        }
    };
    for _ in 0..9 {
        insert([Some(&mut whole), None]);
    }
    other.restore(&whole.to_bytes()).unwrap();
    for number in 0..9 {
        insert([Some(&mut whole), Some(&mut other)]);
        let [one, two] = [&mut whole, &mut other].map(|replay| {
            let mut batch = Batch::new(64, [2, 1]);
            let draw = Draw { seed: 1, number };
            let columns = &mut batch.columns();
            replay.sample_prioritised(draw, Lookahead::default(), 0.5, columns, &serial).unwrap();
            let priorities: Vec<f32> = batch.reward.iter().map(|x| x.abs()).collect();
            replay.update(&batch.number, &priorities, 0.6).unwrap();
            batch
        });
        assert_eq!(one, two);
    }
    assert!(whole.to_bytes() == other.to_bytes());
    let mut damaged = whole.to_bytes();
    damaged[512..1536].fill(0);
    let before = other.to_bytes();
    assert!(other.restore(&damaged).unwrap_err().to_string().contains("damaged"));
    assert!(other.to_bytes() == before);
    let small = ReplayBuffer::<f32>::new([2, 1], Capacity::new(41, COUNT).priorities()).unwrap();
    assert!(refused(&small, &whole).contains("its number of steps is 41; it must be 40"));
}
