//! Encounters within steps, and the energies of orbits and single bodies, of few bodies in each step.

use libration::bodies::{Bodies, BodySimulation};

use super::approach::{ENCOUNTERS_AT_EACH_STEP, Vector, nearest};
use super::energies::{Energies, PartEnergy};

/// A pair, its distance and the time.
pub(super) type Found = ([usize; 2], f64, f64);

/// The state before a step, and what was found so far.
#[derive(Clone, Debug)]
pub(super) struct Watch {
    /// Positions and velocities, of few bodies.
    before: Option<[Vec<f64>; 2]>,
    time: f64,
    energies: Option<Energies>,
    /// The nearest two bodies.
    closest: Option<Found>,
    /// Two bodies that were nearer than their radii within a step.
    pass: Option<Found>,
}

impl Watch {
    /// A watch from the start on; none of many bodies.
    pub(super) fn new(simulation: &BodySimulation) -> Option<Self> {
        let bodies = simulation.bodies();
        let energies = Energies::new(bodies);
        let is_few = bodies.count() <= ENCOUNTERS_AT_EACH_STEP;
        let closest = bodies.closest_pair().filter(|_| is_few);
        (is_few || energies.is_some()).then(|| Watch {
            before: is_few.then(|| [bodies.positions(), bodies.velocities()].map(<[f64]>::to_vec)),
            time: 0.0,
            energies,
            closest: closest.map(|(pair, distance)| (pair, distance, 0.0)),
            pass: None,
        })
    }

    /// Looks at a step.
    pub(super) fn step(&mut self, simulation: &BodySimulation) {
        let (bodies, time) = (simulation.bodies(), simulation.time());
        if let Some(energies) = &mut self.energies {
            energies.add(bodies, simulation.steps(), time, time - self.time);
        }
        if let Some(mut before) = self.before.take() {
            self.approaches(&before, bodies, time);
            before[0].copy_from_slice(bodies.positions());
            before[1].copy_from_slice(bodies.velocities());
            self.before = Some(before);
        }
        self.time = time;
    }

    fn approaches(&mut self, before: &[Vec<f64>; 2], bodies: &Bodies, time: f64) {
        let length = time - self.time;
        let radii = bodies.radii();
        let count = bodies.count();
        for j in 1..count {
            for i in 0..j {
                let offset = |all: &[f64]| -> Vector {
                    core::array::from_fn(|k| all[k * count + j] - all[k * count + i])
                };
                let start = [offset(&before[0]), offset(&before[1])];
                let end = [offset(bodies.positions()), offset(bodies.velocities())];
                let touch = if self.pass.is_some() { 0.0 } else { radii[i] + radii[j] };
                let below = self.closest.map_or(f64::INFINITY, |(_, least, _)| least);
                let found = nearest(start, end, length, below.max(touch));
                let Some((distance, part)) = found else { continue };
                let found = ([i, j], distance, self.time + part * length);
                if distance < below {
                    self.closest = Some(found);
                }
                if distance < touch {
                    self.pass = Some(found);
                }
            }
        }
    }

    pub(super) fn closest(&self) -> Option<Found> {
        self.closest
    }

    pub(super) fn pass(&self) -> Option<Found> {
        self.pass
    }

    pub(super) fn energies(&self, names: &[String]) -> Vec<PartEnergy> {
        self.energies.as_ref().map_or_else(Vec::new, |energies| energies.changes(names))
    }
}
