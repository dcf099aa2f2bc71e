//! What a simulation conserves, and how rounding changes it.

use super::conserved::Conserved;
use super::rounding::{RoundingVariance, Roundings};
use super::simulation::{BodySimulation, Stepper};
use super::step_plan::POSITIONS;

impl BodySimulation {
    /// Variances of the changes of conserved quantities in one step by rounding, at the present state.
    pub fn rounding_variance(&self) -> RoundingVariance {
        let mut accelerations = vec![0.0; 3 * self.bodies.count()];
        let attraction = self.bodies.attraction();
        attraction.accelerations(self.bodies.positions(), &mut accelerations, &self.on);
        let (kicks, drifts, is_compensated) = match &self.stepper {
            Stepper::Plan { plan, vectors } => {
                let evaluations = plan.evaluations as f64;
                (evaluations, evaluations, !vectors[POSITIONS].lost.is_empty())
            }
            // Each has two sums besides those of its orbit, whose increments are as large as the state.
            Stepper::Heliocentric(_) => (4.0, 4.0, false),
        };
        let kick_length = self.dt / kicks;
        let roundings = Roundings { kicks, drifts, kick_length, is_compensated };
        let potentials = attraction.potentials(self.bodies.positions(), &self.on);
        match &self.stepper {
            Stepper::Plan { .. } => {
                RoundingVariance::new(&self.bodies, &accelerations, &potentials, roundings)
            }
            Stepper::Heliocentric(_) => {
                // Coordinates are relative to the first body and the centre of mass, whose motion is exact.
                let centred = self.bodies.clone().centred();
                let variance =
                    RoundingVariance::new(&centred, &accelerations, &potentials, roundings);
                RoundingVariance { momentum: [0.0; 3], ..variance }
            }
        }
    }

    /// The same of a single rounding of all positions and velocities: what the bodies of compensated sums have when they are read.
    pub fn representation_variance(&self) -> RoundingVariance {
        let mut accelerations = vec![0.0; 3 * self.bodies.count()];
        let attraction = self.bodies.attraction();
        attraction.accelerations(self.bodies.positions(), &mut accelerations, &self.on);
        let once = Roundings { kicks: 1.0, drifts: 1.0, kick_length: 0.0, is_compensated: false };
        let potentials = vec![0.0; self.bodies.count()];
        RoundingVariance::new(&self.bodies, &accelerations, &potentials, once)
    }

    /// Energy, momentum and angular momentum.
    pub fn conserved(&self) -> Conserved {
        Conserved::of(&self.bodies, &self.on)
    }
}
