//! Design of a steady-state Kalman observer.

use libration_core::control::StateObserver;
use libration_core::number::Wide;
use libration_core::{Scalar, State};
use libration_linear::{Matrix, StepIntegrals};

use super::riccati::riccati;
use super::{LqrError, Plant, ZohStep};

/// The noise intensities of an observer design.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObserverNoise {
    /// The intensity of the white noise that accelerates the plant, in (m/s²)²·s.
    pub acceleration: f64,
    /// The variance of the measured position at a sample, in m².
    pub position: f64,
}

impl Plant<'_> {
    /// The observer of the least variance under this noise: the stationary Kalman filter of the step that is shipped.
    ///
    /// Its correction follows from the covariance of what is foretold, which solves the Riccati equation of the transposed step (G. F.
    /// Franklin, J. D. Powell, M. L. Workman, *Digital Control of Dynamic Systems*, 3rd ed., section 9.4).
    ///
    /// # Errors
    /// [`LqrError::CommandWeight`] if the variance of the position is not above zero, [`LqrError::StateWeight`] if the intensity is
    /// not, and [`LqrError::Unsettled`] if there is no such filter.
    pub fn observer(&self, noise: ObserverNoise) -> Result<StateObserver, LqrError> {
        let ObserverNoise { acceleration, position } = noise;
        if !(acceleration.is_finite() && acceleration > 0.0) {
            return Err(LqrError::StateWeight { of: "acceleration", weight: acceleration });
        }
        if !(position.is_finite() && position > 0.0) {
            return Err(LqrError::CommandWeight(position));
        }
        let ZohStep { phi, gamma } = (self.step)(self.dt);
        let gamma = [gamma.q[0], gamma.v[0]].map(Wide::to_f64);
        let entries = self.noise_of(gamma).map(|row| row.map(|x| Wide::from_f64(x * acceleration)));
        let covariance = super::riccati::Matrix {
            dq: State { q: [entries[0][0]], v: [entries[1][0]] },
            dv: State { q: [entries[0][1]], v: [entries[1][1]] },
        };
        let seen = State { q: [Wide::one()], v: [Wide::ZERO] };
        let variance = Wide::from_f64(position);
        let foretold = riccati(phi.transposed(), seen, covariance, variance);
        let foretold = foretold.ok_or(LqrError::Unsettled)?;
        let [qq, vq] = [0, 1].map(|i| foretold.entry(i, 0));
        let correction = [qq, vq].map(|x| (x / (qq + variance)).to_f64());
        Ok(self.observer_with(correction))
    }

    /// The observer with these gains on the prediction error of the position.
    pub fn observer_with(&self, correction: [f64; 2]) -> StateObserver {
        let ZohStep { phi, gamma } = (self.step)(self.dt);
        let gamma = [gamma.q[0], gamma.v[0]].map(Wide::to_f64);
        let phi = [0, 1].map(|i| [0, 1].map(|j| phi.entry(i, j).to_f64()));
        StateObserver { phi, gamma, correction }
    }

    /// The covariance of what noise of unit intensity adds in a step.
    fn noise_of(&self, gain: [f64; 2]) -> [[f64; 2]; 2] {
        let h = self.dt.to_f64();
        if !self.exact {
            // A constant acceleration of variance 1/h.
            return gain.map(|a| gain.map(|b| a * b / h));
        }
        let ([a, b], intensity) = (self.matrices(), Matrix::diagonal(&[0.0, 1.0]));
        let noise = StepIntegrals::new(&a, &b, &intensity, &Matrix::zeros(3, 3), h).noise;
        [0, 1].map(|i| [0, 1].map(|j| noise[(i, j)]))
    }
}

#[cfg(test)]
mod tests {
    use libration_core::control::Feedback;
    use libration_core::control::controller::Luenberger;
    use libration_core::integrator::VelocityVerlet;
    use libration_core::system::Oscillator;

    use super::super::sample::{ORIGIN, all};
    use super::super::{Imperfections, LinearController};
    use super::*;

    const MODEL: Oscillator<f64> = Oscillator { omega2: 10.0 };
    const NOISE: ObserverNoise = ObserverNoise { acceleration: 1.0, position: 1e-4 };

    /// The larger eigenvalue of a matrix, in size.
    fn radius([[a, b], [c, d]]: [[f64; 2]; 2]) -> f64 {
        let (half, determinant) = ((a + d) / 2.0, a * d - b * c);
        let under = half * half - determinant;
        if under < 0.0 { determinant.sqrt() } else { half.abs() + under.sqrt() }
    }

    #[test]
    fn loop_and_observer_decay_each_by_itself() {
        let gains = Feedback { position: 4.0, velocity: 2.0 };
        for (name, plant) in all(MODEL, 0.05) {
            let observer = plant.observer(NOISE).unwrap();
            let StateObserver { phi, gamma, correction: [lq, lv] } = observer;
            let [kp, kd] = [gains.position, gains.velocity];
            let closed = [0, 1].map(|i| [phi[i][0] - gamma[i] * kp, phi[i][1] - gamma[i] * kd]);
            // (1 − LC)Φ has the eigenvalues of what is left of an error.
            let left = [0, 1].map(|j| [(1.0 - lq) * phi[0][j], phi[1][j] - lv * phi[0][j]]);
            let left = [[left[0][0], left[1][0]], [left[0][1], left[1][1]]];
            let controller = Luenberger::to_origin(gains, observer);
            let linear = LinearController::of(&controller, 0.05).unwrap();
            let found = plant.mean_square_growth(&linear, &Imperfections::NONE).unwrap();
            let wanted = 2.0 * radius(closed).max(radius(left)).ln();
            assert!((found - wanted).abs() < 1e-9, "{name}: {found} {wanted}");
            assert!(radius(left) < 0.9, "{name}");
        }
    }

    #[test]
    fn any_other_correction_is_off_by_more() {
        let plant = Plant::exact(MODEL, ORIGIN, 0.05);
        let best = plant.observer(NOISE).unwrap();
        // The covariance of what is foretold, by plain iteration: P ← Φ(1 − LC)P(1 − LC)ᵀΦᵀ + ΦLrLᵀΦᵀ + W.
        let noise = plant.noise_of([0.0; 2]);
        let off = |correction: [f64; 2]| {
            let mut p = [[0.0; 2]; 2];
            for _ in 0..2000 {
                let rest = [[1.0 - correction[0], 0.0], [-correction[1], 1.0]];
                let times = |a: [[f64; 2]; 2], b: [[f64; 2]; 2]| {
                    [0, 1].map(|i| [0, 1].map(|j| a[i][0] * b[0][j] + a[i][1] * b[1][j]))
                };
                let across = |a: [[f64; 2]; 2]| [[a[0][0], a[1][0]], [a[0][1], a[1][1]]];
                let m = times(best.phi, rest);
                let l =
                    [0, 1].map(|i| best.phi[i][0] * correction[0] + best.phi[i][1] * correction[1]);
                let moved = times(times(m, p), across(m));
                p = [0, 1].map(|i| {
                    [0, 1].map(|j| moved[i][j] + l[i] * l[j] * NOISE.position + noise[i][j])
                });
            }
            p[0][0] + p[1][1]
        };
        let least = off(best.correction);
        for (q, v) in [(0.02, 0.0), (-0.02, 0.0), (0.0, 0.2), (0.0, -0.2)] {
            let [lq, lv] = best.correction;
            assert!(off([lq + q, lv + v]) > least, "{q} {v}");
        }
    }

    #[test]
    fn noise_that_is_none_is_refused() {
        let plant = Plant::new(VelocityVerlet, MODEL, ORIGIN, 0.1);
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let noise = ObserverNoise { acceleration: bad, ..NOISE };
            assert!(matches!(plant.observer(noise), Err(LqrError::StateWeight { .. })));
            let noise = ObserverNoise { position: bad, ..NOISE };
            assert!(matches!(plant.observer(noise), Err(LqrError::CommandWeight(_))));
        }
    }
}
