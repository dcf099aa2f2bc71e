//! Environments of systems by equations.

use libration::rl::ProgramEnvironment;
use libration_settings::equations::{EquationSystem, EquationTask};

/// Environments of a system by equations, with what is known of them.
#[derive(Clone, Debug, PartialEq)]
pub struct EquationEnvironment {
    /// The system.
    pub system: EquationSystem,
    /// The text of its file.
    pub text: String,
    /// Other values of some of its parameters.
    pub parameters: Vec<(String, f64)>,
    /// The task.
    pub task: EquationTask,
    /// The environments.
    pub definition: ProgramEnvironment,
}

impl EquationEnvironment {
    /// Names and units of the observations; `"1"` where no unit is known.
    pub fn observed(&self) -> Vec<(String, String)> {
        named(&self.task.definitions.observe, &self.task.units)
    }

    /// Names and units of the actions; `"1"` where no unit is known.
    pub fn actions(&self) -> Vec<(String, String)> {
        match self.task.definitions.targets.as_slice() {
            [] => named(self.system.equations.inputs(), &self.system.input_units),
            targets => named(targets, &vec![String::new(); targets.len()]),
        }
    }
}

fn named(names: &[String], units: &[String]) -> Vec<(String, String)> {
    let unit = |unit: &String| if unit.is_empty() { "1".to_owned() } else { unit.clone() };
    names.iter().zip(units).map(|(name, own)| (name.clone(), unit(own))).collect()
}
