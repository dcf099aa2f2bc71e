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
        let softening = bodies.softening_length().powi(2);
        for j in 1..count {
            for i in (0..j).filter(|&i| masses[i] > 0.0 || masses[j] > 0.0) {
                field.add(bodies, softening, i, j);
            }
        }
        field
    }

    /// Adds what bodies `i` and `j` do to each other.
    fn add(&mut self, bodies: &Bodies, softening: f64, i: usize, j: usize) {
        let (masses, offset) = (bodies.masses(), minus(self.places[j], self.places[i]));
        let square = dot(offset, offset);
        let inverse = 1.0 / (square + softening).sqrt();
        let [potential, slope] = match bodies.pairs() {
            Some(_) => bodies.pair_terms(i, j, square.sqrt()),
            None => [0.0; 2],
        };
        for (own, other, sign) in [(i, j, 1.0), (j, i, -1.0)] {
            let strength = bodies.constant() * masses[other];
            if strength > 0.0 {
                let weight = sign * strength * inverse * inverse * inverse;
                self.act(own, other, weight, offset, -strength * inverse);
            }
            if bodies.pairs().is_some() {
                let weight = sign * slope / (square.sqrt() * masses[own]);
                self.act(own, other, weight, offset, potential / masses[own]);
            }
        }
    }

    fn act(&mut self, own: usize, other: usize, weight: f64, offset: Vector, potential: f64) {
        for (sum, x) in self.accelerations[own].iter_mut().zip(offset) {
            *sum += weight * x;
        }
        self.potentials[own] += potential;
        self.powers[own] += weight * dot(offset, self.velocities[other]);
    }
}
