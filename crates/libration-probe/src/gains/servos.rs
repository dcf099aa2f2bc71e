//! Servos on joints as matrices.

use libration::Float;
use libration::analysis::LinearStepper;
use libration::linear::{
    LinearPlant, MOST_STATES, Matrix, PlantError, Signal, cholesky, eigenvalues, solve_matrix,
};
use libration_report::notation::plural;
use serde::Deserialize;
use thiserror::Error;

use super::{OtherForces, ServoGain, ServoIntegrator, Torque};
use crate::Description;

/// Joints with servos: `M q̈ = −(K_p + K) q − (K_v + D) q̇` for small deviations.
#[derive(Clone, Debug)]
pub struct Servos {
    /// Names and units of the joints.
    pub joints: Vec<Signal>,
    /// Inertia, joints × joints.
    pub mass: Matrix,
    /// Gains of position `K_p`.
    pub kp: Matrix,
    /// Gains of velocity `K_v`.
    pub kv: Matrix,
    /// Stiffness `K` of springs and gravity.
    pub stiffness: Matrix,
    /// Damping `D` of joints.
    pub damping: Matrix,
    /// When torques are computed.
    pub torque: Torque,
}

/// Servos as JSON: matrices, or vectors of their diagonals.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ServosDescription {
    joints: Option<Vec<String>>,
    mass: Entries,
    kp: Entries,
    kv: Option<Entries>,
    stiffness: Option<Entries>,
    damping: Option<Entries>,
    /// Facts for the reader of the report.
    #[serde(default)]
    pub notes: Vec<String>,
    /// Length of a step in s, if the simulator has one.
    pub dt: Option<f64>,
    /// The integrator of the simulator, if it has one.
    pub integrator: Option<String>,
    /// When torques are computed.
    #[serde(default)]
    pub torque: Torque,
    /// The step of the simulator, if it can be measured.
    pub step: Option<Description>,
    /// The servos of this step.
    #[serde(default)]
    pub servos: Vec<ServoGain>,
    /// What acts in it besides these servos.
    #[serde(default)]
    pub other_forces: OtherForces,
    /// Forces at a limit, where gains have no derivative, in words.
    #[serde(default)]
    pub saturated: Vec<String>,
    /// Servos that do not act, in words.
    #[serde(default)]
    pub idle: Vec<String>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(untagged)]
enum Entries {
    Diagonal(Vec<f64>),
    Matrix(Vec<Vec<f64>>),
}

/// Servos that cannot be used.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum ServoError {
    /// A value is not allowed.
    #[error("`{field}` {problem}; expected {expected}")]
    Value {
        /// The field.
        field: &'static str,
        /// What is wrong with it, with its value: `has 1 number`, `is 0 for `elbow``.
        problem: String,
        /// What is allowed.
        expected: String,
    },
    /// Names of joints repeat, or one is that of a rate.
    #[error("`joints`: {0}")]
    Names(PlantError),
}

impl ServosDescription {
    /// The servos.
    ///
    /// # Errors
    /// A value is not allowed.
    pub fn servos(&self) -> Result<Servos, ServoError> {
        let n = match &self.mass {
            Entries::Diagonal(values) => values.len(),
            Entries::Matrix(rows) => rows.len(),
        };
        if !(1..=MOST_STATES / 2).contains(&n) {
            return Err(ServoError::Value {
                field: "mass",
                problem: format!("is that of {}", plural(n, "joint")),
                expected: format!("1 to {} joints", MOST_STATES / 2),
            });
        }
        let optional = |field, entries: &Option<Entries>| match entries {
            Some(entries) => matrix(field, entries, n),
            None => Ok(Matrix::zeros(n, n)),
        };
        let joints = match &self.joints {
            None => Signal::numbered("joint ", n),
            Some(names) if names.len() == n => {
                names.iter().map(|name| Signal::parse(name)).collect()
            }
            Some(names) => {
                return Err(ServoError::Value {
                    field: "joints",
                    problem: format!("has {}", plural(names.len(), "name")),
                    expected: format!("{n}, one for each row of mass"),
                });
            }
        };
        let servos = Servos {
            joints,
            mass: matrix("mass", &self.mass, n)?,
            kp: matrix("kp", &self.kp, n)?,
            kv: optional("kv", &self.kv)?,
            stiffness: optional("stiffness", &self.stiffness)?,
            damping: optional("damping", &self.damping)?,
            torque: self.torque,
        };
        check_inertia(&servos)?;
        servos.plant().map_err(ServoError::Names)?;
        Ok(servos)
    }
}

/// Checks that the inertia is symmetric and positive definite.
fn check_inertia(servos: &Servos) -> Result<(), ServoError> {
    let (mass, n) = (&servos.mass, servos.joints.len());
    let wrong = |problem: String, expected: &str| {
        Err(ServoError::Value { field: "mass", problem, expected: expected.into() })
    };
    if let Some(i) = (0..n).find(|&i| mass[(i, i)] <= 0.0) {
        let problem = format!("is {} for `{}`", mass[(i, i)], servos.joints[i].name);
        return wrong(problem, "numbers above 0");
    }
    for (i, j) in (0..n).flat_map(|i| (0..i).map(move |j| (i, j))) {
        let (a, b) = (mass[(j, i)], mass[(i, j)]);
        if (a - b).abs() > 1e-9 * mass.largest() {
            let names = [j, i].map(|k| servos.joints[k].name.as_str());
            let problem =
                format!("is not symmetric: {a} and {b} for `{}` and `{}`", names[0], names[1]);
            return wrong(problem, "a symmetric matrix");
        }
    }
    let factor = cholesky(mass);
    match (0..n).all(|i| factor[(i, i)] > 0.0) {
        true => Ok(()),
        false => {
            let all = eigenvalues(mass).unwrap_or_default();
            let least = all.iter().map(|s| s.re).fold(f64::INFINITY, f64::min);
            let problem = format!("is not positive definite: its least eigenvalue is {least:.4}");
            wrong(problem, "the inertia of the joints")
        }
    }
}

fn matrix(field: &'static str, entries: &Entries, n: usize) -> Result<Matrix, ServoError> {
    let wrong = |problem: String| {
        let expected = format!("{n} numbers, or {n} × {n}, all finite");
        Err(ServoError::Value { field, problem, expected })
    };
    let rows: Vec<Vec<f64>> = match entries {
        Entries::Diagonal(values) if values.len() == n => {
            (0..n).map(|i| (0..n).map(|j| if i == j { values[i] } else { 0.0 }).collect()).collect()
        }
        Entries::Diagonal(values) => {
            return wrong(format!("has {}", plural(values.len(), "number")));
        }
        Entries::Matrix(rows) => rows.clone(),
    };
    if rows.len() != n || rows.iter().any(|row| row.len() != n) {
        let columns = rows.first().map_or(0, Vec::len);
        return wrong(format!("is {} × {columns}", rows.len()));
    }
    match rows.iter().flatten().find(|x| !x.is_finite()) {
        Some(value) => wrong(format!("has {value}")),
        None => Ok(Matrix::from_fn(n, n, |i, j| rows[i][j])),
    }
}

impl Servos {
    /// The same with all gains of position times `factor`.
    pub(super) fn with_factor(&self, factor: f64) -> Self {
        Servos { kp: self.kp.scaled(factor), ..self.clone() }
    }

    /// The same with the gains of position of one joint, its row of `K_p`, times `factor`.
    pub(super) fn with_joint_factor(&self, joint: usize, factor: f64) -> Self {
        let mut servos = self.clone();
        servos.kp.row_mut(joint).iter_mut().for_each(|kp| *kp *= factor);
        servos
    }

    /// The same with another gain of position of one joint.
    pub(super) fn with_kp(&self, joint: usize, kp: f64) -> Self {
        let mut servos = self.clone();
        servos.kp[(joint, joint)] = kp;
        servos
    }

    /// The same with another gain of velocity of one joint.
    pub(super) fn with_kv(&self, joint: usize, kv: f64) -> Self {
        let mut servos = self.clone();
        servos.kv[(joint, joint)] = kv;
        servos
    }

    /// The joints without their servos.
    pub(super) fn passive(&self) -> Self {
        let n = self.joints.len();
        Servos { kp: Matrix::zeros(n, n), kv: Matrix::zeros(n, n), ..self.clone() }
    }

    /// Joint `i` alone, with all others at rest.
    pub(super) fn alone(&self, i: usize) -> Self {
        let entry = |matrix: &Matrix| matrix.block((i, i), (1, 1));
        Servos {
            joints: vec![self.joints[i].clone()],
            mass: entry(&self.mass),
            kp: entry(&self.kp),
            kv: entry(&self.kv),
            stiffness: entry(&self.stiffness),
            damping: entry(&self.damping),
            torque: self.torque,
        }
    }

    /// The motion in continuous time; its states are the joints and then their velocities.
    pub(super) fn plant(&self) -> Result<LinearPlant, PlantError> {
        let n = self.joints.len();
        let (stiffness, damping) = (self.kp.plus(&self.stiffness), self.kv.plus(&self.damping));
        let force = Matrix::identity(n);
        LinearPlant::mechanical([&self.mass, &damping, &stiffness], &force, &self.joints)
    }

    /// The matrix of a step of 1 s less the identity, in floats of type `S`; none if it is not finite.
    pub(super) fn step_deviation<S: Float>(&self, integrator: ServoIntegrator) -> Option<Matrix> {
        match integrator {
            ServoIntegrator::JointDampingImplicit => self.joint_damping_step(),
            ServoIntegrator::Method(method) => {
                let plant = self.plant().ok()?;
                let stepper = LinearStepper::new(&plant.a)?;
                Some(stepper.with_step::<S>(method, 1.0)?.deviation_matrix())
            }
        }
        .filter(Matrix::is_finite)
    }

    /// `(M + D)(v' − v) = −(K_p + K) q − (K_v + D) v`, `q' − q = v'`.
    fn joint_damping_step(&self) -> Option<Matrix> {
        let n = self.joints.len();
        let mut right = Matrix::zeros(n, 2 * n);
        right.set_block((0, 0), &self.kp.plus(&self.stiffness).scaled(-1.0));
        right.set_block((0, n), &self.kv.plus(&self.damping).scaled(-1.0));
        let velocities = solve_matrix(&self.mass.plus(&self.damping), &right)?;
        let mut step = Matrix::zeros(2 * n, 2 * n);
        step.set_block((n, 0), &velocities);
        let mut positions = velocities;
        for i in 0..n {
            positions[(i, n + i)] += 1.0;
        }
        step.set_block((0, 0), &positions);
        Some(step)
    }
}
