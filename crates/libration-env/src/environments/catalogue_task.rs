//! Tasks of the engine on systems of the catalogue.

use libration::catalog::Actuation;
use libration::equations::{Definitions, Dynamics, Equations, TaskDefinitions, TaskPrograms};
use libration::rl::ProgramEnvironment;
use libration::rl::task::{Regulate, Sine, SwingUp, Track};
use libration::{AnySystem, Method, with_system};
use libration_settings::units;
use libration_settings::units::Units;

use super::Task;
use super::task::ObservedQuantity;

/// A task on a system of the catalogue with one degree of freedom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CatalogueTask {
    system: AnySystem,
    /// The quantity of actions.
    pub actuation: Actuation,
    /// The task: observations, rewards and termination.
    pub task: Task,
}

impl CatalogueTask {
    /// The task, if the system has one degree of freedom.
    pub fn new(system: AnySystem, actuation: Actuation, task: Task) -> Option<Self> {
        let is_single = *system.entry().dimensions.start() == 1;
        is_single.then_some(CatalogueTask { system, actuation, task })
    }

    /// The system.
    pub fn system(&self) -> AnySystem {
        self.system
    }

    /// The environments by programs, with the bits of compiled ones.
    pub(super) fn definition(&self, method: Method, dt: f64) -> ProgramEnvironment {
        let mobility = self.actuation.mass().recip();
        let dynamics = with_system!(
            self.system,
            1,
            |model, D| Dynamics::of::<D>(&model, Some(mobility)),
            unreachable!("the system has one degree of freedom")
        );
        ProgramEnvironment::new(dynamics, NamedTask::new(&self.task).programs(), method, dt)
    }

    /// Units of positions, velocities and actions.
    pub(super) fn units(&self) -> [&'static str; 3] {
        let Units { position, velocity, command, .. } = units::of(self.system, self.actuation);
        // The position of a swing-up is an angle, whatever the system.
        match (&self.task, self.actuation) {
            (Task::SwingUp(_), Actuation::Acceleration) => ["rad", "rad/s", "rad/s²"],
            (Task::SwingUp(_), Actuation::Force { .. }) => ["rad", "rad/s", "N·m"],
            _ => [position, velocity, command],
        }
    }

    /// Names and units of the observations.
    pub(super) fn observed(&self) -> Vec<(String, String)> {
        let [position, velocity, _] = self.units();
        let unit = |seen| match seen {
            ObservedQuantity::Position => position,
            ObservedQuantity::Velocity => velocity,
            ObservedQuantity::Dimensionless => "1",
        };
        let owned = |&(name, seen): &(&str, _)| (name.to_owned(), unit(seen).to_owned());
        self.task.observed().iter().map(owned).collect()
    }
}

/// The expressions of a task of the engine on one degree of freedom `q` under a command `u`; none without a task of that name. They have its
/// numbers as parameters.
pub fn task_expressions(name: &str) -> Option<TaskDefinitions> {
    let regulate = Regulate { position: 1.0, velocity: 1.0, effort: 1.0, bound: 1.0 };
    let reference = Sine { amplitude: 1.0, angular_frequency: 1.0, phase: 0.0 };
    let all = [
        Task::Regulate(regulate),
        Task::SwingUp(SwingUp { velocity: 1.0, effort: 1.0 }),
        Task::Track(Track { reference, regulate }),
    ];
    all.iter().find(|task| task.name() == name).map(|task| NamedTask::new(task).definitions)
}

/// A task on one degree of freedom `q` under a command `u`, with its parameters.
struct NamedTask {
    parameters: Vec<(&'static str, f64)>,
    definitions: TaskDefinitions,
}

impl NamedTask {
    fn new(task: &Task) -> Self {
        match *task {
            Task::Regulate(regulate) => NamedTask::regulate(regulate, "q", "q'", &[]),
            Task::SwingUp(SwingUp { velocity, effort }) => NamedTask {
                parameters: vec![("velocity_cost", velocity), ("effort_cost", effort)],
                definitions: TaskDefinitions {
                    observe: ["-cos(q)", "-sin(q)", "q'"].map(str::to_owned).into(),
                    reward: "-cos(before(q)) - 1 - velocity_cost*before(q')^2 - effort_cost*u^2"
                        .to_owned(),
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
            vec![("position_cost", position), ("velocity_cost", velocity), ("effort_cost", effort)];
        let mut terminated = Vec::new();
        if bound.is_finite() {
            parameters.push(("bound", bound));
            terminated = vec![format!("{q} > bound"), format!("{q} < -bound")];
        }
        let observe = ["q", "q'"].iter().chain(others).map(|&text| text.to_owned());
        let definitions = TaskDefinitions {
            observe: observe.collect(),
            reward: format!("-(position_cost*{q}^2 + velocity_cost*{v}^2 + effort_cost*u^2)"),
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
