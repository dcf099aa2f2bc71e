//! Tables of PID controllers of linear plants.

use libration::analysis::LinearController;
use libration::control::controller::{Pid, PidGains};
use libration::linear::{ClockedController, DiscreteController, LinearPlant, Matrix};
use serde::Deserialize;

use super::design::{Design, by_outputs};
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
    #[serde(default = "zero", deserialize_with = "crate::duration::number")]
    filter: Number,
}

pub(super) fn zero() -> Number {
    Number(0.0)
}

/// `proportional`, `integral`, `derivative` and `filter` of a PID controller.
#[derive(Clone, Copy)]
pub(super) struct Gains(pub(super) [Number; 4]);

/// A PID controller in its channel.
pub(super) struct PidChannel {
    /// The measurements whose sum it holds at zero, with their factors.
    pub(super) measured: Vec<(usize, f64)>,
    /// The number of its command.
    pub(super) command: usize,
    pub(super) gains: Gains,
}

impl Gains {
    /// The gains in words.
    pub(super) fn describe(self) -> String {
        let Gains([Number(kp), Number(ki), Number(kd), Number(filter)]) = self;
        format!("K_p = {kp}, K_i = {ki}, K_d = {kd}, filter {filter} s")
    }

    /// The controller from one measurement to one command, which runs every `period` seconds.
    fn controller(self, period: f64) -> Result<DiscreteController, String> {
        let Gains([Number(proportional), Number(integral), Number(derivative), Number(filter)]) =
            self;
        let gains = PidGains {
            proportional,
            integral,
            derivative,
            filter,
            most: f64::INFINITY,
            tracking: 1.0,
            target: [0.0],
        };
        let pid = Pid::<1>::new(gains).map_err(|error| error.to_string())?;
        let linear = LinearController::of(&pid, period).map_err(|error| error.to_string())?;
        let DiscreteController { a, b, c, d } = linear.discrete();
        // The first measurement of a PID controller is the position.
        let b = b.block((0, 0), (b.rows(), 1));
        Ok(DiscreteController { a, b, c, d: d.block((0, 0), (1, 1)) })
    }
}

/// PID controllers side by side, from so many measurements to so many commands.
///
/// # Errors
/// The error of a gain in words.
pub(super) fn side_by_side(
    channels: &[PidChannel],
    [measurements, commands]: [usize; 2],
    period: f64,
) -> Result<DiscreteController, String> {
    let parts = channels.iter().map(|channel| channel.gains.controller(period));
    let parts = parts.collect::<Result<Vec<_>, _>>()?;
    let memory = parts.iter().map(DiscreteController::memory).sum();
    let mut controller = DiscreteController {
        a: Matrix::zeros(memory, memory),
        b: Matrix::zeros(memory, measurements),
        c: Matrix::zeros(commands, memory),
        d: Matrix::zeros(commands, measurements),
    };
    let mut first = 0;
    for (PidChannel { measured, command, .. }, own) in channels.iter().zip(parts) {
        controller.a.set_block((first, first), &own.a);
        for &(j, factor) in measured {
            controller.b.set_block((first, j), &own.b.scaled(factor));
            controller.d[(*command, j)] += factor * own.d[(0, 0)];
        }
        controller.c.set_block((*command, first), &own.c);
        first += own.memory();
    }
    Ok(controller)
}

/// PID controllers, each from an output to an input.
pub(super) fn pid(tables: &[PidTable], plant: &LinearPlant, period: f64) -> Result<Design, Fault> {
    let wrong = |message: String| Fault::new("controller.pid", message);
    if tables.is_empty() {
        return Err(wrong("there is no PID controller; expected at least one".into()));
    }
    let mut channels = Vec::new();
    let mut description = Vec::new();
    for table in tables {
        let key = |fault: Fault| Fault { key: "controller.pid".into(), ..fault };
        let output = find("outputs", &table.output, &plant.outputs).map_err(key)?;
        let command = find("inputs", &table.input, &plant.inputs).map_err(key)?;
        let gains = Gains([table.proportional, table.integral, table.derivative, table.filter]);
        let words = gains.describe();
        description.push(format!("from `{}` to `{}` {words}", table.output, table.input));
        channels.push(PidChannel { measured: vec![(output, 1.0)], command, gains });
    }
    let shape = [plant.outputs.len(), plant.inputs.len()];
    let controller = side_by_side(&channels, shape, period).map_err(wrong)?;
    side_by_side(&channels, shape, ClockedController::LEAST * period).map_err(wrong)?;
    let nominal = controller.clone();
    // Without limits it is linear in every period: the gains are checked above.
    let of_length =
        move |seconds| side_by_side(&channels, shape, seconds).unwrap_or_else(|_| nominal.clone());
    let clocked = Some(ClockedController::new(period, of_length));
    let description = format!("PID {}", description.join("; "));
    Ok(Design { clocked, ..by_outputs(plant, controller.into(), description) })
}
