//! Environments by programs against compiled ones.

mod cases;
mod compiled;
mod faults;

use cases::{CASES, Case, SETTINGS, Setting};
use compiled::compiled;
use libration::ensemble::{Execution, InstructionSet};
use libration::rl::policy::{Activation, Network};
use libration::rl::{Layout, Plan, ProgramPolicy, StepBuffers};
use libration_env::environments::{AnyEnvironments, EnvironmentFloat};

const SEED: u64 = 11;
const HORIZON: usize = 48;

fn drawn(n: usize) -> f64 {
    (n as f64 * 0.754_877_666).sin()
}

fn policies<'a, T: EnvironmentFloat>(
    observations: usize,
    numbers: &'a [f64],
    parameters: &'a [T],
) -> [ProgramPolicy<'a, T>; 4] {
    let network = Network {
        parameters: &parameters[..Network::<T>::parameters(observations, &[7], 1)],
        hidden: &[7],
        activation: Activation::Tanh,
        instructions: InstructionSet::widest(),
    };
    [
        ProgramPolicy::Linear { weights: &numbers[..observations], bias: &[0.1] },
        ProgramPolicy::Random { low: &[-1.0], high: &[1.5] },
        ProgramPolicy::Network(network),
        ProgramPolicy::Constant(&[0.25]),
    ]
}

/// Runs both and fails at the first difference.
fn compare<T: EnvironmentFloat>(case: &Case, setting: &Setting, execution: &Execution, what: &str) {
    let which = |execution| ([3, setting.environments], SEED, execution);
    let definition = case.by_program(setting);
    let (serial, settings) = (Execution::serial(), case.settings(setting));
    let by_equations = || T::by_program(definition.clone(), which(execution)).unwrap();
    let catalogued = || settings.build::<T>(which(execution)).unwrap();
    for (begin, how) in [(&by_equations as &Begin<T>, "equations"), (&catalogued, "settings")] {
        let what = format!("{what} by {how}");
        let mut reference = compiled::<T>(&settings, which(&serial));
        let mut found = begin();
        rollouts(&mut *reference, &mut *found, &what);
        steps(&mut *reference, found, begin, &what);
    }
}

type Begin<'a, T> = dyn Fn() -> Box<dyn AnyEnvironments<T>> + 'a;

fn rollouts<T: EnvironmentFloat>(
    compiled: &mut dyn AnyEnvironments<T>,
    found: &mut dyn AnyEnvironments<T>,
    what: &str,
) {
    let len = compiled.len();
    let numbers: [f64; 200] = core::array::from_fn(drawn);
    let parameters = numbers.map(T::from_f64);
    let plan = Plan::new(HORIZON, len).truncated().log_probabilities();
    let mut rollout = compiled.new_rollout(plan).unwrap();
    let mut other = found.new_rollout(plan.layout(Layout::Planes)).unwrap();
    let [observations, _] = compiled.sizes();
    for (i, policy) in policies(observations, &numbers, &parameters).into_iter().enumerate() {
        let what = format!("{what} (policy {i})");
        compiled.fill(policy, &mut *rollout, 0..HORIZON).unwrap();
        found.fill(policy, &mut *other, 0..20).unwrap();
        found.fill(policy, &mut *other, 20..HORIZON).unwrap();
        for i in 0..observations {
            let all = rollout.observation().iter().skip(i).step_by(observations);
            let plane = &other.observation()[i * HORIZON * len..][..HORIZON * len];
            assert!(all.eq(plane), "observation {i} of {what}");
        }
        assert!(other.action() == rollout.action(), "actions of {what}");
        assert!(other.reward() == rollout.reward(), "rewards of {what}");
        assert_eq!(other.terminated(), rollout.terminated(), "terminations of {what}");
        assert_eq!(other.truncated(), rollout.truncated(), "truncations of {what}");
        assert!(other.log_probability() == rollout.log_probability(), "densities of {what}");
        assert!(other.ends() == rollout.ends(), "ends of {what}");
        assert_eq!(other.transitions(), rollout.transitions(), "transitions of {what}");
        for n in 0..len {
            assert_eq!(found.state(n).unwrap(), compiled.state(n).unwrap(), "{what}");
        }
    }
}

/// Steps by actions from outside, with resets between, and a state that is restored.
fn steps<T: EnvironmentFloat>(
    compiled: &mut dyn AnyEnvironments<T>,
    mut found: Box<dyn AnyEnvironments<T>>,
    begin: &Begin<'_, T>,
    what: &str,
) {
    let len = compiled.len();
    let zeros = |count: usize| vec![T::zero(); count];
    let mut wanted = (zeros(len * compiled.sizes()[0]), zeros(len), vec![0; len], vec![0; len]);
    let mut got = wanted.clone();
    fn buffers<T>(to: &mut (Vec<T>, Vec<T>, Vec<u8>, Vec<u8>)) -> StepBuffers<'_, T> {
        let (seen, reward, terminated, truncated) = to;
        StepBuffers { seen, reward, terminated, truncated }
    }
    for t in 0..60 {
        let actions: Vec<T> = (0..len).map(|n| T::from_f64(drawn(n + 1000 * t))).collect();
        let sequence = ProgramPolicy::ActionSequence(&actions);
        let ends = compiled.act(sequence, buffers(&mut wanted)).unwrap();
        let other = found.act(sequence, buffers(&mut got)).unwrap();
        assert!(got == wanted, "step {t} of {what}");
        assert!(other == ends, "ends of step {t} of {what}");
        if t == 20 {
            let every = |n: usize, rest| (0..len).map(|l| l % n == rest).collect::<Vec<_>>();
            let (which, ends) = (every(3, 0), every(7, 2));
            let seeds: Vec<_> = (0..len).map(|n| (n % 5 == 1).then_some(n as u64)).collect();
            for environments in [&mut *compiled, &mut *found] {
                environments.reset(&which).unwrap();
                environments.seed(&seeds).unwrap();
                environments.end(&ends).unwrap();
            }
        }
        if t == 40 {
            let state = found.to_bytes();
            found = begin();
            found.restore(&state).unwrap();
            assert!(found.to_bytes() == state);
        }
        let (mut seen, mut looked) = (wanted.0.clone(), got.0.clone());
        compiled.observe(&mut seen).unwrap();
        found.observe(&mut looked).unwrap();
        assert!(seen == looked, "observations after step {t} of {what}");
    }
}

#[test]
fn environments_by_equations_and_by_settings_have_the_bits_of_compiled_ones() {
    let parallel = Execution::serial().threads(2).unwrap().worth(1);
    for case in &CASES {
        for (i, setting) in SETTINGS.iter().enumerate() {
            let what = format!("{} under setting {i}", case.system.0);
            compare::<f32>(case, setting, &parallel, &what);
            compare::<f64>(case, setting, &Execution::serial(), &what);
        }
    }
}
