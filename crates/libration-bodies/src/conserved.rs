//! The quantities that the motion conserves.

use libration_batch::ensemble::Execution;
use libration_core::Scalar;
use libration_core::number::TwoFloat;

use super::bodies::Bodies;

/// What an exact motion keeps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conserved {
    /// Kinetic energy.
    pub kinetic: f64,
    /// Potential energy.
    pub potential: f64,
    /// Their sum.
    pub energy: f64,
    /// Momentum.
    pub momentum: [f64; 3],
    /// Angular momentum about the origin.
    pub angular_momentum: [f64; 3],
}

impl Conserved {
    /// Sums over all bodies in 106 bits; the terms of the potentials are sums in `f64`.
    pub(crate) fn of(bodies: &Bodies, on: &Execution) -> Self {
        let zero = TwoFloat::from_f64(0.0);
        let (mut kinetic, mut potential) = (zero, zero);
        let (mut momentum, mut angular_momentum) = ([zero; 3], [zero; 3]);
        let forces = bodies.forces();
        let potentials = forces.gravity.potentials(bodies.positions(), on);
        let energies = forces.pair_energies(bodies.positions(), on);
        for ((body, own), of_pairs) in bodies.iter().zip(potentials).zip(energies) {
            let wide = TwoFloat::from_f64;
            let (mass, q, v) = (wide(body.mass), body.position.map(wide), body.velocity.map(wide));
            let [x, y, z] = q;
            let [vx, vy, vz] = v;
            kinetic = kinetic + mass * (vx * vx + vy * vy + vz * vz);
            potential = potential + mass * wide(own) + wide(of_pairs);
            let turns = [y * vz - z * vy, z * vx - x * vz, x * vy - y * vx];
            for axis in 0..3 {
                momentum[axis] = momentum[axis] + mass * v[axis];
                angular_momentum[axis] = angular_momentum[axis] + mass * turns[axis];
            }
        }
        let half = |sum: TwoFloat| sum.ratio(1, 2);
        Conserved {
            kinetic: half(kinetic).hi(),
            potential: half(potential).hi(),
            energy: half(kinetic + potential).hi(),
            momentum: momentum.map(TwoFloat::hi),
            angular_momentum: angular_momentum.map(TwoFloat::hi),
        }
    }
}
