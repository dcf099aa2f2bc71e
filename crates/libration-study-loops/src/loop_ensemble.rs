//! Snapshots of many loops with jittered clocks.

use libration::control::{Clock, Controller};
use libration::ensemble::{All, Loops, Setup};
use libration::{Integrator, State, System};
use libration_study::{Lab, StudyError};

/// A loop of an oscillator. Most are short, and there are many kinds of them: wrap the oscillator in `BaselineOnly`, except in
/// those that take millions of steps.
pub(super) type Loop<Sys, M, K, C> = Setup<All<Sys>, M, K, C>;

/// The states of all loops after some steps.
pub(super) struct Snapshot {
    pub(super) step: u64,
    /// The states, each divided by a factor.
    states: Vec<State<f64, 1>>,
    /// The logarithms of these factors.
    scales: Vec<f64>,
}

/// Steps between two looks at whether a state leaves the range of floats.
const LEG: u64 = 128;

/// Growth of the logarithm of a state in a step that leaves it in range between two looks.
pub(super) const FASTEST: f64 = 1.0;

/// The logarithm of a size that is scaled back; its square is still in range.
const LARGE: f64 = 200.0;

/// Runs loops in steps of `dt` seconds from `starts` and looks at them after each of the steps `at`, which rise.
///
/// States that become large are divided by their size and begin anew, as long as they grow by no more than [`FASTEST`]:
/// clocks that remember are not for loops that grow by e²⁰⁰.
pub(super) fn run_snapshots<Sys, M, K, C>(
    lab: &Lab<'_>,
    setup: Loop<Sys, M, K, C>,
    (dt, seed): (f64, u64),
    starts: &[State<f64, 1>],
    at: &[u64],
) -> Result<Vec<Snapshot>, StudyError>
where
    Sys: System<f64, 1> + Copy + Send + Sync,
    M: Integrator,
    K: Controller<f64, 1>,
    C: Clock<f64>,
{
    let mut loops = Loops::new(setup, dt, seed, [0.0], starts, lab.alone()?)?;
    let mut scales = vec![0.0; starts.len()];
    let mut seen = Vec::with_capacity(at.len());
    for &step in at {
        while loops.step() < step {
            lab.check()?;
            loops.advance(LEG.min(step - loops.step()))?;
            for (n, scale) in scales.iter_mut().enumerate() {
                let Some(State { q: [q], v: [v] }) = loops.state(n) else { continue };
                let size = q.abs().max(v.abs());
                if size.ln().abs() > LARGE && size.is_finite() && size > 0.0 {
                    *scale += size.ln();
                    loops.reset(n, State { q: [q / size], v: [v / size] });
                }
            }
        }
        let states = (0..starts.len()).filter_map(|n| loops.state(n)).collect();
        seen.push(Snapshot { step, states, scales: scales.clone() });
    }
    Ok(seen)
}

impl Snapshot {
    /// The logarithm of something that grows as the square of a state, for each loop.
    pub(super) fn logarithms(&self, square: impl Fn(&State<f64, 1>) -> f64) -> Vec<f64> {
        let all = self.states.iter().zip(&self.scales);
        all.map(|(state, scale)| square(state).ln() + 2.0 * scale).collect()
    }

    /// The states but for their sizes.
    pub(super) fn directions(&self) -> &[State<f64, 1>] {
        &self.states
    }
}
