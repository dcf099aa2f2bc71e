//! Environments of the catalogue by programs.

use libration::equations::{Definitions, Dynamics, Equations, TaskDefinitions, TaskPrograms};
use libration::rl::ProgramEnvironment;
use libration::rl::task::{Regulate, Sine, SwingUp, Track};
use libration::with_system;

use super::{EnvironmentSettings, Task};

/// A task on one degree of freedom `q` under a command `u`, with its parameters.
struct NamedTask {
    parameters: Vec<(&'static str, f64)>,
    definitions: TaskDefinitions,
}

impl EnvironmentSettings {
    /// The environments by programs, with the bits of the compiled ones.
    pub(super) fn by_program(&self) -> ProgramEnvironment {
        let mobility = self.actuation.mass().recip();
        let dynamics = with_system!(
            self.system.any(),
            1,
            |model, D| Dynamics::of::<D>(&model, Some(mobility)),
            unreachable!("the system has one degree of freedom")
        );
        let task = NamedTask::new(&self.task).programs();
        let noise = vec![self.noise.observation; task.observation.outputs().len()];
        ProgramEnvironment {
            substeps: self.substeps,
            start: self.start.to_vec(),
            limit: self.limit,
            autoreset: self.autoreset,
            delays: self.delays,
            saturation: vec![self.saturation.into()],
            skew: self.noise.skew,
            jitter: self.noise.jitter,
            noise,
            ..ProgramEnvironment::new(dynamics, task, self.method, self.dt)
        }
    }
}

impl NamedTask {
    fn new(task: &Task) -> Self {
        match *task {
            Task::Regulate(regulate) => NamedTask::regulate(regulate, "q", "q'", &[]),
            Task::SwingUp(SwingUp { velocity, effort }) => NamedTask {
                parameters: vec![("velocity", velocity), ("effort", effort)],
                definitions: TaskDefinitions {
                    observe: ["-cos(q)", "-sin(q)", "q'"].map(str::to_owned).into(),
                    reward: "-cos(before(q)) - 1 - velocity*before(q')^2 - effort*u^2".to_owned(),
                    ..TaskDefinitions::default()
                },
            },
            Task::Track(Track { reference, regulate }) => {
                let Sine { amplitude, angular_frequency, phase } = reference;
                let [q, v] =
                    ["amplitude*sin(omega*t + phase)", "amplitude*omega*cos(omega*t + phase)"];
                let (from_q, from_v) = (format!("(q - {q})"), format!("(q' - {v})"));
                let mut task = NamedTask::regulate(regulate, &from_q, &from_v, &[q, v]);
                task.parameters.extend([
                    ("amplitude", amplitude),
                    ("omega", angular_frequency),
                    ("phase", phase),
                ]);
                task
            }
        }
    }

    /// The regulation of `q` and `v`, with other observations besides position and velocity. An infinite bound is none.
    fn regulate(regulate: Regulate, q: &str, v: &str, others: &[&str]) -> Self {
        let Regulate { position, velocity, effort, bound } = regulate;
        let mut parameters =
            vec![("position", position), ("velocity", velocity), ("effort", effort)];
        let mut terminated = Vec::new();
        if bound.is_finite() {
            parameters.push(("bound", bound));
            terminated = vec![format!("{q} > bound"), format!("{q} < -bound")];
        }
        let observe = ["q", "q'"].iter().chain(others).map(|&text| text.to_owned());
        let definitions = TaskDefinitions {
            observe: observe.collect(),
            reward: format!("-(position*{q}^2 + velocity*{v}^2 + effort*u^2)"),
            terminated,
            ..TaskDefinitions::default()
        };
        NamedTask { parameters, definitions }
    }

    fn programs(&self) -> TaskPrograms {
        // The acceleration only makes a system of the names; it is not used.
        let system = Definitions {
            coordinates: vec!["q".to_owned()],
            accelerations: vec![("q".to_owned(), "u".to_owned())],
            parameters: self.parameters.iter().map(|&(name, x)| (name.to_owned(), x)).collect(),
            inputs: vec!["u".to_owned()],
            ..Definitions::default()
        };
        Equations::new(&system)
            .and_then(|equations| TaskPrograms::new(&self.definitions, &system, &equations))
            .expect("all names of the tasks are defined")
    }
}
