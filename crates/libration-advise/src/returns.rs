//! From how far a loop comes back to its operating point.

use libration::{Model, State};
use libration_work::Work;

use super::AdviseError;
use super::ensemble::Run;
use super::loops::Loop;
use super::together::{MEMORIES, MOST_PERIODS};

/// From how far a loop comes back.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Returns {
    /// The distance that was asked, in m or rad.
    pub asked: f64,
    /// How many of the starts at that distance come back.
    pub of_asked: [usize; 2],
    /// The largest distance from which all do, as a search by halves finds it.
    pub up_to: f64,
    /// The largest that was tried.
    pub tried_up_to: f64,
}

/// Directions from which a loop has to return.
const STARTS: usize = 8;

impl<M: Model<1>> Loop<M> {
    /// From how far it returns without noise.
    pub(super) fn returns(
        &self,
        work: &Work<'_>,
        growth: f64,
    ) -> Result<Option<Returns>, AdviseError> {
        let periods = (MEMORIES / -growth).ceil();
        if M::LINEAR && !self.limited() || periods > MOST_PERIODS {
            return Ok(None);
        }
        let stiffness = self.plant().energy().position.max(0.5);
        let back = |distance: f64| -> Result<Option<usize>, AdviseError> {
            let start = |i: usize| {
                let (sine, cosine) = (std::f64::consts::TAU * i as f64 / STARTS as f64).sin_cos();
                let speed = (2.0 * stiffness).sqrt();
                State { q: [distance * cosine], v: [distance * speed * sine] }
            };
            let starts: Vec<State<f64, 1>> = (0..STARTS).map(start).collect();
            let run = Run { before: periods as u64, periods: 0, starts: &starts, intensity: 0.0 };
            let Some(ran) = self.run(work, run)? else { return Ok(None) };
            let near = |state: &State<f64, 1>| {
                state.q[0].abs() < 0.05 * distance && state.q[0].is_finite()
            };
            Ok(Some(ran.last.iter().filter(|state| near(state)).count()))
        };
        let asked = self.control.deviation;
        // Losses with long latencies cannot be simulated.
        let Some(count) = back(asked)? else { return Ok(None) };
        let of_asked = [count, STARTS];
        let tried_up_to = 4.0 * asked;
        let (mut low, mut high) = (0.0, tried_up_to);
        if back(high)? == Some(STARTS) {
            low = high;
        }
        for _ in 0..16 {
            if low == high {
                break;
            }
            let middle = 0.5 * (low + high);
            if back(middle)? == Some(STARTS) { low = middle } else { high = middle }
        }
        Ok(Some(Returns { asked, of_asked, up_to: low, tried_up_to }))
    }
}
