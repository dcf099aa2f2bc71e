//! Loops that are simulated, and how fast they grow.

use libration::analysis::{Feedback, Latency, Plant, Windows};
use libration::control::Schedule;
use libration::control::controller::StateFeedback;
use libration::ensemble::{All, Loops, Setup};
use libration::number::Wide;
use libration::system::Oscillator;
use libration::{Method, Scalar, State};

use crate::Lab;
use crate::study::StudyError;

/// The spring on which every loop of this study is closed: that of the source.
pub(super) const SPRING: Oscillator<f64> = Oscillator { omega2: crate::studies::source::OMEGA2 };

/// Where a plant is linearised, and where nothing happens.
pub(super) const ORIGIN: State<f64, 1> = State { q: [0.0], v: [0.0] };

/// Where loops start; no eigenvector of any of them.
pub(super) const START: State<f64, 1> = State { q: [1.0], v: [0.5] };

/// Steps from one look at the states to the next.
const BETWEEN: u64 = 62;

/// States are looked at as long as their sizes are within this and its inverse.
const LARGEST: f64 = 1e140;

/// Two states span so small a part of a square only if they lie on the eigenvector of a real eigenvalue.
const PARALLEL: f64 = 1e-9;

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

    /// All latencies at which it is stable, by theory.
    pub(super) fn windows(&self) -> Windows {
        self.plant().latency_windows(self.gains)
    }

    /// `ln ρ` of a step, by theory; NaN for a latency that is none.
    pub(super) fn predicted(&self, steps: f64) -> f64 {
        let radius = |d| logarithm(self.plant().spectral_radius(self.gains, d));
        Latency::of_steps(steps).map_or(f64::NAN, radius)
    }

    /// `ln ρ` of a step, by a simulation of so many `steps` with a command that is `late` steps late.
    pub(super) fn measured(
        &self,
        lab: &Lab<'_>,
        late: f64,
        steps: u64,
    ) -> Result<f64, StudyError> {
        let Some(latency) = Latency::of_steps(late) else { return Ok(f64::NAN) };
        let setup = Setup::new(All(SPRING), self.method)
            .controller(StateFeedback::to_origin(self.gains))
            .delay(Schedule::late(latency));
        let mut all = Loops::new(setup, self.dt, 0, [0.0], &[START], lab.alone()?)?;
        let mut go = |steps| -> Result<State<f64, 1>, StudyError> {
            all.advance(steps)?;
            Ok(all.state(0).unwrap_or(ORIGIN))
        };
        let (mut rate, mut taken) = (f64::NAN, 0);
        while taken < steps {
            let [first, second, third] = [go(BETWEEN)?, go(1)?, go(1)?];
            let fits = [first, third].iter().all(|y| {
                let size = size(y);
                size < LARGEST && size > 1.0 / LARGEST
            });
            if !fits {
                break;
            }
            rate = growth([first, second, third]);
            taken += BETWEEN + 2;
        }
        Ok(rate)
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

/// `ln ρ` from three neighbouring states, of which all but the two largest eigenvalues have died out: they are
/// `yₙ₊₂ = t·yₙ₊₁ − δ·yₙ`, and the areas between them say `t` and `δ` without any swing.
fn growth([first, second, third]: [State<f64, 1>; 3]) -> f64 {
    let span = area(&first, &second);
    if span.abs() < PARALLEL * size(&first) * size(&second) {
        return (size(&third) / size(&second)).ln();
    }
    let (half, product) = (area(&first, &third) / span / 2.0, area(&second, &third) / span);
    let discriminant = half * half - product;
    match discriminant < 0.0 {
        true => product.ln() / 2.0,
        false => (half.abs() + discriminant.sqrt()).ln(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn growth_is_that_of_the_larger_eigenvalue_of_any_map_of_the_plane() {
        // Turned by 0.1 and stretched; and two real eigenvalues of which one is negative.
        let (sine, cosine) = 0.1_f64.sin_cos();
        let turn = [[1.01 * cosine, -1.01 * sine], [1.01 * sine, 1.01 * cosine]];
        for (map, radius) in [(turn, 1.01_f64), ([[-1.25, 0.0], [0.5, 0.75]], 1.25)] {
            let next = |y: State<f64, 1>| State {
                q: [map[0][0] * y.q[0] + map[0][1] * y.v[0]],
                v: [map[1][0] * y.q[0] + map[1][1] * y.v[0]],
            };
            let (second, third) = (next(START), next(next(START)));
            let found = growth([START, second, third]);
            // Some ten roundings, over an angle of 0.1.
            assert!((found - radius.ln()).abs() < 1e-13, "{found}");
        }
    }
}
