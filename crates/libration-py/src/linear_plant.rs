//! Linear plants by the keys of a plant file.

use libration::linear::{LinearPlant, Matrix, Signal};
use libration_settings::linear_loop::parse_plant;
use pyo3::prelude::*;

use crate::error::{Raised, value_error};

/// Names and units of states, inputs and outputs.
pub(crate) type Names = [Vec<(String, String)>; 3];

/// The rows of a matrix.
pub(crate) type Rows = Vec<Vec<f64>>;

/// Returns the matrices A, B, C, D and G, and the names and units, of the plant that the text of a plant file describes.
#[pyfunction]
pub(crate) fn _linear_plant(text: &str) -> PyResult<([Rows; 5], Names)> {
    let table = parse_plant(text, "plant.toml").map_err(Raised::raised)?;
    let plant = table.plant().map_err(|fault| value_error(fault.to_string()))?;
    let matrices = [&plant.a, &plant.b, &plant.c, &plant.d, &plant.g];
    let names = names(&plant);
    Ok((matrices.map(rows), names))
}

/// Returns the names and units of a plant.
pub(crate) fn names(plant: &LinearPlant) -> Names {
    [&plant.states, &plant.inputs, &plant.outputs].map(|signals| {
        signals.iter().map(|Signal { name, unit }| (name.clone(), unit.clone())).collect()
    })
}

pub(crate) fn rows(matrix: &Matrix) -> Rows {
    (0..matrix.rows()).map(|i| matrix.row(i).to_vec()).collect()
}
