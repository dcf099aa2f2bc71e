//! Simulated loops and their growth.

use libration::analysis::{LatencyWindows, Plant};
use libration::control::controller::StateFeedback;
use libration::control::{Feedback, Latency, Schedule};
use libration::ensemble::{All, Loops, Setup};
use libration::number::Wide;
use libration::system::{BaselineOnly, Oscillator};
use libration::{Method, Scalar, State};
use libration_study::{Lab, StudyError};

/// The spring on which every loop of this study is closed: that of the source.
pub(super) const SPRING: Oscillator<f64> =
    Oscillator { omega2: libration_study::source_report::OMEGA2 };

/// The operating point of linearisations.
pub(super) const ORIGIN: State<f64, 1> = State { q: [0.0], v: [0.0] };

/// Initial state of loops; not an eigenvector of any of them.
pub(super) const START: State<f64, 1> = State { q: [1.0], v: [0.5] };

/// Steps from one look at the states to the next: few enough that no loop leaves the floats between two of them.
const BETWEEN: u64 = 7;

/// States are looked at as long as their sizes are within `e` to plus or minus this.
const LARGEST: f64 = 320.0;

/// A loop on [`SPRING`], but for its latency.
#[derive(Clone, Copy, Debug)]
pub(super) struct Loop {
    pub(super) method: Method,
    pub(super) dt: f64,
    pub(super) gains: Feedback,
}

impl Loop {
    pub(super) fn plant(&self) -> Plant<'static> {
        Plant::new(self.method, SPRING, ORIGIN, self.dt)
    }

    /// Returns all stable latencies, by theory.
    pub(super) fn windows(&self) -> LatencyWindows {
        self.plant().latency_windows(self.gains)
    }

    /// `ln ρ` of a step, by theory; NaN for a latency that is none.
    pub(super) fn predicted(&self, steps: f64) -> f64 {
        let radius = |d| logarithm(self.plant().spectral_radius(self.gains, d));
        Latency::of_steps(steps).map_or(f64::NAN, radius)
    }

    /// `ln ρ` of a step, by a simulation of so many `steps` with a command that is `late` steps late.
    pub(super) fn measured(&self, lab: &Lab<'_>, late: f64, steps: u64) -> Result<f64, StudyError> {
        let Some(latency) = Latency::of_steps(late) else { return Ok(f64::NAN) };
        let setup = Setup::new(All(BaselineOnly(SPRING)), self.method)
            .controller(StateFeedback::to_origin(self.gains))
            .delay(Schedule::late(latency));
        let mut all = Loops::new(setup, self.dt, 0, [0.0], &[START], lab.alone()?)?;
        let mut logarithms = vec![size(&START).ln()];
        while all.step() < steps {
            all.advance(BETWEEN)?;
            let now = size(&all.state(0).unwrap_or(ORIGIN)).ln();
            if now.is_nan() || now.abs() > LARGEST {
                break;
            }
            logarithms.push(now);
        }
        Ok(growth(&logarithms) / BETWEEN as f64)
    }
}

/// `ln` of a number near one.
pub(super) fn logarithm(radius: Wide) -> f64 {
    (radius - Wide::one()).to_f64().ln_1p()
}

/// Twice the area of the triangle of the origin and two states.
pub(super) fn area(a: &State<f64, 1>, b: &State<f64, 1>) -> f64 {
    a.q[0] * b.v[0] - a.v[0] * b.q[0]
}

fn size(y: &State<f64, 1>) -> f64 {
    (SPRING.omega2 * y.q[0] * y.q[0] + y.v[0] * y.v[0]).sqrt()
}

/// The mean growth from one to the next, with weights that begin and end smoothly: for what swings on the way and for
/// what dies out at the beginning the sum falls faster than any power of its length (S. Das, Y. Saiki,
/// E. Sander, J. A. Yorke, *Quantitative quasiperiodicity*, Nonlinearity 30, 2017).
fn growth(logarithms: &[f64]) -> f64 {
    let count = logarithms.len() as f64;
    let (mut sum, mut weights) = (0.0, 0.0);
    for (i, pair) in logarithms.windows(2).enumerate() {
        let place = (i as f64 + 1.0) / count;
        let weight = (-1.0 / (place * (1.0 - place))).exp();
        sum += weight * (pair[1] - pair[0]);
        weights += weight;
    }
    sum / weights
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn growth_is_found_beneath_a_swing_and_a_transient() {
        let of = |n: u32| {
            let n = f64::from(n);
            -0.003 * n + (1.5 + (0.37 * n).sin() + 4.0 * (-0.05 * n).exp()).ln()
        };
        let logarithms: Vec<f64> = (0..2000).map(of).collect();
        // A plain mean of as many would be off by some 10⁻⁴, from the transient alone.
        let error = growth(&logarithms) + 0.003;
        assert!(error.abs() < 1e-8, "{error}");
    }
}
