//! Steps of an integrator on servos.

use libration::linear::log_spectral_radius;

use super::coupled_step::{growth, undamped_modes};
use super::growth::Growth;
use super::joint_step::JointSteps;
use super::{ServoIntegrator, Servos, Torque};

/// Part by which a step is longer that must be stable, too, for gains to hold: at a limit a motion does not decay, or grows with the
/// number of steps, and numbers of the request are rounded.
const LONGER: f64 = 1e-13;

/// An integrator that steps servos.
pub(super) struct ServoStep {
    integrator: ServoIntegrator,
    joints: JointSteps,
}

impl ServoStep {
    pub(super) fn new(integrator: ServoIntegrator) -> Self {
        ServoStep { integrator, joints: JointSteps::new(integrator) }
    }

    /// Whether a motion grows in a substep of a step of `dt` seconds, or with held torques in the whole step. Joints that nothing couples
    /// are examined in 1024 bits.
    pub(super) fn growth(&self, servos: &Servos, dt: f64, substeps: u32) -> Growth {
        let (h, parts) = substep(servos, dt, substeps);
        Growth::of_parts(servos.parts().iter().map(|part| match part[..] {
            [joint] => self.joints.growth(&servos.joint_numbers(joint, h), parts),
            _ => growth(&servos.part(part).in_steps_of(h), &self.joints, self.integrator, parts),
        }))
    }

    /// The same in slightly longer steps as well.
    pub(super) fn growth_beside_limit(&self, servos: &Servos, dt: f64, substeps: u32) -> Growth {
        let lengths = [dt, dt * (1.0 + LONGER)].into_iter();
        Growth::of_parts(lengths.map(|dt| self.growth(servos, dt, substeps)))
    }

    /// The spectral radius less 1; infinite of a step that overflows.
    pub(super) fn radius_minus_one(&self, servos: &Servos, dt: f64, substeps: u32) -> f64 {
        let (h, parts) = substep(servos, dt, substeps);
        let of_part = |part: &Vec<usize>| {
            if let [joint] = part[..] {
                return self.joints.radius_minus_one(&servos.joint_numbers(joint, h), parts);
            }
            let own = servos.part(part);
            if let Some(modes) = undamped_modes(&own.in_steps_of(h)) {
                let all = modes.iter().map(|mode| self.joints.radius_minus_one(mode, parts));
                return all.fold(-1.0, f64::max);
            }
            let step = own.period(self.integrator, dt, substeps);
            step.map_or(f64::INFINITY, |step| log_spectral_radius(&step).exp_m1())
        };
        servos.parts().iter().map(of_part).fold(-1.0, f64::max)
    }
}

/// The length of a substep, and the number of those in which torques are the same.
fn substep(servos: &Servos, dt: f64, substeps: u32) -> (f64, u32) {
    let parts = if servos.torque == Torque::Held { substeps } else { 1 };
    (dt / f64::from(substeps), parts)
}
