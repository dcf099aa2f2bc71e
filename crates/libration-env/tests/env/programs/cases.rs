//! Tasks on systems, and settings of their environments.

use libration::catalog::Actuation;
use libration::control::Jitter;
use libration::equations::{Definitions, Equations, TaskDefinitions, TaskPrograms};
use libration::rl::task::{Regulate, Sine, SwingUp, Track};
use libration::rl::{Autoreset, Delays, ProgramEnvironment};
use libration::{AnySystem, Method};
use libration_env::environments::{CatalogueTask, EnvironmentSettings, Task};

/// A task on a system, compiled and by its equations.
pub(super) struct Case {
    pub(super) system: (&'static str, &'static [(&'static str, f64)]),
    actuation: Actuation,
    acceleration: &'static str,
    task: Task,
    observe: &'static [&'static str],
    reward: &'static str,
    terminated: &'static [&'static str],
}

const REGULATE: Regulate = Regulate { position: 1.0, velocity: 0.1, effort: 0.01, bound: 1.2 };

pub(super) const CASES: [Case; 4] = [
    Case {
        system: ("damped-oscillator", &[("omega2", 3.7), ("gamma", 0.3)]),
        actuation: Actuation::Force { mass: 1.3, stiffness: 4.81 },
        acceleration: "-omega2*x - gamma*x' + (1/1.3)*u",
        task: Task::Regulate(REGULATE),
        observe: &["x", "x'"],
        reward: "-(1*x^2 + 0.1*x'^2 + 0.01*u^2)",
        terminated: &["x > 1.2", "x < -1.2"],
    },
    Case {
        system: ("oscillator", &[("omega2", 10.0)]),
        actuation: Actuation::Acceleration,
        acceleration: "-omega2*x + u",
        task: Task::Regulate(REGULATE),
        observe: &["x", "x'"],
        reward: "-(1*x^2 + 0.1*x'^2 + 0.01*u^2)",
        terminated: &["x > 1.2", "x < -1.2"],
    },
    Case {
        system: ("pendulum", &[("omega2", 4.0)]),
        actuation: Actuation::Acceleration,
        acceleration: "-omega2*sin(x) + u",
        task: Task::SwingUp(SwingUp { velocity: 0.2, effort: 0.01 }),
        observe: &["-cos(x)", "-sin(x)", "x'"],
        reward: "-cos(before(x)) - 1 - 0.2*before(x')^2 - 0.01*u^2",
        terminated: &[],
    },
    Case {
        system: ("duffing", &[("alpha", -1.0), ("beta", 1.0)]),
        actuation: Actuation::Acceleration,
        acceleration: "-(alpha*x + beta*((x*x)*x)) + u",
        task: Task::Track(Track {
            reference: Sine { amplitude: 0.3, angular_frequency: 1.7, phase: 0.1 },
            regulate: REGULATE,
        }),
        observe: &["x", "x'", "0.3*sin(1.7*t + 0.1)", "0.3*1.7*cos(1.7*t + 0.1)"],
        reward: "-(1*(x - 0.3*sin(1.7*t + 0.1))^2 + 0.1*(x' - 0.3*1.7*cos(1.7*t + 0.1))^2 + 0.01*u^2)",
        terminated: &["x - 0.3*sin(1.7*t + 0.1) > 1.2", "x - 0.3*sin(1.7*t + 0.1) < -1.2"],
    },
];

/// The settings that differ between the runs of a case.
#[derive(Clone, Copy, Debug)]
pub(super) struct Setting {
    method: Method,
    substeps: u32,
    delays: Delays,
    saturation: f64,
    noise: f64,
    autoreset: Autoreset,
    limit: Option<u32>,
    pub(super) environments: usize,
}

pub(super) const SETTINGS: [Setting; 4] = [
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
    pub(super) fn settings(&self, setting: &Setting) -> EnvironmentSettings {
        let law = |scale: f64| Jitter::Gaussian(scale * setting.noise);
        let system = AnySystem::build(self.system.0, self.system.1).unwrap();
        let task = CatalogueTask::new(system, self.actuation, self.task).unwrap();
        let mut settings = EnvironmentSettings::of_catalogue(task, setting.method, 0.02);
        settings.definition = ProgramEnvironment {
            substeps: setting.substeps,
            start: vec![[-1.0, 1.0], [-0.5, 0.5]],
            limit: setting.limit,
            autoreset: setting.autoreset,
            delays: setting.delays,
            saturation: vec![setting.saturation.into()],
            jitter: law(2.0),
            skew: law(0.5),
            noise: vec![law(1.0); self.observe.len()],
            ..settings.definition
        };
        settings
    }

    pub(super) fn by_program(&self, setting: &Setting) -> ProgramEnvironment {
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
            ..TaskDefinitions::default()
        };
        let task = TaskPrograms::new(&task, &definitions, &equations).unwrap();
        let dynamics = equations.dynamics().clone();
        ProgramEnvironment { dynamics, task, ..self.settings(setting).definition }
    }
}
