//! Steps of servos whose torques are held over substeps.

use libration::Float;
use libration::linear::{Matrix, Signal};
use libration::number::TwoFloat;

use super::{ServoIntegrator, Servos, Torque};

impl Servos {
    /// The matrix of a substep, or with held torques of all `substeps` of a time step, in units of the substep; none if it is not finite.
    pub(super) fn period(
        &self,
        integrator: ServoIntegrator,
        dt: f64,
        substeps: u32,
    ) -> Option<Matrix> {
        let own = self.in_steps_of(dt / f64::from(substeps));
        let deviation = own.deviation::<TwoFloat>(integrator, substeps)?;
        Some(Matrix::identity(deviation.rows()).plus(&deviation))
    }

    /// The same less the identity, of substeps of 1 s, in floats of type `S`.
    pub(super) fn deviation<S: Float>(
        &self,
        integrator: ServoIntegrator,
        substeps: u32,
    ) -> Option<Matrix> {
        match self.torque {
            Torque::EachSubstep => self.step_deviation::<S>(integrator),
            Torque::Held => self.held_deviation::<S>(integrator, substeps),
        }
    }

    /// Substeps under the torques `−K_p q − K_v v` of their beginning.
    fn held_deviation<S: Float>(
        &self,
        integrator: ServoIntegrator,
        substeps: u32,
    ) -> Option<Matrix> {
        let n = self.joints.len();
        // A constant torque moves as a joint without motion whose position it is.
        let (mut stiffness, mut mass) = (Matrix::zeros(2 * n, 2 * n), Matrix::identity(2 * n));
        let mut damping = Matrix::zeros(2 * n, 2 * n);
        mass.set_block((0, 0), &self.mass);
        stiffness.set_block((0, 0), &self.stiffness);
        stiffness.set_block((0, n), &Matrix::identity(n).scaled(-1.0));
        damping.set_block((0, 0), &self.damping);
        let none = Matrix::zeros(2 * n, 2 * n);
        let joints = Signal::numbered("q", 2 * n);
        let torque = Torque::EachSubstep;
        let whole = Servos { joints, mass, kp: none.clone(), kv: none, stiffness, damping, torque };
        let substep = whole.step_deviation::<S>(integrator)?;
        let mut all = Matrix::zeros(4 * n, 4 * n);
        for _ in 0..substeps {
            // (1 + E)(1 + A) − 1.
            all = all.plus(&substep).plus(&(&substep * &all));
        }
        // Positions and velocities of the joints, and the torques at the beginning.
        let part = |columns: usize| {
            let mut rows = Matrix::zeros(2 * n, n);
            rows.set_block((0, 0), &all.block((0, columns), (n, n)));
            rows.set_block((n, 0), &all.block((2 * n, columns), (n, n)));
            rows
        };
        let (of_q, of_v, of_torque) = (part(0), part(2 * n), part(n));
        let mut step = Matrix::zeros(2 * n, 2 * n);
        step.set_block((0, 0), &of_q.plus(&(&of_torque * &self.kp).scaled(-1.0)));
        step.set_block((0, n), &of_v.plus(&(&of_torque * &self.kv).scaled(-1.0)));
        Some(step).filter(Matrix::is_finite)
    }
}
