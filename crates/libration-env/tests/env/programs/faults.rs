//! Definitions that are refused before anything moves.

use libration::Method;
use libration::ensemble::Execution;
use libration::equations::{Definitions, Equations, TaskDefinitions, TaskPrograms};
use libration::rl::{ProgramEnvironment, ProgramEnvironments};

fn refused(environment: ProgramEnvironment) -> String {
    let shard = ProgramEnvironments::<f32>::shard(environment, 0, 2, 7, Execution::serial());
    shard.map(|_| ()).expect_err("it cannot be").to_string()
}

#[test]
fn commands_that_no_inner_controller_holds_are_held_for_a_step_or_more_too() {
    let system = Definitions {
        coordinates: vec!["x".into()],
        accelerations: vec![("x".into(), "u - x".into())],
        inputs: vec!["u".into()],
        ..Definitions::default()
    };
    let equations = Equations::new(&system).expect("it is sound");
    let task = TaskDefinitions {
        observe: vec!["x".into()],
        reward: "-x^2".into(),
        ..TaskDefinitions::default()
    };
    let task = TaskPrograms::new(&task, &system, &equations).expect("it is sound");
    let sound = ProgramEnvironment::new(equations.dynamics().clone(), task, Method::Rk4, 0.01);
    let told = refused(ProgramEnvironment { inner_steps: 0, ..sound });
    assert_eq!(told, "steps of the inner controller is 0; it must be at least 1");
}
