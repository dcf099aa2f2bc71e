//! Growth of coupled joints.

use libration::Scalar;
use libration::linear::{
    Complex64, Matrix, SingularValues, cholesky, eigenvalues, is_schur_stable, solve_matrix,
};
use libration::number::{TwoFloat, Wide};

use super::Torque;
use super::growth::Growth;
use super::joint_step::{JointNumbers, JointSteps};
use super::{ServoIntegrator, Servos};

/// Roundings of the largest eigenvalue, for each state, that an eigenvalue may be off, and a stiffness that is none.
const ROUNDINGS: f64 = 64.0 * f64::EPSILON;

/// Growth or decay per step that no rounding of `f64` hides, of joints that are not stiff.
const CLEAR: f64 = 1e-6;

/// Entries of a step of which products would overflow: no stable step has them.
const LARGEST: f64 = 1e100;

/// The growth under a step of coupled joints, in units of the step.
pub(super) fn growth(
    servos: &Servos,
    steps: &JointSteps,
    integrator: ServoIntegrator,
    parts: u32,
) -> Growth {
    if let Some(modes) = undamped_modes(servos) {
        return Growth::of_parts(modes.iter().map(|mode| steps.growth(mode, parts)));
    }
    let rough = servos.deviation::<f64>(integrator, parts);
    let Some(rough) = rough.filter(|step| step.largest() < LARGEST) else { return Growth::Some };
    let step = Matrix::identity(rough.rows()).plus(&rough);
    // Equations of stiff joints lose digits, of which a double factor 1 keeps half.
    let rates = servos.plant().map_or(f64::INFINITY, |plant| plant.a.row_sum_norm());
    let clear = (10.0 * (f64::EPSILON * rates).sqrt()).max(CLEAR);
    if is_schur_stable(&step.scaled(clear.exp())) {
        return Growth::None;
    }
    if !is_schur_stable(&step.scaled((-clear).exp())) {
        return Growth::Some;
    }
    match servos.deviation::<TwoFloat>(integrator, parts) {
        None => Growth::Unknown,
        Some(deviation) => of_deviation(&deviation, || factors_of_one(servos)),
    }
}

/// The modes of joints without any damping whose stiffness is symmetric: they remain those of each step. None of others.
pub(super) fn undamped_modes(servos: &Servos) -> Option<Vec<JointNumbers>> {
    let stiffness = servos.kp.plus(&servos.stiffness);
    let n = stiffness.rows();
    let is_damped = servos.kv.largest() != 0.0 || servos.damping.largest() != 0.0;
    let is_symmetric = (0..n).all(|i| (0..i).all(|j| stiffness[(i, j)] == stiffness[(j, i)]));
    let is_mixed = servos.torque == Torque::Held && servos.stiffness.largest() != 0.0;
    if is_damped || !is_symmetric || is_mixed || !stiffness.is_finite() {
        return None;
    }
    let factor = cholesky(&servos.mass);
    let half = solve_matrix(&factor, &stiffness)?;
    let whole = solve_matrix(&factor, &half.transposed())?;
    let symmetric = whole.plus(&whole.transposed()).scaled(0.5);
    let values = eigenvalues(&symmetric)?;
    let largest = values.iter().map(|value| value.norm()).fold(0.0, f64::max);
    let rounding = ROUNDINGS * n as f64 * largest;
    let mode = |value: &Complex64| {
        let kp = if value.re.abs() <= rounding { 0.0 } else { value.re };
        JointNumbers {
            kp: Wide::from_f64(kp),
            kv: Wide::ZERO,
            stiffness: Wide::ZERO,
            damping: Wide::ZERO,
            torque: servos.torque,
        }
    };
    Some(values.iter().map(mode).collect())
}

/// The number of factors that are 1 in each step, since no force depends on some motions: positions without stiffness, and their
/// velocities where there is no damping either.
fn factors_of_one(servos: &Servos) -> usize {
    let (stiffness, damping) = (servos.kp.plus(&servos.stiffness), servos.kv.plus(&servos.damping));
    let n = stiffness.rows();
    let nullity = |matrix: &Matrix| {
        SingularValues::of(matrix).map_or(0, |found| n - found.rank(ROUNDINGS * n as f64).min(n))
    };
    let mut both = Matrix::zeros(2 * n, n);
    both.set_block((0, 0), &stiffness);
    both.set_block((n, 0), &damping);
    nullity(&stiffness) + nullity(&both)
}

/// The growth of a step from the eigenvalues `z − 1` of its deviation from the identity, of which so many are zero.
fn of_deviation(deviation: &Matrix, zeros: impl Fn() -> usize) -> Growth {
    let Some(mut values) = eigenvalues(deviation) else { return Growth::Unknown };
    let largest = values.iter().map(|value| value.norm()).fold(0.0, f64::max);
    let rounding = ROUNDINGS * values.len() as f64 * largest;
    // Rounding parts a double eigenvalue by its root.
    let parted = (rounding * largest).sqrt();
    values.sort_by(|a, b| a.norm().total_cmp(&b.norm()));
    let near_zero = values.iter().filter(|value| value.norm() <= 10.0 * parted).count();
    let known_zeros = if near_zero > 0 { near_zero.min(zeros()) } else { 0 };
    let own = |i: usize| {
        let others = values.iter().enumerate().filter(|(j, _)| *j != i);
        let gap = others.map(|(_, other)| (values[i] - other).norm()).fold(f64::INFINITY, f64::min);
        let error = if gap > 0.0 { (rounding * largest / gap).min(parted) } else { parted };
        let error = error.max(rounding);
        // |1 + w| − 1 without cancellation.
        let size = (values[i] + 1.0).norm();
        let excess = (2.0 * values[i].re + values[i].norm_sqr()) / (size + 1.0);
        match excess {
            excess if excess > error => Growth::Some,
            excess if excess < -error => Growth::None,
            _ => Growth::Unknown,
        }
    };
    Growth::of_parts((known_zeros..values.len()).map(own))
}
