//! Tables of linear plants.

use std::collections::BTreeMap;

use libration::linear::{LinearPlant, Matrix, PlantError, Signal};
use serde::Deserialize;

use super::linearisation::linearise;
use super::{Coordinates, OperatingPoint, plant_file, plant_keys};
use crate::{Fault, Number};

/// The table `[system.linear]`: a plant by its matrices, by masses, dampers and springs, by transfer functions, or in a file.
#[derive(Clone, Debug, Default, Deserialize, PartialEq)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct PlantTable {
    /// A file with the same keys: `.toml`, `.json`, `.csv`, `.npz` or `.mat`.
    pub file: Option<String>,
    /// A system of the catalogue or a file with equations, linearised at an equilibrium.
    pub of: Option<String>,
    /// Its parameters.
    pub parameters: BTreeMap<String, Number>,
    /// The coordinates at which the search for the equilibrium begins (default: zero, of equations their start).
    pub at: Option<Coordinates>,
    /// The constant command at the equilibrium (default: zero).
    pub command: Option<Coordinates>,
    /// States × states.
    #[serde(alias = "A")]
    pub a: Option<Rows>,
    /// States × inputs.
    #[serde(alias = "B")]
    pub b: Option<Rows>,
    /// Outputs × states (default: all states).
    #[serde(alias = "C")]
    pub c: Option<Rows>,
    /// Outputs × inputs (default: zero).
    #[serde(alias = "D")]
    pub d: Option<Rows>,
    /// States × noises (default: noise enters where the inputs do).
    #[serde(alias = "G")]
    pub g: Option<Rows>,
    /// The mass matrix of `M q̈ + D q̇ + K q = B u`.
    pub mass: Option<Rows>,
    /// The damping matrix (default: zero).
    pub damping: Option<Rows>,
    /// The stiffness matrix (default: zero).
    pub stiffness: Option<Rows>,
    /// The numerators of transfer functions, outputs × inputs, by falling powers of `s`.
    pub numerator: Option<Polynomials>,
    /// The denominators.
    pub denominator: Option<Polynomials>,
    /// Names of the states, with units in parentheses: `"angle (rad)"`. Of a mechanical plant those of its coordinates.
    pub states: Option<Vec<String>>,
    /// Names of the inputs.
    pub inputs: Option<Vec<String>>,
    /// Names of the outputs.
    pub outputs: Option<Vec<String>>,
    /// The period in s of a plant whose matrices are those of a step.
    #[serde(default, deserialize_with = "crate::duration::optional_period")]
    pub sampling_period: Option<Number>,
}

/// The rows of a matrix.
pub type Rows = Vec<Vec<Number>>;

/// One polynomial, or one for each pair of output and input.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(
    untagged,
    expecting = "expected a list of numbers, or one for each output and input: `[[[1], [2, 1]]]`"
)]
pub enum Polynomials {
    /// Of a plant with one input and one output.
    One(Vec<Number>),
    /// Outputs × inputs.
    All(Vec<Vec<Vec<Number>>>),
}

impl PlantTable {
    /// The plant.
    ///
    /// # Errors
    /// [`Fault`]: matrices that do not fit, or a file that cannot be read.
    pub fn plant(&self) -> Result<LinearPlant, Fault> {
        if let Some(file) = &self.file {
            let own = PlantTable { file: None, ..self.clone() };
            if own != PlantTable::default() {
                let message = "`file` is given, so no other key is allowed";
                return Err(Fault::new("system.linear.file", message));
            }
            let wrong = |why: String| {
                Fault::new("system.linear.file", format!("cannot use `{file}`: {why}"))
            };
            let table = plant_file::read(std::path::Path::new(file)).map_err(wrong)?;
            return table.plant().map_err(|fault| wrong(fault.to_string()));
        }
        plant_keys::check(&self.given())?;
        let plant = match (&self.of, &self.a, &self.mass, &self.numerator) {
            (Some(of), None, None, None) => self.linearised(of)?.0,
            (None, Some(a), None, None) => self.by_matrices(a)?,
            (None, None, Some(mass), None) => self.mechanical(mass)?,
            (None, None, None, Some(numerator)) => self.by_transfer_functions(numerator)?,
            _ => return Err(Fault::new("system.linear", plant_keys::ONE_FORM)),
        };
        let plant = match &self.g {
            Some(g) => plant.with_noise(matrix("system.linear.g", g)?).map_err(fault)?,
            None => plant,
        };
        let plant = self.named(plant)?;
        match self.sampling_period {
            Some(Number(period)) => plant.sampled(period).map_err(fault),
            None => Ok(plant),
        }
    }

    /// The equilibrium of a linearised system; none of other plants.
    ///
    /// # Errors
    /// [`Fault`]: as for [`PlantTable::plant`].
    pub fn operating_point(&self) -> Result<Option<OperatingPoint>, Fault> {
        let in_file = |file: &String| {
            let table = plant_file::read(std::path::Path::new(file));
            table.map_err(|why| Fault::new("system.linear.file", why))?.operating_point()
        };
        match (&self.file, &self.of) {
            (Some(file), _) => in_file(file),
            (None, Some(of)) => Ok(Some(self.linearised(of)?.1)),
            (None, None) => Ok(None),
        }
    }

    /// The keys that are given, without those of noise and names.
    fn given(&self) -> Vec<&'static str> {
        let keys = [
            ("of", self.of.is_some()),
            ("at", self.at.is_some()),
            ("command", self.command.is_some()),
            ("parameters", !self.parameters.is_empty()),
            ("a", self.a.is_some()),
            ("b", self.b.is_some()),
            ("c", self.c.is_some()),
            ("d", self.d.is_some()),
            ("mass", self.mass.is_some()),
            ("damping", self.damping.is_some()),
            ("stiffness", self.stiffness.is_some()),
            ("numerator", self.numerator.is_some()),
            ("denominator", self.denominator.is_some()),
            ("sampling-period", self.sampling_period.is_some()),
        ];
        keys.into_iter().filter(|(_, given)| *given).map(|(key, _)| key).collect()
    }

    fn linearised(&self, name: &str) -> Result<(LinearPlant, OperatingPoint), Fault> {
        linearise(name, &self.parameters, self.at.as_ref(), self.command.as_ref())
    }

    fn by_matrices(&self, a: &Rows) -> Result<LinearPlant, Fault> {
        let a = matrix("system.linear.a", a)?;
        let Some(b) = &self.b else {
            return Err(Fault::new("system.linear", "`a` is given, so `b` is required"));
        };
        let b = matrix("system.linear.b", b)?;
        let c = match &self.c {
            Some(c) => matrix("system.linear.c", c)?,
            None => Matrix::identity(a.rows()),
        };
        let d = match &self.d {
            Some(d) => matrix("system.linear.d", d)?,
            None => Matrix::zeros(c.rows(), b.columns()),
        };
        LinearPlant::new(a, b, c, d).map_err(fault)
    }

    fn mechanical(&self, mass: &Rows) -> Result<LinearPlant, Fault> {
        let mass = matrix("system.linear.mass", mass)?;
        let n = mass.rows();
        let optional = |key, rows: &Option<Rows>| match rows {
            Some(rows) => matrix(key, rows),
            None => Ok(Matrix::zeros(n, n)),
        };
        let damping = optional("system.linear.damping", &self.damping)?;
        let stiffness = optional("system.linear.stiffness", &self.stiffness)?;
        let force = match &self.b {
            Some(b) => matrix("system.linear.b", b)?,
            None => Matrix::identity(n),
        };
        let coordinates = match &self.states {
            Some(names) => names.iter().map(|name| Signal::parse(name)).collect(),
            None => Signal::numbered("q", n),
        };
        let plant = LinearPlant::mechanical([&mass, &damping, &stiffness], &force, &coordinates);
        let plant = plant.map_err(fault)?;
        if self.c.is_none() && self.d.is_none() {
            return Ok(plant);
        }
        let LinearPlant { a, b, c: positions, states, inputs, outputs, .. } = plant;
        let c = match &self.c {
            Some(c) => matrix("system.linear.c", c)?,
            None => positions,
        };
        let d = match &self.d {
            Some(d) => matrix("system.linear.d", d)?,
            None => Matrix::zeros(c.rows(), force.columns()),
        };
        let plant = LinearPlant::new(a, b, c, d).map_err(fault)?;
        let outputs = if self.c.is_none() { outputs } else { plant.outputs.clone() };
        plant.named(states, inputs, outputs).map_err(fault)
    }

    fn by_transfer_functions(&self, numerator: &Polynomials) -> Result<LinearPlant, Fault> {
        let Some(denominator) = &self.denominator else {
            let message = "`numerator` is given, so `denominator` is required";
            return Err(Fault::new("system.linear", message));
        };
        let all = |polynomials: &Polynomials| -> Vec<Vec<Vec<f64>>> {
            let numbers = |one: &Vec<Number>| one.iter().map(|x| x.0).collect();
            match polynomials {
                Polynomials::One(one) => vec![vec![numbers(one)]],
                Polynomials::All(all) => {
                    all.iter().map(|row| row.iter().map(numbers).collect()).collect()
                }
            }
        };
        LinearPlant::from_transfer_functions(&all(numerator), &all(denominator)).map_err(fault)
    }

    fn named(&self, plant: LinearPlant) -> Result<LinearPlant, Fault> {
        let signals = |names: &Option<Vec<String>>, known: &[Signal]| match names {
            Some(names) => names.iter().map(|name| Signal::parse(name)).collect(),
            None => known.to_vec(),
        };
        let states = match &self.mass {
            Some(_) => plant.states.clone(),
            None => signals(&self.states, &plant.states),
        };
        let inputs = signals(&self.inputs, &plant.inputs);
        // Without `c` the outputs are the states.
        let known = if self.c.is_none() && (self.a.is_some() || self.of.is_some()) {
            &states
        } else {
            &plant.outputs
        };
        let outputs = signals(&self.outputs, known);
        plant.named(states, inputs, outputs).map_err(fault)
    }
}

/// A matrix of rows of equal length.
pub(super) fn matrix(key: &'static str, rows: &Rows) -> Result<Matrix, Fault> {
    let numbers: Vec<Vec<f64>> = rows.iter().map(|row| row.iter().map(|x| x.0).collect()).collect();
    Matrix::from_rows(&numbers).ok_or_else(|| {
        let first = numbers[0].len();
        let odd = numbers.iter().position(|row| row.len() != first).unwrap_or(0);
        let count = numbers[odd].len();
        let name = key.rsplit('.').next().unwrap_or(key);
        let message = format!("row {} of `{name}` has {count} numbers, row 1 has {first}", odd + 1);
        Fault::at(key, odd, message)
    })
}

/// The fault of a plant, at the key that causes it.
fn fault(error: PlantError) -> Fault {
    let matrix = match &error {
        PlantError::Shape { matrix, .. } | PlantError::Entry { matrix, .. } => *matrix,
        _ => "",
    };
    let key = match (matrix, &error) {
        ("A", _) => "system.linear.a",
        ("B" | "force", _) => "system.linear.b",
        ("C", _) => "system.linear.c",
        ("D", _) => "system.linear.d",
        ("G", _) => "system.linear.g",
        ("mass", _) | (_, PlantError::Mass(_)) => "system.linear.mass",
        ("damping", _) => "system.linear.damping",
        ("stiffness", _) => "system.linear.stiffness",
        (
            _,
            PlantError::Names { of, .. }
            | PlantError::Name { of, .. }
            | PlantError::Repeated { of, .. },
        ) => match *of {
            "states" => "system.linear.states",
            "inputs" => "system.linear.inputs",
            _ => "system.linear.outputs",
        },
        (_, PlantError::TransferFunction { .. }) => "system.linear.numerator",
        (_, PlantError::Period(_)) => "system.linear.sampling-period",
        _ => "system.linear",
    };
    Fault::new(key, error.to_string())
}
