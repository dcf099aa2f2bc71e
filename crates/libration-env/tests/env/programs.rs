//! Environments by programs against the compiled ones.

use libration::catalog::Actuation;
use libration::checkpoint::Checkpoint;
use libration::control::Jitter;
use libration::ensemble::{Execution, InstructionSet};
use libration::equations::{Definitions, Equations, TaskDefinitions, TaskPrograms};
use libration::random::{Address, Purpose};
use libration::rl::policy::{ActionSequence, Activation, Constant, Linear, Network, Random};
use libration::rl::task::{Regulate, Sine, SwingUp, Track};
use libration::rl::{
    Autoreset, Delays, Plan, ProgramEnvironment, ProgramEnvironments, ProgramPolicy,
    ProgramRollout, Rollout, StepBuffers,
};
use libration::{AnySystem, Method};
use libration_env::environments::{
    AnyEnvironments, AnyPolicy, EnvironmentFloat, EnvironmentSettings, EnvironmentsVisitor, Noise,
    SingleDofSystem, Task,
};

/// A task on a system, compiled and by its equations.
struct Case {
    system: (&'static str, &'static [(&'static str, f64)]),
    acceleration: &'static str,
    task: Task,
    observe: &'static [&'static str],
    reward: &'static str,
    terminated: &'static [&'static str],
}

const REGULATE: Regulate = Regulate { position: 1.0, velocity: 0.1, effort: 0.01, bound: 1.2 };

const CASES: [Case; 3] = [
    Case {
        system: ("oscillator", &[("omega2", 10.0)]),
        acceleration: "-omega2*x + u",
        task: Task::Regulate(REGULATE),
        observe: &["x", "x'"],
        reward: "-(1*x^2 + 0.1*x'^2 + 0.01*u^2)",
        terminated: &["x > 1.2", "x < -1.2"],
    },
    Case {
        system: ("pendulum", &[("omega2", 4.0)]),
        acceleration: "-omega2*sin(x) + u",
        task: Task::SwingUp(SwingUp { velocity: 0.2, effort: 0.01 }),
        observe: &["-cos(x)", "-sin(x)", "x'"],
        reward: "-cos(before(x)) - 1 - 0.2*before(x')^2 - 0.01*u^2",
        terminated: &[],
    },
    Case {
        system: ("duffing", &[("alpha", -1.0), ("beta", 1.0)]),
        acceleration: "-(alpha*x + beta*((x*x)*x)) + u",
        task: Task::Track(Track {
            reference: Sine { amplitude: 0.5, angular_frequency: 2.0, phase: 0.1 },
            regulate: REGULATE,
        }),
        observe: &["x", "x'", "0.5*sin(2*t + 0.1)", "0.5*2*cos(2*t + 0.1)"],
        reward: "-(1*(x - 0.5*sin(2*t + 0.1))^2 + 0.1*(x' - 0.5*2*cos(2*t + 0.1))^2 + 0.01*u^2)",
        terminated: &["x - 0.5*sin(2*t + 0.1) > 1.2", "x - 0.5*sin(2*t + 0.1) < -1.2"],
    },
];

/// The settings that differ between the runs of a case.
#[derive(Clone, Copy, Debug)]
struct Setting {
    method: Method,
    substeps: u32,
    delays: Delays,
    saturation: f64,
    noise: f64,
    autoreset: Autoreset,
    limit: Option<u32>,
    environments: usize,
}

const SETTINGS: [Setting; 4] = [
    Setting {
        method: Method::VelocityVerlet,
        substeps: 1,
        delays: Delays { observation: [0, 0], action: [0, 0] },
        saturation: f64::INFINITY,
        noise: 0.0,
        autoreset: Autoreset::SameStep,
        limit: Some(40),
        environments: 200,
    },
    Setting {
        method: Method::Rk4,
        substeps: 3,
        delays: Delays { observation: [0, 4], action: [1, 5] },
        saturation: 0.8,
        noise: 0.0,
        autoreset: Autoreset::NextStep,
        limit: Some(33),
        environments: 70,
    },
    Setting {
        method: Method::SymplecticEuler,
        substeps: 2,
        delays: Delays { observation: [2, 2], action: [0, 0] },
        saturation: 2.0,
        noise: 0.05,
        autoreset: Autoreset::Disabled,
        limit: Some(21),
        environments: 65,
    },
    Setting {
        method: Method::Yoshida4,
        substeps: 1,
        delays: Delays { observation: [0, 0], action: [3, 3] },
        saturation: f64::INFINITY,
        noise: 0.02,
        autoreset: Autoreset::SameStep,
        limit: None,
        environments: 1,
    },
];

impl Case {
    fn compiled(&self, setting: &Setting) -> EnvironmentSettings {
        let law = |scale: f64| Jitter::Gaussian(scale * setting.noise);
        EnvironmentSettings {
            system: SingleDofSystem::new(AnySystem::build(self.system.0, self.system.1).unwrap())
                .unwrap(),
            actuation: Actuation::Acceleration,
            method: setting.method,
            dt: 0.02,
            substeps: setting.substeps,
            task: self.task,
            start: [[-1.0, 1.0], [-0.5, 0.5]],
            limit: setting.limit,
            autoreset: setting.autoreset,
            delays: setting.delays,
            saturation: setting.saturation,
            noise: Noise { jitter: law(2.0), skew: law(0.5), observation: law(1.0) },
        }
    }

    fn by_program(&self, setting: &Setting) -> ProgramEnvironment {
        let text = str::to_owned;
        let definitions = Definitions {
            coordinates: vec!["x".into()],
            accelerations: vec![("x".into(), self.acceleration.into())],
            parameters: self.system.1.iter().map(|&(name, value)| (name.into(), value)).collect(),
            inputs: vec!["u".into()],
            ..Definitions::default()
        };
        let equations = Equations::new(&definitions).unwrap();
        let task = TaskDefinitions {
            observe: self.observe.iter().copied().map(text).collect(),
            reward: self.reward.into(),
            terminated: self.terminated.iter().copied().map(text).collect(),
        };
        let task = TaskPrograms::new(&task, &definitions, &equations).unwrap();
        let compiled = self.compiled(setting);
        let noise = compiled.noise;
        ProgramEnvironment {
            start: compiled.start.to_vec(),
            limit: compiled.limit,
            autoreset: compiled.autoreset,
            delays: compiled.delays,
            substeps: compiled.substeps,
            saturation: vec![compiled.saturation],
            jitter: noise.jitter,
            skew: noise.skew,
            noise: vec![noise.observation; self.observe.len()],
            ..ProgramEnvironment::new(
                equations.dynamics().clone(),
                task,
                compiled.method,
                compiled.dt,
            )
        }
    }
}

/// Runs both under several policies and fails at the first difference.
struct Compare<'a> {
    definition: &'a ProgramEnvironment,
    what: String,
    execution: &'a Execution,
}

const SEED: u64 = 11;
const HORIZON: usize = 48;

/// A number from −1 to 1.
fn drawn(n: usize) -> f64 {
    let place = Address { seed: 5, trajectory: 0, step: n as u64, purpose: Purpose::Action };
    2.0 * place.uniform()[0] - 1.0
}

fn policies<'a, T: EnvironmentFloat, const O: usize>(
    numbers: &'a [f64],
    parameters: &'a [T],
) -> Vec<(AnyPolicy<'a, T, O>, ProgramPolicy<'a, T>)> {
    let weights = core::array::from_fn(|i| numbers[i]);
    let network = Network {
        parameters: &parameters[..Network::<T>::parameters(O, &[7], 1)],
        hidden: &[7],
        activation: Activation::Tanh,
        instructions: InstructionSet::widest(),
    };
    vec![
        (
            AnyPolicy::Linear(Linear { weights: [weights], bias: [0.1] }),
            ProgramPolicy::Linear { weights: &numbers[..O], bias: &[0.1] },
        ),
        (
            AnyPolicy::Random(Random::between([-1.0], [1.5])),
            ProgramPolicy::Random { low: &[-1.0], high: &[1.5] },
        ),
        (AnyPolicy::Network(network), ProgramPolicy::Network(network)),
        (AnyPolicy::Constant(Constant([0.25])), ProgramPolicy::Constant(&[0.25])),
    ]
}

impl<T: EnvironmentFloat> EnvironmentsVisitor<T> for Compare<'_> {
    type Output = ();

    fn visit<const O: usize>(self, mut compiled: Box<dyn AnyEnvironments<T, O>>) {
        let len = compiled.len();
        let execution = self.execution.clone();
        let mut found =
            ProgramEnvironments::<T>::shard(self.definition.clone(), 3, len, SEED, execution)
                .unwrap();
        let numbers: Vec<f64> = (0..200).map(drawn).collect();
        let parameters: Vec<T> = numbers.iter().map(|&x| T::from_f64(x)).collect();
        let plan = Plan::new(HORIZON, len).truncated().log_probabilities();
        let mut rollout = Rollout::<T, O, 1>::new(plan).unwrap();
        let mut other = ProgramRollout::<T>::new(plan, [O, 1]).unwrap();
        for (i, (policy, by_program)) in policies(&numbers, &parameters).into_iter().enumerate() {
            let what = format!("{} (policy {i})", self.what);
            compiled.rollout(policy, &mut rollout).unwrap();
            found.fill(by_program, &mut other, 0..20).unwrap();
            found.fill(by_program, &mut other, 20..HORIZON).unwrap();
            assert!(other.observation() == rollout.observation(), "observations of {what}");
            assert!(other.action() == rollout.action(), "actions of {what}");
            let rest = other.transitions();
            assert!(rest.reward() == rollout.reward(), "rewards of {what}");
            assert_eq!(rest.terminated(), rollout.terminated(), "terminations of {what}");
            assert_eq!(rest.truncated(), rollout.truncated(), "truncations of {what}");
            assert!(rest.log_probability() == rollout.log_probability(), "densities of {what}");
            let last: Vec<T> = rollout.finals().iter().flat_map(|end| end.observation).collect();
            assert!(other.final_observations() == last, "final observations of {what}");
            assert_eq!(rest.finals().len(), rollout.finals().len(), "{what}");
            for (found, end) in rest.finals().iter().zip(rollout.finals()) {
                let place = (found.step, found.environment, found.length, found.lost);
                assert_eq!(place, (end.step, end.environment, end.length, end.lost), "{what}");
                assert_eq!(found.episode_return, end.episode_return, "{what}");
            }
            for n in 0..len {
                assert_eq!(found.state(n).unwrap(), compiled.state(n).unwrap(), "{what}");
            }
        }
        self.steps(&mut *compiled, &mut found);
    }
}

impl Compare<'_> {
    /// Steps by actions from outside, with resets between, and a state that is restored.
    fn steps<T: EnvironmentFloat, const O: usize>(
        &self,
        compiled: &mut dyn AnyEnvironments<T, O>,
        found: &mut ProgramEnvironments<T>,
    ) {
        let len = compiled.len();
        let zeros = || (vec![T::zero(); len * O], vec![T::zero(); len], vec![0; len], vec![0; len]);
        let (mut wanted, mut got) = (zeros(), zeros());
        fn buffers<T>(to: &mut (Vec<T>, Vec<T>, Vec<u8>, Vec<u8>)) -> StepBuffers<'_, T> {
            let (seen, reward, terminated, truncated) = to;
            StepBuffers { seen, reward, terminated, truncated }
        }
        for t in 0..60 {
            let actions: Vec<T> = (0..len).map(|n| T::from_f64(drawn(n + 1000 * t))).collect();
            let sequence = AnyPolicy::ActionSequence(ActionSequence(&actions));
            let ends = compiled.act(sequence, buffers(&mut wanted)).unwrap();
            let sequence = ProgramPolicy::ActionSequence(&actions);
            let other = found.act(sequence, buffers(&mut got)).unwrap();
            assert!(got == wanted, "step {t} of {}", self.what);
            let last: Vec<T> = ends.iter().flat_map(|end| end.observation).collect();
            assert!(other.observations == last, "ends of step {t} of {}", self.what);
            if t == 20 {
                let which: Vec<bool> = (0..len).map(|n| n % 3 == 0).collect();
                compiled.reset(&which).unwrap();
                found.reset(&which).unwrap();
                let seeds: Vec<_> = (0..len).map(|n| (n % 5 == 1).then_some(n as u64)).collect();
                compiled.seed(&seeds).unwrap();
                found.seed(&seeds).unwrap();
                let ends: Vec<bool> = (0..len).map(|n| n % 7 == 2).collect();
                compiled.end(&ends).unwrap();
                found.end(&ends).unwrap();
            }
            if t == 40 {
                let state = found.to_bytes();
                let execution = self.execution.clone();
                let definition = self.definition.clone();
                *found = ProgramEnvironments::shard(definition, 3, len, SEED, execution).unwrap();
                found.restore(&state).unwrap();
                assert!(found.to_bytes() == state);
            }
            let (mut seen, mut looked) = (wanted.0.clone(), got.0.clone());
            compiled.observe(&mut seen).unwrap();
            found.observe(&mut looked).unwrap();
            assert!(seen == looked, "observations after step {t} of {}", self.what);
        }
    }
}

#[test]
fn environments_by_equations_have_the_bits_of_the_compiled_ones() {
    let parallel = Execution::serial().threads(2).unwrap().worth(1);
    for case in &CASES {
        for (i, setting) in SETTINGS.iter().enumerate() {
            let definition = case.by_program(setting);
            let what = format!("{} under setting {i}", case.system.0);
            let at = |execution| Compare { definition: &definition, what: what.clone(), execution };
            let compiled = case.compiled(setting);
            let which = [3, setting.environments];
            let serial = Execution::serial();
            compiled.with::<f32, _>(which, SEED, &serial, at(&parallel)).unwrap();
            compiled.with::<f64, _>(which, SEED, &serial, at(&serial)).unwrap();
        }
    }
}
