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
    /// The distance from the start of the search, over coordinates and states of first order.
    pub distance: f64,
    /// The same as a part of the largest of these numbers at both.
    pub relative_distance: f64,
    /// The dimension of the set of equilibria near this one; 0 if it is isolated.
    pub continuum: usize,
    /// The number of directions in which the linearisation is zero, without other equilibria: it decides nothing there.
    pub undecided: usize,
    /// The weighted sums of states that the motion from the start of a file conserves.
    pub conserved: Vec<ConservedValue>,
    /// Whether the accelerations have no kinks and jumps.
    #[serde(rename = "smooth")]
    pub is_smooth: bool,
}

/// A sum that the motion conserves.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ConservedValue {
    /// The sum, as `a + 2 b`.
    pub sum: String,
    /// Its value at the start.
    pub start: f64,
    /// Its value at the operating point.
    pub value: f64,
    /// Whether both are equal to rounding, so that the motion may come near this point.
    pub equal: bool,
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

    /// Whether the distance from the start of the search is more than rounding.
    fn is_apart(&self) -> bool {
        self.relative_distance > 1e-6
    }

    /// The place in words: `a = 1, b = 0, 0.1 away from the start`, with at most six values.
    pub fn place(&self) -> String {
        let mut values: Vec<String> = self.states.iter().take(MOST).map(assignment).collect();
        if self.states.len() > MOST {
            values.push(format!("… ({} values)", self.states.len()));
        }
        if self.is_apart() {
            values.push(format!("{} away from the start", digits(self.distance, 3)));
        }
        values.join(", ")
    }

    /// Reasons for which the modes may not be those of the motion: a continuum, a direction without a linearisation, and conserved sums.
    /// Empty without any.
    pub fn remarks(&self) -> String {
        let mut remarks = Vec::new();
        if self.continuum > 0 {
            remarks.push(format!(
                "Equilibria form a continuum of {} there.",
                counted(self.continuum, "dimension")
            ));
        }
        if self.undecided > 0 {
            remarks.push(format!(
                "The linearisation is zero in {} and decides nothing there.",
                counted(self.undecided, "direction")
            ));
        }
        for ConservedValue { sum, start, value, equal } in &self.conserved {
            if !equal {
                let [start, value] = [*start, *value].map(seven_digits);
                remarks.push(format!(
                    "The motion does not reach this point: it conserves {sum}, which is {start} at the start and {value} here."
                ));
            }
        }
        remarks.join(" ")
    }

    /// The operating point in sentences, with its remarks.
    pub fn sentence(&self) -> String {
        format!("{} {}", self.location(), self.remarks()).trim_end().to_owned()
    }

    /// The operating point in sentences that say where it is.
    pub fn location(&self) -> String {
        let residual = match self.residual == 0.0 {
            true => String::new(),
            false => format!(", with an acceleration of {:.1e}", self.residual),
        };
        let list = |values: &[OperatingValue]| {
            values.iter().map(assignment).collect::<Vec<_>>().join(", ")
        };
        let distance = match self.is_apart() {
            true => format!(", {} away from the start", digits(self.distance, 3)),
            false => String::new(),
        };
        let kinks = match self.is_smooth {
            true => "",
            false => {
                " Its equations have kinks or jumps: the linearisation does not hold at or beyond them."
            }
        };
        // An acceleration that was added to a system without inputs is zero wherever it rests.
        let is_input =
            |command: &OperatingValue| !(command.name.ends_with(ADDED) && command.value == 0.0);
        let commands: Vec<OperatingValue> =
            self.commands.iter().filter(|own| is_input(own)).cloned().collect();
        let under =
            if commands.is_empty() { String::new() } else { format!(" under {}", list(&commands)) };
        format!(
            "The plant is the system {} linearised at {}{under}{residual}{distance}.{kinks}",
            self.system,
            list(&self.states),
        )
    }
}

/// The end of the name of an acceleration that was added as an input.
pub(super) const ADDED: &str = " added";

/// Largest number of values in a sentence about modes.
const MOST: usize = 6;

fn assignment(OperatingValue { name, value, unit }: &OperatingValue) -> String {
    format!("{name} = {} {unit}", seven_digits(*value)).trim_end().to_owned()
}

fn counted(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

/// A number with seven digits, and an exponent if it is small or large.
fn seven_digits(x: f64) -> String {
    digits(x, 7)
}

fn digits(x: f64, count: usize) -> String {
    let rounded: f64 = format!("{x:.*e}", count - 1).parse().unwrap_or(x);
    let text = format!("{rounded:?}");
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}
