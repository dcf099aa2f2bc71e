//! A redesigned controller as tables of a request file.

use libration::linear::{CostWeights, DiscreteController, LinearPlant, Matrix};
use libration_settings::linear_loop::{Design, LinearLoopTable};

/// What a request file needs besides the matrices of another controller.
#[derive(Clone, Debug)]
pub(super) struct RedesignToml {
    /// Whether the request has weights of a cost.
    pub(super) has_weights: bool,
    /// Whether the controller measures the states and not the outputs.
    measures_states: bool,
    /// The keys of `[loop]` whose values come from the given controller.
    loop_lines: Vec<String>,
}

impl RedesignToml {
    /// Of a request with this design of its controller.
    pub(super) fn new(
        table: &LinearLoopTable,
        plant: &LinearPlant,
        design: &Design,
        weights: &CostWeights,
        noise: &[f64],
    ) -> Self {
        let CostWeights { states, inputs } = weights;
        let cost = format!(
            "cost = {{ states = {}, inputs = {} }}",
            weights_of(states),
            weights_of(inputs)
        );
        let noisy = noise.iter().any(|variance| *variance != 0.0);
        let lines = [
            (table.cost.is_none(), cost),
            (table.measurement_noise.is_none() && noisy, format!("measurement-noise = {noise:?}")),
        ];
        RedesignToml {
            has_weights: table.cost.is_some() || design.weights.is_some(),
            measures_states: design.plant != *plant,
            loop_lines: lines.into_iter().filter(|(given, _)| *given).map(|line| line.1).collect(),
        }
    }

    /// Lines for `[loop]`, and the table that replaces `[controller]`.
    pub(super) fn table(&self, controller: &DiscreteController) -> String {
        let DiscreteController { a, b, c, d } = controller;
        let mut text = String::new();
        if !self.loop_lines.is_empty() {
            text +=
                "# These lines belong to [loop]: they were part of the design that is replaced.\n";
        }
        for line in &self.loop_lines {
            text += &format!("{line}\n");
        }
        text += "[controller.state-space]\n";
        if self.measures_states {
            text += "measures = \"states\"\n";
        }
        for (name, matrix) in [("a", a), ("b", b), ("c", c), ("d", d)] {
            if !matrix.entries().is_empty() {
                text += &format!("{name} = {}\n", rows(matrix));
            }
        }
        text
    }
}

fn rows(matrix: &Matrix) -> String {
    let rows: Vec<&[f64]> = (0..matrix.rows()).map(|i| matrix.row(i)).collect();
    format!("{rows:?}")
}

/// A symmetric matrix, or its diagonal if that is all.
fn weights_of(matrix: &Matrix) -> String {
    let entries: Vec<f64> = (0..matrix.rows()).map(|i| matrix[(i, i)]).collect();
    match *matrix == Matrix::diagonal(&entries) {
        true => format!("{entries:?}"),
        false => rows(matrix),
    }
}
