//! Environments by programs against the compiled ones.
use libration::catalog::Actuation;
use libration::control::Jitter;
use libration::ensemble::{Execution, InstructionSet};
use libration::equations::{Definitions, Equations, TaskDefinitions, TaskPrograms};
use libration::rl::policy::{Activation, Network};
use libration::rl::task::{Regulate, Sine, SwingUp, Track};
use libration::rl::{
    Autoreset, Delays, Layout, Plan, ProgramEnvironment, ProgramPolicy, StepBuffers,
};
use libration::{AnySystem, Method};
use libration_env::environments::{
    AnyEnvironments, EnvironmentFloat, EnvironmentSettings, Noise, SingleDofSystem, Task,
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
    let (serial, settings) = (Execution::serial(), case.compiled(setting));
    let mut compiled = T::catalogued(&settings, which(&serial)).unwrap();
    let mut found = T::by_program(definition.clone(), which(execution)).unwrap();
    rollouts(&mut *compiled, &mut *found, what);
    let begin = || T::by_program(definition.clone(), which(execution)).unwrap();
    steps(&mut *compiled, found, &begin, what);
}

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
    begin: &dyn Fn() -> Box<dyn AnyEnvironments<T>>,
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
fn environments_by_equations_have_the_bits_of_the_compiled_ones() {
    let parallel = Execution::serial().threads(2).unwrap().worth(1);
    for case in &CASES {
        for (i, setting) in SETTINGS.iter().enumerate() {
            let what = format!("{} under setting {i}", case.system.0);
            compare::<f32>(case, setting, &parallel, &what);
            compare::<f64>(case, setting, &Execution::serial(), &what);
        }
    }
}
