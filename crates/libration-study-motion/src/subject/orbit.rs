//! The reference orbit of a problem.

use libration::number::TwoFloat;
use libration::{Hamiltonian, Scalar, State};

use super::Halvings;
use super::flow::flow;

/// Samples of an orbit at which errors are taken: three quarters of a turn, so that no symmetry of
/// a closed orbit falls on the end.
const SAMPLED: usize = 12;

/// The exact orbit at evenly spaced times.
#[derive(Clone, Debug)]
pub(super) struct Orbit<const D: usize> {
    /// The start and the samples.
    states: Vec<State<TwoFloat, D>>,
    uncertainty: f64,
}

impl<const D: usize> Orbit<D> {
    pub(super) fn new(
        system: &impl Hamiltonian<TwoFloat, D>,
        start: State<TwoFloat, D>,
        turn: TwoFloat,
    ) -> Self {
        let interval = turn.ratio(1, Halvings::SAMPLES as i32);
        let (mut states, mut uncertainty) = (vec![start], 0.0);
        for _ in 0..SAMPLED {
            let (next, off) = flow(system, states[states.len() - 1], interval);
            states.push(next);
            uncertainty += off;
        }
        Orbit { states, uncertainty }
    }

    /// The start and the samples.
    pub(super) fn states(&self) -> &[State<TwoFloat, D>] {
        &self.states
    }

    /// The sum of what each interval may be off, relative to the size of the orbit.
    pub(super) fn uncertainty(&self) -> f64 {
        self.uncertainty
    }
}
