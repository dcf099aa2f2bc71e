//! The programs of tasks.

use libration_equations::{
    Definitions, EquationError, Equations, Program, TaskDefinitions, TaskPrograms,
};

/// A coordinate `x` with the parameters `g`, which varies, and `k` = 2, and inputs `u` and `w`.
fn task(definitions: &TaskDefinitions) -> Result<TaskPrograms, EquationError> {
    let mut system = Definitions {
        coordinates: vec!["x".into()],
        accelerations: vec![("x".into(), "-g + k*u + w".into())],
        parameters: vec![("g".into(), 9.0), ("k".into(), 2.0)],
        inputs: vec!["u".into(), "w".into()],
        ..Definitions::default()
    };
    assert!(system.vary("g") && !system.vary("g") && !system.vary("u"));
    let equations = Equations::new(&system)?;
    assert_eq!((equations.inputs().len(), equations.dynamics().inputs()), (2, 3));
    let found = run(equations.dynamics().accelerations(), &[0.5, 0.25, 3.0, 4.0, 7.0]);
    assert_eq!(found, [-7.0 + 2.0 * 3.0 + 4.0]);
    TaskPrograms::new(definitions, &system, &equations)
}

fn run(program: &Program, inputs: &[f64]) -> Vec<f64> {
    program.on::<f64>().run(inputs).collect()
}

fn pairs(all: &[(&str, &str)]) -> Vec<(String, String)> {
    all.iter().map(|&(name, text)| (name.into(), text.into())).collect()
}

#[test]
fn a_parameter_that_varies_is_an_input_of_observation_and_reward() {
    let definitions = TaskDefinitions {
        observe: vec!["g*x".into(), "t".into()],
        reward: "g + before(x') + k*w".into(),
        terminated: vec!["x > g".into()],
        ..TaskDefinitions::default()
    };
    let task = task(&definitions).unwrap();
    assert_eq!(run(&task.observation, &[0.5, 0.25, 7.0, 1.5]), [3.5, 1.5]);
    // Positions and velocities before, inputs, the parameter, positions and velocities after, time.
    let verdict = run(&task.verdict, &[0.5, 0.25, 3.0, 4.0, 7.0, 8.0, 0.0, 1.5]);
    assert_eq!(verdict, [7.0 + 0.25 + 8.0, 1.0]);
    assert_eq!((task.projection, task.inner, task.targets), (None, None, 0));
}

#[test]
fn a_reward_is_no_number_where_an_observed_one_is_not_finite_before_or_after_the_step() {
    let with = |observe: &str| {
        let definitions = TaskDefinitions {
            observe: vec!["x'".into(), observe.into()],
            reward: "5".into(),
            ..TaskDefinitions::default()
        };
        task(&definitions).unwrap().verdict
    };
    let reward = |verdict: &Program, [before, after]: [f64; 2]| {
        run(verdict, &[before, 0.25, 3.0, 4.0, 7.0, after, 0.0, 1.5])[0]
    };
    for (observe, outside) in
        [("sqrt(x)", -1.0), ("2/x", 0.0), ("x^-1", 0.0), ("g*log(x)", 0.0), ("acos(x)", 2.0)]
    {
        let verdict = with(observe);
        assert_eq!(reward(&verdict, [0.5, 0.25]), 5.0, "{observe}");
        for states in [[outside, 0.5], [0.5, outside]] {
            assert!(reward(&verdict, states).is_nan(), "{observe} of {states:?}");
        }
    }
    // The time is that after the step.
    let verdict = with("sqrt(x - t)");
    assert_eq!(reward(&verdict, [1.25, 2.0]), 5.0);
    assert!(reward(&verdict, [1.25, 1.25]).is_nan());
    // What is finite everywhere costs no operation.
    for observe in ["x/2", "sin(x)*x^2", "min(x, atan2(x, g))"] {
        assert_eq!(with(observe), with("x"), "{observe}");
    }
}

#[test]
fn a_projection_has_the_states_before_and_after_a_step_and_its_length() {
    let definitions = TaskDefinitions {
        reward: "0".into(),
        project: pairs(&[("x'", "before(x') + dt*u"), ("x", "x + 100*x' + 10*before(x) + g")]),
        ..TaskDefinitions::default()
    };
    let projection = task(&definitions).unwrap().projection.unwrap();
    // Positions and velocities after, inputs, the parameter, the length, positions and velocities before.
    let found = run(&projection, &[1.0, 2.0, 3.0, 4.0, 7.0, 0.5, 5.0, 6.0]);
    assert_eq!(found, [1.0 + 200.0 + 50.0 + 7.0, 6.0 + 1.5]);
}

#[test]
fn an_inner_controller_gives_each_input_from_states_and_targets() {
    let definitions = TaskDefinitions {
        reward: "goal".into(),
        targets: vec!["goal".into()],
        inner: pairs(&[("w", "g + 100*age"), ("u", "k*(goal - x) - x'")]),
        ..TaskDefinitions::default()
    };
    let task = task(&definitions).unwrap();
    // Positions and velocities, the parameter, the targets, and their age.
    let found = run(&task.inner.unwrap(), &[0.5, 0.25, 7.0, 3.0, 0.5]);
    assert_eq!(found, [2.0 * 2.5 - 0.25, 57.0]);
    assert_eq!(run(&task.verdict, &[0.5, 0.25, 3.0, 7.0, 8.0, 0.0, 1.5])[0], 3.0);
    assert_eq!(task.targets, 1);
}

#[test]
fn wrong_projections_and_inner_controllers_are_errors_with_their_keys() {
    let with = |edit: &dyn Fn(&mut TaskDefinitions)| {
        let mut definitions = TaskDefinitions { reward: "0".into(), ..TaskDefinitions::default() };
        edit(&mut definitions);
        let error = task(&definitions).unwrap_err();
        (error.key.clone(), error.to_string())
    };
    for (key, text, edit) in [
        ("task.project.y", "unknown name `y`", pairs(&[("y", "0")])),
        ("task.project.x", "unknown name `z`", pairs(&[("x", "z")])),
        ("task.project.x", "unknown name `t`", pairs(&[("x", "t")])),
    ] {
        let (found, message) = with(&|task| task.project = edit.clone());
        assert!(found == key && message.contains(text), "{found}: {message}");
    }
    for (key, text, targets, inner) in [
        ("task.inner.v", "unknown name `v`", vec!["goal"], pairs(&[("v", "goal")])),
        ("task.inner", "`w` has no command", vec!["goal"], pairs(&[("u", "goal")])),
        ("task.inner", "without targets", vec![], pairs(&[("u", "0"), ("w", "0")])),
        ("task.targets", "`x` is given twice", vec!["x"], pairs(&[("u", "0"), ("w", "0")])),
        ("task.targets", "`1` is no name", vec!["1"], pairs(&[("u", "0"), ("w", "0")])),
        (
            "task.targets",
            "`t` is a name of the language",
            vec!["t"],
            pairs(&[("u", "0"), ("w", "0")]),
        ),
        ("task.inner.u", "unknown name `w`", vec!["goal"], pairs(&[("u", "w"), ("w", "0")])),
    ] {
        let (found, message) = with(&|task| {
            task.targets = targets.iter().copied().map(String::from).collect();
            task.inner = inner.clone();
        });
        assert!(found == key && message.contains(text), "{found}: {message}");
    }
}
