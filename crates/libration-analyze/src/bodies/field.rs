//! Accelerations, potentials and powers.

use libration::bodies::Bodies;

use super::approach::{Vector, dot, minus};

/// Accelerations, potentials and powers of all bodies at one time.
pub(super) struct Field {
    pub(super) places: Vec<Vector>,
    /// Relative to the centre of mass.
    pub(super) velocities: Vec<Vector>,
    pub(super) accelerations: Vec<Vector>,
    /// Potential energy per mass.
    pub(super) potentials: Vec<f64>,
    /// The rate of the energy of each body, per mass: that of its potential where it is.
    pub(super) powers: Vec<f64>,
}

impl Field {
    /// The field of all bodies, with velocities relative to that of the centre of mass.
    pub(super) fn new(bodies: &Bodies, centre_velocity: Vector) -> Self {
        let count = bodies.count();
        let mut field = Field {
            places: bodies.iter().map(|body| body.position).collect(),
            velocities: bodies.iter().map(|body| minus(body.velocity, centre_velocity)).collect(),
            accelerations: vec![[0.0; 3]; count],
            potentials: vec![0.0; count],
            powers: vec![0.0; count],
        };
        let masses = bodies.masses();
        for j in 1..count {
            for i in (0..j).filter(|&i| masses[i] > 0.0 || masses[j] > 0.0) {
                field.add(bodies, i, j);
                field.add(bodies, j, i);
            }
        }
        field
    }

    /// Adds what body `j` does to body `i`.
    fn add(&mut self, bodies: &Bodies, i: usize, j: usize) {
        let offset = minus(self.places[j], self.places[i]);
        let square = dot(offset, offset);
        let softened = square + bodies.softening_length().powi(2);
        let strength = bodies.constant() * bodies.masses()[j];
        let (mut weight, mut potential) = (0.0, 0.0);
        if strength > 0.0 {
            weight = strength / (softened * softened.sqrt());
            potential = -strength / softened.sqrt();
        }
        if bodies.pairs().is_some() {
            let (distance, mass) = (square.sqrt(), bodies.masses()[i]);
            let [energy, slope] = bodies.pair_terms(i, j, distance);
            weight += slope / (distance * mass);
            potential += energy / mass;
        }
        for (sum, x) in self.accelerations[i].iter_mut().zip(offset) {
            *sum += weight * x;
        }
        self.potentials[i] += potential;
        self.powers[i] += weight * dot(offset, self.velocities[j]);
    }
}
