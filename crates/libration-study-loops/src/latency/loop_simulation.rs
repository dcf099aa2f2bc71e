//! Simulated loops and their growth.

use libration::analysis::{LatencyWindows, Plant};
use libration::control::controller::StateFeedback;
use libration::control::{Feedback, Latency, Schedule};
use libration::ensemble::{All, Loops, Setup};
use libration::number::Wide;
use libration::system::{BaselineOnly, Oscillator};
use libration::{Method, Scalar, State};
use libration_study::{Lab, StudyError};

use super::mean_growth::growth;

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
