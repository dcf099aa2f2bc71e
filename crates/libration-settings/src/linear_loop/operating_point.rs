//! Operating points of linearised systems.

use libration::equations::Degree;
use serde::Serialize;

use crate::equations::EquationSystem;

/// The equilibrium at which a system is linearised.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OperatingPoint {
    /// The name of the system.
    pub system: String,
    /// The coordinates and states of first order; all velocities are zero.
    pub states: Vec<OperatingValue>,
    /// The constant commands.
    pub commands: Vec<OperatingValue>,
    /// The largest absolute acceleration that is left, in units of coordinates per squared unit of time.
    pub residual: f64,
    /// Whether the accelerations have no kinks and jumps.
    #[serde(rename = "smooth")]
    pub is_smooth: bool,
}

/// A value at an operating point.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OperatingValue {
    /// The name.
    pub name: String,
    /// The value.
    pub value: f64,
    /// The unit; empty without one.
    pub unit: String,
}

impl OperatingPoint {
    /// Positions, velocities and inputs of a system of equations at this point.
    pub fn state_of(&self, system: &EquationSystem) -> Vec<f64> {
        let degrees = system.equations.degrees();
        let mut state = vec![0.0; 2 * degrees.len()];
        for ((i, degree), value) in degrees.iter().enumerate().zip(&self.states) {
            let place = if matches!(degree, Degree::State(_)) { degrees.len() + i } else { i };
            state[place] = value.value;
        }
        // Inputs that were added are no inputs of the system.
        let inputs = self.commands.iter().take(system.equations.inputs().len());
        state.extend(inputs.map(|command| command.value));
        state
    }

    /// The operating point in a sentence.
    pub fn sentence(&self) -> String {
        let residual = match self.residual == 0.0 {
            true => String::new(),
            false => format!(", with an acceleration of {:.1e}", self.residual),
        };
        let list = |values: &[OperatingValue]| {
            let one = |OperatingValue { name, value, unit }: &OperatingValue| {
                format!("{name} = {} {unit}", seven_digits(*value)).trim_end().to_owned()
            };
            values.iter().map(one).collect::<Vec<_>>().join(", ")
        };
        let kinks = match self.is_smooth {
            true => "",
            false => {
                " Its equations have kinks or jumps: the linearisation does not hold at or beyond them."
            }
        };
        format!(
            "The plant is the system {} linearised at {} under {}{residual}.{kinks}",
            self.system,
            list(&self.states),
            list(&self.commands)
        )
    }
}

/// A number with seven digits, and an exponent if it is small or large.
fn seven_digits(x: f64) -> String {
    let rounded: f64 = format!("{x:.6e}").parse().unwrap_or(x);
    let text = format!("{rounded:?}");
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}
