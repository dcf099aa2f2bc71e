//! Checkpoints of environments by programs.

use libration::Method;
use libration::checkpoint::Checkpoint;
use libration::control::Jitter;
use libration::ensemble::Execution;
use libration::equations::{Definitions, Equations, TaskDefinitions, TaskPrograms};
use libration::rl::{
    Delays, ErrorScale, ProgramEnvironment, ProgramEnvironments, ProgramPolicy, StepBuffers,
};

const COUNT: usize = 70;

/// Environments whose episodes all end with every fifth step.
fn environments(
    edit: impl FnOnce(ProgramEnvironment) -> ProgramEnvironment,
) -> ProgramEnvironments<f64> {
    let system = Definitions {
        coordinates: vec!["x".into()],
        accelerations: vec![("x".into(), "-10*sin(x) + u".into())],
        inputs: vec!["u".into()],
        ..Definitions::default()
    };
    let equations = Equations::new(&system).unwrap();
    let task = TaskDefinitions {
        observe: vec!["x".into(), "x'".into()],
        reward: "-x^2".into(),
        ..TaskDefinitions::default()
    };
    let task = TaskPrograms::new(&task, &system, &equations).unwrap();
    let plain = ProgramEnvironment {
        start: vec![[-1.0, 1.0], [0.0, 0.0]],
        limit: Some(5),
        jitter: Jitter::Gaussian(0.1),
        delays: Delays { observation: [2; 2], action: [2; 2] },
        ..ProgramEnvironment::new(equations.dynamics().clone(), task, Method::Rk4, 0.05)
    };
    ProgramEnvironments::shard(edit(plain), 0, COUNT, 7, Execution::serial()).unwrap()
}

/// What is observed after each of so many steps.
fn observed(all: &mut ProgramEnvironments<f64>, steps: usize) -> Vec<[f64; 2 * COUNT]> {
    let (mut reward, mut terminated, mut truncated) = ([0.0; COUNT], [0; COUNT], [0; COUNT]);
    let step = |_| {
        let mut seen = [0.0; 2 * COUNT];
        let to = StepBuffers {
            seen: &mut seen,
            reward: &mut reward,
            terminated: &mut terminated,
            truncated: &mut truncated,
        };
        all.act(ProgramPolicy::Constant(&[1.0]), to).unwrap();
        seen
    };
    (0..steps).map(step).collect()
}

#[test]
fn an_episode_of_another_definition_goes_on_and_the_next_is_of_their_own() {
    let others: [fn(ProgramEnvironment) -> ProgramEnvironment; 4] = [
        |plain| ProgramEnvironment {
            delays: Delays { observation: [2; 2], action: [0, 2] },
            ..plain
        },
        |plain| ProgramEnvironment {
            delays: Delays { observation: [0, 2], action: [2; 2] },
            ..plain
        },
        |plain| ProgramEnvironment {
            error_scale: ErrorScale { clock: [0.0, 2.0], ..ErrorScale::default() },
            ..plain
        },
        |plain| ProgramEnvironment { skew: Jitter::Uniform(0.2), ..plain },
    ];
    for (i, other) in others.into_iter().enumerate() {
        let (mut restored, mut own) = (environments(|plain| plain), environments(|plain| plain));
        let mut other = environments(other);
        restored.restore(&other.to_bytes()).unwrap();
        // The fourth is the last observation of the episode.
        let [found, wanted] = [&mut restored, &mut own].map(|all| observed(all, 12));
        assert_eq!(found[..4], observed(&mut other, 4), "{i}");
        assert_ne!(found[..4], wanted[..4], "{i}");
        assert_eq!(found[4..], wanted[4..], "{i}");
    }
}
