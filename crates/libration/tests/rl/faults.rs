//! Invalid values are rejected with the parameter's name, before any step.

use libration::State;
use libration::control::clock::{Gaussian, Jittered, Recorded, Uniform};
use libration::ensemble::{All, Execution};
use libration::rl::policy::{
    Activation, GaussianExploration, Linear, LinearPerEnvironment, Perceptron,
    PerceptronPerEnvironment,
};
use libration::rl::sensor::Noisy;
use libration::rl::start::UniformStart;
use libration::rl::task::Regulate;
use libration::rl::variation::RandomParameters;
use libration::rl::{
    Delays, Distribution, Environment, Environments, ErrorScale, Estimates, Plan, Rollout, World,
    Writes,
};
use libration::system::{BaselineOnly, Oscillator};

use crate::any_policy::{AnyPolicy, sequence};
use crate::bits::POLICY;
use crate::clocks::{Idle, even};
use crate::{ANYWHERE, plain};

fn made<E: World<f32, 2, 1>>(world: E) -> Result<Environments<f32, E, 2, 1>, String> {
    Environments::new(world, 2, 0, Execution::serial()).map_err(|error| error.to_string())
}

fn refused<E: World<f32, 2, 1>>(world: E) -> String {
    made(world).map(|_| ()).unwrap_err()
}

#[test]
fn an_environment_that_cannot_be_is_refused() {
    let mut backwards = plain();
    backwards.dt = -1.0;
    assert_eq!(
        refused(backwards),
        "the time step is -1.0 s; it must be a finite number above 0, in the float type as well"
    );
    assert_eq!(refused(plain().substeps(0)), "there are 0 substeps; there must be at least 1");
    assert_eq!(
        refused(plain().limit(0)),
        "the time limit is 0 actions; it must be at least 1, or absent"
    );
    let mut turned = plain();
    turned.start = UniformStart(ANYWHERE.1, ANYWHERE.0);
    assert_eq!(
        refused(turned),
        "width of the start 0 is -2; it must be a finite number of at least 0"
    );
    let late = |observation, action| plain().delays(Delays { observation, action });
    assert_eq!(
        refused(late([0, 5000], [0, 0])),
        "latency of observations is 5000; it must be at most 4096 steps"
    );
    assert_eq!(
        refused(late([0, 0], [3, 2])),
        "latency of actions is 3; it must be at most the largest"
    );
    assert!(refused(plain().clock(Jittered(Gaussian(f64::NAN)))).contains("rms of step times"));
    let noisy = plain().sensor(Noisy([Uniform(0.1), Uniform(-0.1)]));
    assert_eq!(
        refused(noisy),
        "the rms of the noise of observation 1 is -0.1; it must be a finite number of at least 0"
    );
    let varied = |distribution| {
        let apply =
            |_: [f32; 1], system: BaselineOnly<Oscillator<f32>>, task: Regulate| (system, task);
        refused(plain().variation(RandomParameters { numbers: [distribution], apply }))
    };
    for (distribution, wanted) in [
        (
            Distribution::Uniform(2.0, 1.0),
            "width of the variation 0 is -1; it must be a finite number of at least 0",
        ),
        (
            Distribution::LogUniform(0.0, 1.0),
            "lower end of the variation 0 is 0; it must be above 0 in the float type",
        ),
        (
            Distribution::LogUniform(1e-300, 1.0),
            "lower end of the variation 0 is 1e-300; it must be above 0 in the float type",
        ),
        (
            Distribution::LogUniform(2.0, 1.0),
            "upper end of the variation 0 is 1; it must be at least the lower",
        ),
        (
            Distribution::Normal(0.0, -1.0),
            "standard deviation of the variation 0 is -1; it must be at least 0",
        ),
        (
            Distribution::Normal(f64::NAN, 1.0),
            "mean of the variation 0 is NaN; it must be finite in the float type",
        ),
        (
            Distribution::Either(1.5, [0.0; 2]),
            "probability of the variation 0 is 1.5; it must be from 0 to 1",
        ),
    ] {
        assert_eq!(varied(distribution), wanted);
    }
    // The latency of an observation may be longer than any episode: it sees the start.
    assert!(made(late([4096; 2], [4096; 2])).is_ok());
}

#[test]
fn a_rollout_that_does_not_fit_is_refused_and_nothing_has_moved() {
    let mut two = made(plain()).unwrap();
    let mut fill = |plan: Plan| {
        let mut rollout = Rollout::new(plan).unwrap();
        two.rollout(AnyPolicy::Linear(POLICY), &mut rollout).map_err(|error| error.to_string())
    };
    let other = fill(Plan::new(4, 3).truncated()).unwrap_err();
    assert_eq!(other, "the number of environments of the rollout is 3; it must be 2");
    let unsaid = fill(Plan::new(4, 2)).unwrap_err();
    assert!(unsaid.contains("requires the field `truncated`"), "{unsaid}");
    fill(Plan::new(0, 2).truncated().writes(Writes::Past)).unwrap();
    assert_eq!(two.step(), 0);
    // What would fit is said, and fits.
    let large = |horizon, count| Rollout::<f32, 2, 1>::new(Plan::new(horizon, count)).map(|_| ());
    let told = large(1 << 20, 1 << 26).unwrap_err().to_string();
    assert!(told.starts_with(
        "a rollout of 1048576 steps of 67108864 environments takes 17 bytes per transition. 1196268.7 GB of memory are needed"
    ));
    let (_, steps) = told.split_once("The memory holds ").unwrap();
    let (steps, _) = steps.split_once(" steps of these environments").unwrap();
    // Half of it, since others may have taken some meanwhile.
    large(steps.parse::<usize>().unwrap() / 2, 1 << 26).unwrap();
    assert!(large(usize::MAX / 4, 1 << 20).unwrap_err().to_string().contains("memory"));
    let mut none = Environments::new(plain(), 0, 0, Execution::serial()).unwrap();
    none.rollout(
        AnyPolicy::Linear(POLICY),
        &mut Rollout::new(Plan::new(3, 0).truncated()).unwrap(),
    )
    .unwrap();
    let clock = (Recorded::once(&[1.0, 1.1, 0.9]), even().1);
    let mut short = Environments::new(plain().clock(clock), 2, 0, Execution::serial()).unwrap();
    let mut rollout = Rollout::new(Plan::new(5, 2).truncated()).unwrap();
    let error = short.rollout(Idle { words: 0 }, &mut rollout).unwrap_err().to_string();
    assert_eq!(error, "the record of a clock or a delay has 3 steps; the run requires 5");
}

#[test]
fn a_policy_that_cannot_act_is_refused() {
    fn told(policy: AnyPolicy<'_>) -> String {
        let mut two = made(plain()).unwrap();
        let mut rollout = Rollout::new(Plan::new(5, 2).truncated()).unwrap();
        two.rollout(policy, &mut rollout).unwrap_err().to_string()
    }
    assert_eq!(told(sequence(&[0.0; 9])), "the number of actions is 9; it must be 10");
    let linear = |weights| told(AnyPolicy::LinearPerEnvironment(LinearPerEnvironment(weights)));
    assert_eq!(linear(&[0.0; 5]), "the number of weights of the policy is 5; it must be 6");
    let network =
        |parameters, activation| told(AnyPolicy::Network(Perceptron { parameters, activation }));
    assert_eq!(
        network(&[0.0; 34], Activation::Tanh),
        "the number of parameters of the network is 34; it must be 105"
    );
    assert_eq!(
        told(AnyPolicy::Exploration(GaussianExploration { policy: POLICY, sigma: [0.0] })),
        "standard deviation of exploration 0 is 0; it must be a finite number above 0"
    );
    assert_eq!(
        told(AnyPolicy::Linear(Linear { weights: [[1.0, f64::NAN]], bias: [0.0] })),
        "weight of the policy 1 is NaN; it must be finite in the float type"
    );
    assert_eq!(
        told(AnyPolicy::constant(1e300)),
        "constant action 0 is 1e300; it must be finite in the float type"
    );
    let mut weights = [0.0; 6];
    weights[4] = f32::INFINITY;
    assert!(linear(&weights).contains("weight of the policy 4 is inf"));
    let mut parameters = [0.0; Perceptron::<f32, 8>::parameters(2, 1, 1)];
    parameters[32] = f32::NAN;
    let told_of_network = network(&parameters, Activation::Relu);
    assert!(told_of_network.contains("parameter of the network 32 is NaN"), "{told_of_network}");
    let networks =
        PerceptronPerEnvironment { parameters: &parameters, activation: Activation::Relu };
    assert_eq!(
        told(AnyPolicy::NetworkPerEnvironment(networks)),
        "the number of parameters of the networks is 33; it must be 66"
    );
    assert_eq!(
        told(AnyPolicy::random(1.0, 0.0)),
        "width of the random action 0 is -1; it must be a finite number above 0"
    );
    assert_eq!(
        told(AnyPolicy::random(0.0, 1e300)),
        "width of the random action 0 is 1e300; it must be a finite number above 0"
    );
}

#[test]
fn tasks_and_starts_that_cannot_be_are_refused() {
    let with = |task, start| {
        let Environment { systems, method, dt, .. } = plain();
        refused(Environment::new(systems, method, dt, task, start))
    };
    let told = with(Regulate { bound: f64::NAN, ..crate::TASK }, ANYWHERE);
    assert!(told.contains("bound is NaN; it must be above 0"), "{told}");
    let told = with(Regulate { velocity: 1e300, ..crate::TASK }, ANYWHERE);
    let wanted = "price of a velocity is 1e300; it must be small enough for the float type";
    assert!(told.contains(wanted), "{told}");
    let far = UniformStart(State { q: [0.0], v: [0.0] }, State { q: [1e300], v: [0.0] });
    let told = with(crate::TASK, far);
    assert!(told.contains("upper end of the start is 1e300"), "{told}");
    let kind = ErrorScale { clock: [-0.5, 1.0], ..ErrorScale::default() };
    let told = refused(plain().error_scale(kind));
    assert!(
        told.contains("error scale of the clock is -0.5; it must be a finite number of at least 0"),
        "{told}"
    );
    let told =
        refused(plain().error_scale(ErrorScale { sensor: [0.0, 1e39], ..ErrorScale::default() }));
    assert!(told.contains("error scale of the sensor is 1e39; it must be small enough"), "{told}");
    let far = Environments::<f32, _, 2, 1>::shard(plain(), usize::MAX, 3, 0, Execution::serial());
    assert!(far.unwrap_err().to_string().contains("number of the first environment"));
    // Most plans are larger than any memory, and some than any number.
    for plan in [Plan::new(usize::MAX, usize::MAX), Plan::new(usize::MAX, 0)] {
        assert_eq!(plan.bytes_each(usize::MAX, 1, 8), usize::MAX);
        let told = [
            Rollout::<f32, 2, 1>::new(plan).unwrap_err().to_string(),
            Estimates::<f32>::new(plan).unwrap_err().to_string(),
        ];
        assert!(told.iter().all(|told| told.contains("memory")), "{told:?}");
    }
}

#[test]
fn a_policy_that_draws_without_saying_so_is_refused() {
    let mut all = made(plain().clock(even())).unwrap();
    let mut rollout = Rollout::new(Plan::new(1, 2).truncated()).unwrap();
    assert!(all.rollout(Idle { words: 0 }, &mut rollout).is_ok());
    assert_eq!(
        all.rollout(Idle { words: 1 }, &mut rollout).unwrap_err().to_string(),
        "random words of the policy is 1; it must be 0 unless `DRAWS` is true"
    );
}

#[test]
fn systems_must_be_as_many_as_environments() {
    let three = [crate::SPRING; 3];
    let Environment { method, dt, task, start, .. } = plain();
    let each =
        Environment::new(libration::ensemble::PerTrajectory(&three), method, dt, task, start);
    assert!(refused(each).contains("3 systems for 2 trajectories"));
    let one = Environment::new(All(BaselineOnly(crate::SPRING)), method, dt, task, start);
    assert!(made(one).is_ok());
}
