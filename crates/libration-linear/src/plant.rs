//! Linear plants.

use thiserror::Error;

use crate::{Matrix, Signal};

/// A linear plant: `ẋ = Ax + Bu + Gw` and `y = Cx + Du` with white noise `w` of unit intensity.
///
/// A sampled plant has `x' = Ax + Bu + Gw` once per `sampling_period`, with `w` of unit variance.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearPlant {
    /// States × states.
    pub a: Matrix,
    /// States × inputs.
    pub b: Matrix,
    /// Outputs × states.
    pub c: Matrix,
    /// Outputs × inputs.
    pub d: Matrix,
    /// States × noises.
    pub g: Matrix,
    /// The period of a sampled plant, in s.
    pub sampling_period: Option<f64>,
    /// Whether integrators step some states as velocities that are no velocities: those of first order of a system by equations.
    pub has_first_order_states: bool,
    /// Names and units of the states.
    pub states: Vec<Signal>,
    /// Names and units of the inputs.
    pub inputs: Vec<Signal>,
    /// Names and units of the outputs.
    pub outputs: Vec<Signal>,
}

/// Error of a plant.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum PlantError {
    /// A matrix has the wrong shape.
    #[error("`{matrix}` is {rows} × {columns}; expected {expected}")]
    Shape {
        /// The name of the matrix.
        matrix: &'static str,
        /// Its rows.
        rows: usize,
        /// Its columns.
        columns: usize,
        /// The expected shape, in words.
        expected: String,
    },
    /// An entry is infinite or NaN.
    #[error(
        "`{matrix}` has the entry {value} in row {row}, column {column}; expected a finite number"
    )]
    Entry {
        /// The name of the matrix.
        matrix: &'static str,
        /// The row, from 1.
        row: usize,
        /// The column, from 1.
        column: usize,
        /// The entry.
        value: f64,
    },
    /// There are too many states, or none.
    #[error("the plant has {0} states; expected 1 to {MOST_STATES}")]
    Size(usize),
    /// There are no inputs or no outputs, or too many.
    #[error("the plant has {count} {of}; expected 1 to {MOST_STATES}")]
    Channels {
        /// `inputs` or `outputs`.
        of: &'static str,
        /// Their number.
        count: usize,
    },
    /// The number of names differs from the number of signals.
    #[error("{given} names of {of} for {count} {of}; expected one for each")]
    Names {
        /// `states`, `inputs` or `outputs`.
        of: &'static str,
        /// The number of names.
        given: usize,
        /// The number of signals.
        count: usize,
    },
    /// A name is empty, or cannot be printed on a line.
    #[error("a name of the {of} is {name:?}; expected text on one line")]
    Name {
        /// `states`, `inputs` or `outputs`.
        of: &'static str,
        /// The name with its unit.
        name: String,
    },
    /// Two signals have the same name.
    #[error("two {of} have the name `{name}`; expected different names")]
    Repeated {
        /// `states`, `inputs` or `outputs`.
        of: &'static str,
        /// The name.
        name: String,
    },
    /// The period of a sampled plant is invalid.
    #[error("the sampling period of the plant is {0} s; expected a finite number above 0")]
    Period(f64),
    /// The mass matrix has no inverse.
    #[error(
        "the mass matrix is singular: `{0}` has no inertia; expected a mass for each coordinate"
    )]
    Mass(String),
    /// A transfer function is improper or has no denominator.
    #[error("the transfer function from `{input}` to `{output}` has {why}")]
    TransferFunction {
        /// The input.
        input: String,
        /// The output.
        output: String,
        /// The error in words.
        why: String,
    },
}

/// The most states, inputs or outputs.
pub const MOST_STATES: usize = 100;

impl LinearPlant {
    /// A plant in continuous time. Noise enters where the inputs do, and the signals have numbered names.
    ///
    /// # Errors
    /// [`PlantError`]: matrices that do not fit, or entries that are not finite.
    pub fn new(a: Matrix, b: Matrix, c: Matrix, d: Matrix) -> Result<Self, PlantError> {
        let (n, m, p) = (a.rows(), b.columns(), c.rows());
        if !(1..=MOST_STATES).contains(&n) {
            return Err(PlantError::Size(n));
        }
        for (matrix, name, rows, columns, expected) in [
            (&a, "A", n, n, format!("a square matrix, {n} × {n}")),
            (&b, "B", n, m, format!("{n} rows, one for each state")),
            (&c, "C", p, n, format!("{n} columns, one for each state")),
            (&d, "D", p, m, format!("{p} × {m}: outputs × inputs")),
        ] {
            fits(matrix, name, [rows, columns], expected)?;
        }
        for (of, count) in [("inputs", m), ("outputs", p)] {
            if !(1..=MOST_STATES).contains(&count) {
                return Err(PlantError::Channels { of, count });
            }
        }
        let g = b.clone();
        let signals = [("x", n), ("u", m), ("y", p)];
        let [states, inputs, outputs] = signals.map(|(letter, n)| Signal::numbered(letter, n));
        Ok(LinearPlant {
            a,
            b,
            c,
            d,
            g,
            sampling_period: None,
            has_first_order_states: false,
            states,
            inputs,
            outputs,
        })
    }

    /// The plant with all its states as outputs, without a direct path.
    #[must_use]
    pub fn with_all_states_measured(self) -> Self {
        let (n, m) = (self.states.len(), self.inputs.len());
        let outputs = self.states.clone();
        LinearPlant { c: Matrix::identity(n), d: Matrix::zeros(n, m), outputs, ..self }
    }

    /// The plant with noise that enters by `g`, states × noises.
    ///
    /// # Errors
    /// [`PlantError`]: a matrix that does not fit, or entries that are not finite.
    pub fn with_noise(self, g: Matrix) -> Result<Self, PlantError> {
        let n = self.states.len();
        fits(&g, "G", [n, g.columns()], format!("{n} rows, one for each state"))?;
        Ok(LinearPlant { g, ..self })
    }

    /// The plant as one that is sampled every `period` seconds, whose matrices are those of a step.
    ///
    /// # Errors
    /// [`PlantError::Period`].
    pub fn sampled(self, period: f64) -> Result<Self, PlantError> {
        match period.is_finite() && period > 0.0 {
            true => Ok(LinearPlant { sampling_period: Some(period), ..self }),
            false => Err(PlantError::Period(period)),
        }
    }

    /// The plant with these names and units of its states, inputs and outputs.
    ///
    /// # Errors
    /// [`PlantError`]: a wrong number of names, an empty one, one with control characters, or a repeated one.
    pub fn named(
        self,
        states: Vec<Signal>,
        inputs: Vec<Signal>,
        outputs: Vec<Signal>,
    ) -> Result<Self, PlantError> {
        for (of, given, count) in [
            ("states", &states, self.states.len()),
            ("inputs", &inputs, self.inputs.len()),
            ("outputs", &outputs, self.outputs.len()),
        ] {
            if given.len() != count {
                return Err(PlantError::Names { of, given: given.len(), count });
            }
            let printed = |s: &&Signal| {
                !s.name.trim().is_empty()
                    && !s.name.chars().chain(s.unit.chars()).any(char::is_control)
            };
            if let Some(signal) = given.iter().find(|s| !printed(s)) {
                let name = [&*signal.name, &*signal.unit].join(" ").trim_end().to_owned();
                return Err(PlantError::Name { of, name });
            }
            let repeated =
                (1..given.len()).find(|&i| given[..i].iter().any(|s| s.name == given[i].name));
            if let Some(i) = repeated {
                return Err(PlantError::Repeated { of, name: given[i].name.clone() });
            }
        }
        Ok(LinearPlant { states, inputs, outputs, ..self })
    }

    /// A plant of masses, dampers and springs, `M q̈ + D q̇ + K q = B u`, with the states `q` and `q̇`, and the outputs `q`.
    ///
    /// # Errors
    /// [`PlantError`]: matrices that do not fit, or a singular mass matrix.
    pub fn mechanical(
        [mass, damping, stiffness]: [&Matrix; 3],
        force: &Matrix,
        coordinates: &[Signal],
    ) -> Result<Self, PlantError> {
        let (n, m) = (mass.rows(), force.columns());
        if !(1..=MOST_STATES / 2).contains(&n) {
            return Err(PlantError::Size(2 * n));
        }
        for (matrix, name) in [(mass, "mass"), (damping, "damping"), (stiffness, "stiffness")] {
            fits(matrix, name, [n, n], format!("{n} × {n}, a row for each coordinate"))?;
        }
        fits(force, "force", [n, m], format!("{n} rows, one for each coordinate"))?;
        if coordinates.len() != n {
            return Err(PlantError::Names { of: "states", given: coordinates.len(), count: n });
        }
        let mut all = Matrix::zeros(n, 2 * n + m);
        all.set_block((0, 0), &stiffness.scaled(-1.0));
        all.set_block((0, n), &damping.scaled(-1.0));
        all.set_block((0, 2 * n), force);
        let solved = crate::solve_matrix(mass, &all);
        let solved = solved.ok_or_else(|| {
            let light = (0..n).min_by(|&i, &j| mass[(i, i)].abs().total_cmp(&mass[(j, j)].abs()));
            PlantError::Mass(coordinates[light.unwrap_or(0)].name.clone())
        })?;
        let mut a = Matrix::zeros(2 * n, 2 * n);
        a.set_block((0, n), &Matrix::identity(n));
        a.set_block((n, 0), &solved.block((0, 0), (n, 2 * n)));
        let mut b = Matrix::zeros(2 * n, m);
        b.set_block((n, 0), &solved.block((0, 2 * n), (n, m)));
        let c = Matrix::from_fn(n, 2 * n, |i, j| f64::from(u8::from(i == j)));
        let plant = LinearPlant::new(a, b, c, Matrix::zeros(n, m))?;
        let rates = coordinates.iter().map(|Signal { name, unit }| {
            let unit = if unit.is_empty() { String::new() } else { format!("{unit}/s") };
            Signal { name: format!("{name}'"), unit }
        });
        let states = coordinates.iter().cloned().chain(rates).collect();
        let inputs = plant.inputs.clone();
        plant.named(states, inputs, coordinates.to_vec())
    }
}

fn fits(
    matrix: &Matrix,
    name: &'static str,
    [rows, columns]: [usize; 2],
    expected: String,
) -> Result<(), PlantError> {
    if [matrix.rows(), matrix.columns()] != [rows, columns] {
        let (rows, columns) = (matrix.rows(), matrix.columns());
        return Err(PlantError::Shape { matrix: name, rows, columns, expected });
    }
    match matrix.entries().iter().position(|x| !x.is_finite()) {
        None => Ok(()),
        Some(place) => Err(PlantError::Entry {
            matrix: name,
            row: place / columns + 1,
            column: place % columns + 1,
            value: matrix.entries()[place],
        }),
    }
}
