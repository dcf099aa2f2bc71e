//! Bodies that meet: at one place, or nearer than their radii.

use super::BodiesError;
use super::simulation::BodySimulation;

impl BodySimulation {
    /// Names the bodies that were nearest before the step.
    pub(super) fn failure(&self) -> BodiesError {
        let time = self.time();
        match self.bodies.closest_pair() {
            Some((pair, 0.0)) => BodiesError::SamePlace { pair, time },
            found => BodiesError::Overflow {
                pair: found.map(|(pair, _)| pair),
                softens: self.bodies.pairs().is_none(),
                time,
            },
        }
    }

    /// Names the first two bodies that collide, and at the start two that attract at the same place.
    pub(super) fn check_distances(&self) -> Result<(), BodiesError> {
        let time = self.time();
        if self.has_radii
            && let Some((i, j, distance)) = self.bodies.first_collision()
        {
            let radii = self.bodies.radii()[i] + self.bodies.radii()[j];
            return Err(BodiesError::Collision { pair: [i, j], time, distance, radii });
        }
        if self.steps > 0 || self.bodies.softening_length() > 0.0 {
            return Ok(());
        }
        // Bodies without mass do not attract and may be anywhere.
        let attract = |i: usize| self.bodies.masses()[i] > 0.0;
        let mut same = None;
        self.bodies.for_each_pair(|i, j, distance| {
            if distance == 0.0 && (attract(i) || attract(j)) {
                same = same.or(Some([i, j]));
            }
        });
        same.map_or(Ok(()), |pair| Err(BodiesError::SamePlace { pair, time }))
    }
}
