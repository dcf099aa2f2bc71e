//! Tables of controllers in state space.

use libration::linear::{DiscreteController, LinearPlant, Matrix};
use serde::Deserialize;

use super::design::{Design, by_outputs};
use super::plant_table::{Rows, matrix};
use crate::{Fault, suggestions};

/// A controller in state space.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct StateSpaceTable {
    /// `outputs` (default) or `states`.
    #[serde(default)]
    measures: Option<String>,
    #[serde(default)]
    a: Rows,
    #[serde(default)]
    b: Rows,
    #[serde(default)]
    c: Rows,
    d: Rows,
}

impl StateSpaceTable {
    /// `u = D y`.
    pub(super) fn of_gain(d: Rows) -> Self {
        StateSpaceTable { measures: None, a: Vec::new(), b: Vec::new(), c: Vec::new(), d }
    }

    pub(super) fn design(&self, plant: &LinearPlant) -> Result<Design, Fault> {
        let key = |name: &str| match name {
            "a" => "controller.state-space.a",
            "b" => "controller.state-space.b",
            "c" => "controller.state-space.c",
            _ => "controller.state-space.d",
        };
        let plant = match self.measures.as_deref() {
            None | Some("outputs") => plant.clone(),
            Some("states") => plant.clone().with_all_states_measured(),
            Some(other) => {
                let message = format!("unknown value `{other}` of `measures`");
                let help = suggestions::suggest("values", other, ["outputs", "states"]);
                return Err(Fault::new("controller.state-space.measures", message).help(help));
            }
        };
        let shape = [plant.inputs.len(), plant.outputs.len()];
        let controller = self.controller(key, shape, ["inputs", "outputs"])?;
        let memory = self.a.len();
        Ok(by_outputs(&plant, controller.into(), format!("a controller of {memory} states")))
    }

    /// The number of its commands.
    pub(super) fn commands(&self) -> usize {
        self.d.len()
    }

    /// The controller of so many commands and measurements, which are the `sides`. `key` has the key of a matrix.
    pub(super) fn controller(
        &self,
        key: impl Fn(&str) -> &'static str,
        [commands, measurements]: [usize; 2],
        [to, from]: [&str; 2],
    ) -> Result<DiscreteController, Fault> {
        let of = |name: &str, rows: &Rows, shape: [usize; 2], side: String| {
            let found = match rows.is_empty() {
                true => Matrix::zeros(shape[0], shape[1]),
                false => matrix(key(name), rows)?,
            };
            match [found.rows(), found.columns()] == shape {
                true => Ok(found),
                false => {
                    let (rows, columns) = (found.rows(), found.columns());
                    let [wanted, of_each] = shape;
                    let message = format!(
                        "`{name}` is {rows} × {columns}; expected {wanted} × {of_each}: {side}"
                    );
                    Err(Fault::new(key(name), message))
                }
            }
        };
        let memory = self.a.len();
        Ok(DiscreteController {
            a: of("a", &self.a, [memory; 2], "memory × memory".into())?,
            b: of("b", &self.b, [memory, measurements], format!("memory × {from}"))?,
            c: of("c", &self.c, [commands, memory], format!("{to} × memory"))?,
            d: of("d", &self.d, [commands, measurements], format!("{to} × {from}"))?,
        })
    }
}
