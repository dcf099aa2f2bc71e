//! What a simulation conserves, and how rounding changes it.

use super::bodies::Bodies;
use super::conserved::Conserved;
use super::rounding::{Accelerations, PairRoundings, RoundingVariance, Roundings};
use super::simulation::{BodySimulation, Stepper};
use super::step_plan::POSITIONS;

impl BodySimulation {
    /// Variances of the changes of conserved quantities in one step by rounding, at the present state.
    pub fn rounding_variance(&self) -> RoundingVariance {
        let (kicks, drifts, is_compensated) = match &self.stepper {
            Stepper::Plan { plan, vectors } => {
                let evaluations = plan.evaluations as f64;
                (evaluations, evaluations, !vectors[POSITIONS].lost.is_empty())
            }
            Stepper::Heliocentric(orbits) => {
                let [kicks, drifts] = orbits.sums();
                (kicks, drifts, false)
            }
        };
        let kick_length = self.length / kicks;
        let pairs = self.bodies.forces().pairs;
        let of_pairs = pairs.map_or_else(PairRoundings::default, |pairs| {
            PairRoundings::new(&pairs, self.bodies.positions(), self.steps())
        });
        let roundings = Roundings { kicks, drifts, kick_length, is_compensated, of_pairs };
        let gravity = self.bodies.forces().gravity;
        let potentials = gravity.potentials(self.bodies.positions(), &self.on);
        match &self.stepper {
            Stepper::Plan { .. } => self.variance(&self.bodies, &potentials, roundings),
            Stepper::Heliocentric(_) => {
                // Coordinates are relative to the first body and the centre of mass, whose motion is exact.
                let centred = self.bodies.clone().centred();
                let variance = self.variance(&centred, &potentials, roundings);
                RoundingVariance { momentum: [0.0; 3], ..variance }
            }
        }
    }

    /// The same of a single rounding of all positions and velocities: what the bodies of compensated sums have when they are read.
    pub fn representation_variance(&self) -> RoundingVariance {
        let once = Roundings { kicks: 1.0, drifts: 1.0, ..Roundings::default() };
        self.variance(&self.bodies, &vec![0.0; self.bodies.count()], once)
    }

    /// The variances of bodies that may be shifted.
    fn variance(
        &self,
        bodies: &Bodies,
        potentials: &[f64],
        roundings: Roundings,
    ) -> RoundingVariance {
        let forces = self.bodies.forces();
        let mut all = vec![0.0; 3 * self.bodies.count()];
        forces.accelerations(self.bodies.positions(), &mut all, &self.on);
        let mut of_gravity = Vec::new();
        let gravity = match forces.pairs {
            None => &all,
            Some(_) => {
                of_gravity.resize(all.len(), 0.0);
                forces.gravity.accelerations(self.bodies.positions(), &mut of_gravity, &self.on);
                &of_gravity
            }
        };
        RoundingVariance::new(bodies, Accelerations { all: &all, gravity, potentials }, roundings)
    }

    /// Energy, momentum and angular momentum.
    pub fn conserved(&self) -> Conserved {
        Conserved::of(&self.bodies, &self.on)
    }
}
