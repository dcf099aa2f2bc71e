//! The reference orbit of a problem.

use libration::Scalar;
use libration::number::TwoFloat;

use super::Halvings;
use libration_analyze::reference_flow::{Point, Rates, flow};

/// Samples of an orbit at which errors are taken: three quarters of a turn, so that no symmetry of
/// a closed orbit falls on the end.
const SAMPLED: usize = 12;

/// The exact orbit at evenly spaced times.
#[derive(Clone, Debug)]
pub(super) struct Orbit {
    /// The start and the samples.
    states: Vec<Point>,
    uncertainty: f64,
}

impl Orbit {
    pub(super) fn new(rates: &mut Rates<'_, TwoFloat>, start: Point, turn: TwoFloat) -> Self {
        let interval = turn.ratio(1, Halvings::SAMPLES as i32);
        let (mut states, mut uncertainty) = (vec![start], 0.0);
        for _ in 0..SAMPLED {
            let (next, off) = flow(rates, &states[states.len() - 1], interval);
            states.push(next);
            uncertainty += off;
        }
        Orbit { states, uncertainty }
    }

    /// The start and the samples: positions, then velocities.
    pub(super) fn states(&self) -> &[Point] {
        &self.states
    }

    /// The sum of what each interval may be off, relative to the size of the orbit.
    pub(super) fn uncertainty(&self) -> f64 {
        self.uncertainty
    }
}
