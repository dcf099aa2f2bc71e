//! Rollouts as memory.

use libration::State;
use libration::ensemble::{Each, Execution};
use libration::integrator::{Integrator, Rk4};
use libration::rl::policy::Constant;
use libration::rl::start::At;
use libration::rl::task::SwingUp;
use libration::rl::{Environment, Environments, Plan, Rollout};
use libration::system::{Held, Pendulum};

#[test]
fn each_environment_has_its_own_system_and_tasks_see_what_they_say() {
    let systems: Vec<Pendulum<f64>> =
        (0..70).map(|n| Pendulum { omega2: 1.0 + f64::from(n) }).collect();
    let (task, start) = (SwingUp { velocity: 0.1, effort: 0.0 }, At(State { q: [0.5], v: [0.0] }));
    let environment = Environment::new(Each(&systems), Rk4, 0.05, task, start).substeps(2);
    let mut all = Environments::new(environment, 70, 0, Execution::serial()).unwrap();
    let mut rollout = Rollout::new(Plan::new(10, 70)).unwrap();
    all.rollout(Constant([0.125]), &mut rollout).unwrap();
    let mut seen = vec![0.0; 70 * 3];
    all.observe(&mut seen).unwrap();
    for (n, &system) in systems.iter().enumerate() {
        let held = Held { system, command: [0.125] };
        let state = (0..20).fold(State { q: [0.5], v: [0.0] }, |s, _| Rk4.step(&held, s, 0.05));
        assert_eq!(all.state(n), Some(state));
        let (cosine, sine, velocity) = (seen[3 * n], seen[3 * n + 1], seen[3 * n + 2]);
        // From the top: at rest below it is −1 and 0.
        let close = |a: f64, b: f64| (a - b).abs() < 1e-15;
        assert!(close(cosine, -state.q[0].cos()) && close(sine, -state.q[0].sin()), "{n}");
        assert_eq!(velocity, state.v[0]);
        let paid = rollout.reward()[9 * 70 + n];
        assert!((paid - (cosine - 1.0 - 0.1 * velocity * velocity)).abs() < 1e-14, "{n} {paid}");
    }
}

#[test]
fn a_plan_counts_the_bytes_of_table_9_11() {
    // Environments, horizon, and the source's column “MB”, which are MiB.
    for (environments, horizon, mebibytes) in
        [(256, 512, 2.125), (1024, 512, 8.5), (2048, 1024, 34.0), (4096, 1024, 68.0)]
    {
        let plan = Plan::new(horizon, environments);
        assert_eq!(plan.bytes_each(2, 1, 4), 17);
        assert_eq!(plan.bytes(2, 1, 4) as f64 / f64::from(1 << 20), mebibytes);
    }
    let plan = Plan::new(3, 5).truncated().log_probabilities().values();
    let fields = [
        ("observation", 32),
        ("action", 16),
        ("reward", 8),
        ("terminated", 1),
        ("truncated", 1),
        ("log_probability", 8),
        ("value", 8),
    ];
    assert_eq!((plan.fields(4, 2, 8), plan.bytes(4, 2, 8)), (fields, 74 * 15));
}

#[test]
fn values_have_their_room_and_nobody_else_writes_there() {
    let mut rollout = Rollout::<f32, 2, 1>::new(Plan::new(4, 64).values()).unwrap();
    rollout.value_mut().fill(2.5);
    let mut all = Environments::new(crate::ideal(), 64, 0, Execution::serial()).unwrap();
    let refused = all.rollout(Constant([0.0]), &mut rollout).unwrap_err().to_string();
    assert_eq!(
        refused,
        "the environments have a time limit: the rollout must have room for `truncated`"
    );
    let mut rollout = Rollout::new(Plan::new(4, 64).truncated().values()).unwrap();
    rollout.value_mut().fill(2.5);
    all.rollout(Constant([0.0]), &mut rollout).unwrap();
    assert!(rollout.value().iter().all(|&value| value == 2.5));
    assert!(rollout.reward().iter().any(|&reward| reward != 0.0));
}
