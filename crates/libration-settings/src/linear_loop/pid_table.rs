//! Tables of PID controllers of linear plants.

use libration::analysis::LinearController;
use libration::control::controller::{Pid, PidGains};
use libration::linear::{DiscreteController, LinearPlant, Matrix};
use serde::Deserialize;

use super::Design;
use super::controller_table::by_outputs;
use super::part_table::find;
use crate::{Fault, Number};

/// A PID controller from an output to an input, which holds the output at zero.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct PidTable {
    output: String,
    input: String,
    proportional: Number,
    #[serde(default = "zero")]
    integral: Number,
    #[serde(default = "zero")]
    derivative: Number,
    #[serde(default = "zero")]
    filter: Number,
}

fn zero() -> Number {
    Number(0.0)
}

/// PID controllers, each from an output to an input.
pub(super) fn pid(tables: &[PidTable], plant: &LinearPlant, period: f64) -> Result<Design, Fault> {
    let wrong = |message: String| Fault::new("controller.pid", message);
    if tables.is_empty() {
        return Err(wrong("there is no PID controller; expected at least one".into()));
    }
    let (m, p) = (plant.inputs.len(), plant.outputs.len());
    let mut parts = Vec::new();
    let mut description = Vec::new();
    for table in tables {
        let key = |fault: Fault| Fault { key: "controller.pid", ..fault };
        let output = find("outputs", &table.output, &plant.outputs).map_err(key)?;
        let input = find("inputs", &table.input, &plant.inputs).map_err(key)?;
        let gains = PidGains {
            proportional: table.proportional.0,
            integral: table.integral.0,
            derivative: table.derivative.0,
            filter: table.filter.0,
            most: f64::INFINITY,
            tracking: 1.0,
            target: [0.0],
        };
        let pid = Pid::<1>::new(gains).map_err(|error| wrong(error.to_string()))?;
        let linear =
            LinearController::of(&pid, period).map_err(|error| wrong(error.to_string()))?;
        parts.push((output, input, linear.discrete()));
        description.push(format!(
            "from `{}` to `{}` K_p = {}, K_i = {}, K_d = {}, filter {} s",
            table.output,
            table.input,
            table.proportional.0,
            table.integral.0,
            table.derivative.0,
            table.filter.0
        ));
    }
    let memory = parts.iter().map(|(_, _, own)| own.memory()).sum();
    let mut controller = DiscreteController {
        a: Matrix::zeros(memory, memory),
        b: Matrix::zeros(memory, p),
        c: Matrix::zeros(m, memory),
        d: Matrix::zeros(m, p),
    };
    let mut first = 0;
    for (output, input, own) in parts {
        let count = own.memory();
        controller.a.set_block((first, first), &own.a);
        // The first measurement of a PID controller is the position.
        controller.b.set_block((first, output), &own.b.block((0, 0), (count, 1)));
        controller.c.set_block((input, first), &own.c);
        controller.d[(input, output)] += own.d[(0, 0)];
        first += count;
    }
    Ok(by_outputs(plant, controller, format!("PID {}", description.join("; "))))
}
