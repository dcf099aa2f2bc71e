//! Environments by programs, with any numbers of observations and actions.

use libration::Method;
use libration::ensemble::Execution;
use libration::equations::{Definitions, Equations, TaskDefinitions, TaskPrograms};
use libration::rl::{
    Autoreset, Layout, Plan, ProgramEnvironment, ProgramEnvironments, ProgramPolicy,
    ProgramRollout, RolloutTensors,
};

use super::Source;

/// A spring with so many forces, of which actions of a few units throw it out before the time limit, now and then. No two of the
/// observed numbers are the same.
pub(crate) fn programs(
    autoreset: Autoreset,
    count: usize,
    [observations, actions]: [usize; 2],
) -> ProgramEnvironments<f32> {
    let inputs: Vec<String> = (0..actions).map(|i| format!("u{i}")).collect();
    let system = Definitions {
        coordinates: vec!["x".into()],
        accelerations: vec![("x".into(), format!("-10*x + {}", inputs.join(" - ")))],
        inputs,
        ..Definitions::default()
    };
    let equations = Equations::new(&system).unwrap();
    let observed = |i: usize| if i == 1 { "x'".into() } else { format!("{}*x + {i}", i + 1) };
    let task = TaskDefinitions {
        observe: (0..observations).map(observed).collect(),
        reward: "-x^2 - 0.01*u0^2".into(),
        terminated: vec!["abs(x) > 1.2".into()],
        ..TaskDefinitions::default()
    };
    let task = TaskPrograms::new(&task, &system, &equations).unwrap();
    let environment = ProgramEnvironment {
        start: vec![[-1.0, 1.0], [-2.0, 2.0]],
        limit: Some(7),
        autoreset,
        ..ProgramEnvironment::new(equations.dynamics().clone(), task, Method::SymplecticEuler, 0.06)
    };
    ProgramEnvironments::shard(environment, 0, count, 7, Execution::serial()).unwrap()
}

impl Source for ProgramEnvironments<f32> {
    fn reset(&mut self, which: &[bool]) {
        ProgramEnvironments::reset(self, which).unwrap();
    }

    fn run(&mut self, steps: usize, layout: Layout) -> (Box<dyn RolloutTensors<f32>>, Vec<f32>) {
        let definition = self.definition();
        let (observations, actions) = (definition.observations(), definition.saturation.len());
        let plan = Plan::new(steps, self.len()).truncated().layout(layout);
        let mut rollout = ProgramRollout::new(plan, [observations, actions]).unwrap();
        let (low, high) = (vec![-4.0; actions], vec![4.0; actions]);
        self.rollout(ProgramPolicy::Random { low: &low, high: &high }, &mut rollout).unwrap();
        let mut next = vec![0.0; observations * self.len()];
        self.observe(&mut next).unwrap();
        (Box::new(rollout), next)
    }
}
