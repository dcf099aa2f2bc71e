//! The studies of a system of equations.

use libration_analyze::SystemSummary;
use libration_settings::equations::EquationSystem;
use libration_settings::linear_loop::linearised_equations;
use libration_settings::{ConfigCommand, live_settings};
use libration_study::{Config, Effort, Study};
use libration_study_batch::SystemDeterminism;
use libration_study_motion::{Convergence, Nonlinear, Problem, SystemPrecision, SystemStability};
use serde::Serialize;

use crate::STUDIES;
use crate::results::StudiedSystem;

/// A study that does not apply to a system.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct NotApplicable {
    /// The name of the study.
    pub study: &'static str,
    /// The reason.
    pub because: String,
}

impl NotApplicable {
    /// The study, the system by its name or file, and the reason.
    pub fn sentence(&self, system: &str) -> String {
        let NotApplicable { study, because } = self;
        format!("the study `{study}` does not apply to `{system}`: {because}")
    }
}

/// The studies of a system of equations, in the order of the report, and those that do not apply to it.
pub struct SystemStudies<'a> {
    /// The system.
    pub system: &'a EquationSystem,
    /// The problem that the studies solve.
    pub problem: &'a Problem,
    /// The command that runs them, as the report shows it.
    pub command: String,
    /// The options that name the system to any command: `--system FILE` and its parameters.
    pub options: String,
    /// The studies that apply.
    pub studies: Vec<Box<dyn Study + 'a>>,
    /// The others, with reasons.
    pub not_applicable: Vec<NotApplicable>,
}

/// The studies of systems of equations, in the order of the report. The answer of the last one leads it.
const ORDER: [&str; 5] = ["determinism", "precision", "convergence", "nonlinear", "stability"];

/// The option of a system in the actions of studies.
pub(crate) const SYSTEM_OPTION: &str = "--system FILE";

/// The most that a reference orbit may be off, as a part of its size: far below any error that is taken against it.
const REFERENCE: f64 = 1e-20;

/// Why the reference orbit is none.
const NO_REFERENCE: &str = "the reference orbit from the start does not stay finite for three quarters of a turn: the motion does not, or it is too stiff";

/// The change of a conserved energy over the reference orbit, as a part of the energy: its rounding, and no friction.
const CONSERVED: f64 = 1e-12;

impl<'a> SystemStudies<'a> {
    /// Those of a system, with the problem that [`Problem::of_equations`] makes of it.
    pub fn new(system: &'a EquationSystem, problem: &'a Problem) -> Self {
        let command = "libration lab --system FILE".to_owned();
        let options = SYSTEM_OPTION.to_owned();
        let (studies, not_applicable) = (Vec::new(), Vec::new());
        let mut all = SystemStudies { system, problem, command, options, studies, not_applicable };
        let has_own = |study: &&&dyn Study| ORDER.contains(&study.name());
        let own = ORDER.iter().filter_map(|name| STUDIES.by_name(name));
        for study in own.chain(STUDIES.studies.iter().filter(|study| !has_own(study)).copied()) {
            let name = study.name();
            match study_of(name, system, problem) {
                Ok(study) => all.studies.push(study),
                Err(because) => all.not_applicable.push(NotApplicable { study: name, because }),
            }
        }
        all
    }

    /// With the command that runs them: on a file, with other values of some parameters.
    #[must_use]
    pub fn with_command(self, file: &str, set: &[(String, f64)], effort: Option<Effort>) -> Self {
        let file = shlex::try_quote(file).unwrap_or_default();
        let set = set.iter().map(|(name, value)| format!(" --set {name}={value:?}"));
        let options = format!("--system {file}{}", set.collect::<String>());
        let effort = effort.map(|effort| format!(" --effort {}", effort.name()));
        let command = format!("libration lab {options}{}", effort.unwrap_or_default());
        SystemStudies { command, options, ..self }
    }

    /// The system as results show it.
    pub(crate) fn studied(&self) -> StudiedSystem {
        let summary = SystemSummary::new(self.system);
        StudiedSystem {
            summary,
            turn: self.problem.turn(),
            study_count: self.studies.len(),
            options: self.options.clone(),
            live: live_settings::of_system(self.system),
        }
    }

    /// The studies that a configuration names, in its order, or all if it names none; and the configuration with nothing but what they use.
    ///
    /// # Errors
    /// The first that does not apply.
    pub fn configured(
        &self,
        mut config: Config,
    ) -> Result<(Vec<&dyn Study>, Config), &NotApplicable> {
        let studies = self.named(&config.studies)?;
        config.system = Some(self.system.name.clone());
        config.studies = studies.iter().map(|study| study.name().to_owned()).collect();
        let has_settings = studies.iter().filter(|study| study.settings().is_some());
        config.settings.keep(&has_settings.map(|study| study.name()).collect::<Vec<_>>());
        Ok((studies, config))
    }

    /// Why a key of a configuration has no effect on these studies, such as `drift` or `convergence.systems`; none if it has one.
    pub fn reason_without_effect(&self, key: &str) -> Option<String> {
        let name = &self.system.name;
        let (table, inner) = key.split_once('.').unwrap_or((key, ""));
        if ["system", "start"].contains(&table) || inner == "systems" {
            return Some(format!("the system `{name}` takes its place"));
        }
        if let Some(other) = self.not_applicable.iter().find(|other| other.study == table) {
            return Some(other.sentence(name));
        }
        if !ConfigCommand::LAB.keys.contains(&table) {
            return ConfigCommand::reader_of(table)
                .map(|reader| format!("`{}` reads it, and `lab` does not", reader.name));
        }
        let own = self.studies.iter().find(|study| study.name() == table)?;
        let without = || format!("the study `{table}` of a system by equations has no settings");
        own.settings().is_none().then(without)
    }

    /// The studies of these names, in their order; all for none.
    fn named(&self, names: &[String]) -> Result<Vec<&dyn Study>, &NotApplicable> {
        if names.is_empty() {
            return Ok(self.studies.iter().map(AsRef::as_ref).collect());
        }
        let mut chosen: Vec<&dyn Study> = Vec::new();
        for name in names {
            if let Some(missing) = self.not_applicable.iter().find(|other| other.study == name) {
                return Err(missing);
            }
            let studies = self.studies.iter().map(AsRef::as_ref);
            chosen.extend(studies.filter(|study: &&dyn Study| study.name() == name));
        }
        Ok(chosen)
    }
}

/// The study of a name for a system.
///
/// # Errors
/// The reason why it does not apply.
fn study_of<'a>(
    name: &str,
    system: &'a EquationSystem,
    problem: &'a Problem,
) -> Result<Box<dyn Study + 'a>, String> {
    let own = std::slice::from_ref(problem);
    match name {
        "stability" => has_modes(system, problem)
            .map(|()| Box::new(SystemStability::new(system, problem.turn())) as _),
        "convergence" => has_orbit(system, problem).map(|()| Box::new(Convergence::of(own)) as _),
        "nonlinear" => keeps_energy(system, problem).map(|()| Box::new(Nonlinear::of(own)) as _),
        "precision" => stays_finite(problem).map(|()| Box::new(SystemPrecision::new(problem)) as _),
        "determinism" => Ok(Box::new(SystemDeterminism::new(system, problem.turn()))),
        name => Err(reason(name).to_owned()),
    }
}

/// Why a study applies to no system of equations.
fn reason(study: &str) -> &'static str {
    match study {
        "spectrum" => {
            "its predictions are those of harmonic motion; `stability` has the modes of this system and of its steps"
        }
        "drift" => {
            "its predictions are those of harmonic motion; `nonlinear` has the energy of this system, if the file has one"
        }
        "error" => {
            "its predictions are those of harmonic motion; `convergence` has the errors of this system"
        }
        "efficiency" => {
            "its costs are those of harmonic motion; `libration analyze --system FILE` counts the operations of a step of this system"
        }
        "adaptive" => {
            "its predictions are those of an ellipse; `libration simulate --system FILE --adaptive integrating` has such steps of this system"
        }
        "latency" | "jitter" | "asynchrony" | "hierarchy" => {
            "about control loops: `libration advise --plant FILE` has the budget of a loop around this system"
        }
        "throughput" | "memory" => "measures this machine, not a system: `libration bench`",
        "rollout" => "measures environments of the catalogue: `libration bench --rollouts`",
        "storage" => {
            "measures the storage of this machine, not a system: `libration bench --storage`"
        }
        _ => "not for systems of equations",
    }
}

/// Whether there is an equilibrium at which the equations have a linear part.
fn has_modes(system: &EquationSystem, problem: &Problem) -> Result<(), String> {
    let (plant, _) = linearised_equations(system).map_err(|fault| fault.message)?;
    if !plant.a.entries().iter().all(|x| x.is_finite()) {
        return Err("at the equilibrium a derivative of the equations is not finite".to_owned());
    }
    match problem.has_linear_part(&plant.a) {
        true => Ok(()),
        false => Err("at the equilibrium the equations have no linear part".to_owned()),
    }
}

/// Whether the orbit from the start has a reference.
fn has_orbit(system: &EquationSystem, problem: &Problem) -> Result<(), String> {
    moves(problem)?;
    if !system.equations.dynamics().accelerations().is_smooth() {
        return Err(
            "the equations have kinks or jumps, beyond which no method has an order".to_owned()
        );
    }
    match problem.reference_error() {
        error if error <= REFERENCE => Ok(()),
        error if error.is_nan() => Err(NO_REFERENCE.to_owned()),
        error => {
            Err(format!("the exact orbit from the start is known to {error:.0e} of its size only"))
        }
    }
}

/// Whether the motion keeps an energy.
fn keeps_energy(system: &EquationSystem, problem: &Problem) -> Result<(), String> {
    has_orbit(system, problem)?;
    match problem.energy_change_of_flow() {
        None => Err("the file has no `energy`".to_owned()),
        Some(change) if change <= CONSERVED => Ok(()),
        Some(change) if change.is_nan() => {
            Err("the `energy` is not finite along the motion".to_owned())
        }
        Some(change) => Err(format!(
            "the motion does not conserve the `energy`: it changes by {change:.1e} of its size over three quarters of a turn"
        )),
    }
}

fn stays_finite(problem: &Problem) -> Result<(), String> {
    moves(problem)?;
    match problem.reference_error().is_nan() {
        true => Err(NO_REFERENCE.to_owned()),
        false => Ok(()),
    }
}

fn moves(problem: &Problem) -> Result<(), String> {
    match problem.rests_at_start() {
        true => Err("nothing moves from the start, which is an equilibrium".to_owned()),
        false => Ok(()),
    }
}
