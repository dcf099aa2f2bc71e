//! The region of attraction of the operating point.

use libration::State;
use libration_work::Work;

use super::AdviseError;
use super::ensemble::{EnsembleRun, MEMORIES, MOST_PERIODS};
use super::loops::{Loop, PlantModel};

/// The distances from which a loop returns to its operating point.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct RegionOfAttraction {
    /// The distance of the request, in m or rad.
    pub deviation: f64,
    /// The number of starts at that distance that return, and of all starts.
    pub returned: [usize; 2],
    /// The largest distance from which all starts return, by bisection.
    pub up_to: f64,
    /// The largest tried distance.
    pub tried_up_to: f64,
}

/// Number of starts around the operating point.
const STARTS: usize = 8;

impl<M: PlantModel> Loop<M> {
    /// The region of attraction without noise; none if the loop is linear, or decays too slowly to simulate.
    pub(super) fn region_of_attraction(
        &self,
        work: &Work<'_>,
        growth: f64,
    ) -> Result<Option<RegionOfAttraction>, AdviseError> {
        let periods = (MEMORIES / -growth).ceil();
        if M::LINEAR && !self.has_command_limit() || periods > MOST_PERIODS {
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
            let run =
                EnsembleRun { before: periods as u64, periods: 0, starts: &starts, intensity: 0.0 };
            let Some(ran) = self.run(work, run)? else { return Ok(None) };
            let near = |state: &State<f64, 1>| {
                state.q[0].abs() < 0.05 * distance && state.q[0].is_finite()
            };
            Ok(Some(ran.last.iter().filter(|state| near(state)).count()))
        };
        let deviation = self.control.deviation;
        // Losses with long latencies cannot be simulated.
        let Some(count) = back(deviation)? else { return Ok(None) };
        let returned = [count, STARTS];
        let tried_up_to = 4.0 * deviation;
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
        Ok(Some(RegionOfAttraction { deviation, returned, up_to: low, tried_up_to }))
    }
}
