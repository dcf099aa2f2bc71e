//! Which integrator a step is, by its matrix.

use libration::AnyMethod;
use libration::analysis::LinearStepper;
use libration::linear::{Matrix, solve_matrix};

use crate::flow::Flow;
use crate::linearised_step::{LinearisedStep, largest_scaled};
use crate::recognition::{Candidate, Match};
use crate::{ServoIntegrator, Subject};

/// Errors of the rates that a candidate may be off.
const ERRORS: f64 = 20.0;
/// Roundings in units of the scales.
const ROUNDING: f64 = 1e-11;

/// Compares the matrix of a step with that of each integrator on the linearised system.
///
/// At an equilibrium it needs no rates elsewhere, and it knows the damping of joints from that of servos.
pub(crate) fn match_matrices(
    step: &LinearisedStep,
    flow: &Flow,
    cleaned: &Matrix,
    pairs: Option<&[(usize, usize)]>,
    subject: &Subject,
    order: Option<u32>,
) -> Option<Match> {
    let stepper = LinearStepper::new(cleaned)?;
    let largest = |matrix: &Matrix| largest_scaled(matrix, subject);
    let mut candidates = Vec::new();
    let mut add = |method, title: String, update: Option<Matrix>| {
        let Some(update) = update.filter(Matrix::is_finite) else { return };
        let distance = largest(&update.plus(&step.a.scaled(-1.0)));
        candidates.push(Candidate { method, title, distance });
    };
    for method in AnyMethod::all() {
        let update = stepper.with_step::<f64>(method, step.dt).map(|step| step.update_matrix());
        add(method.name(), method.title().to_owned(), update);
    }
    let euler = ServoIntegrator::JointDampingImplicit;
    let update = pairs.and_then(|pairs| joint_damping_step(&flow.a, step.dt, pairs, subject));
    add(euler.name(), euler.title(), update);
    let errors = largest(&flow.a_errors) * step.dt + largest(&step.a_errors);
    let change = largest(&step.a.plus(&Matrix::identity(step.a.rows()).scaled(-1.0)));
    Some(Match::new(candidates, ERRORS * errors + ROUNDING, change, order))
}

/// `v' = v + h (M + hD)⁻¹ M a`, `q' = q + h v'` with the damping `D` of joints, and the accelerations `a` of all forces.
fn joint_damping_step(
    rates: &Matrix,
    h: f64,
    pairs: &[(usize, usize)],
    subject: &Subject,
) -> Option<Matrix> {
    let (mass, damping) = (subject.mass.as_ref()?, subject.joint_damping.as_ref()?);
    let (n, d) = (rates.rows(), pairs.len());
    let accelerations = Matrix::from_fn(d, n, |i, j| rates[(pairs[i].1, j)]);
    let implicit = mass.plus(&Matrix::diagonal(damping).scaled(h));
    let kicks = solve_matrix(&implicit, &(mass * &accelerations))?.scaled(h);
    let mut step = Matrix::identity(n);
    for (i, &(q, v)) in pairs.iter().enumerate() {
        for j in 0..n {
            step[(v, j)] += kicks[(i, j)];
        }
        for j in 0..n {
            step[(q, j)] += h * step[(v, j)];
        }
    }
    Some(step)
}
