//! The latency that an integrator adds to a loop.

use libration_core::Scalar;
use libration_core::number::Wide;

use super::{Plant, ZohStep};
use crate::Complex;

/// By how many steps a held command acts later in a simulated loop than in continuous time, beside any latency that
/// it is given.
#[derive(Clone, Copy, Debug)]
pub struct HiddenLatency {
    /// The latency of the position feedback, `K_p·q`.
    pub position: Wide,
    /// The latency of the velocity feedback, `K_d·v`.
    pub velocity: Wide,
}

/// The angle of a step at which the limit of low frequencies is taken, as a power of two: what is left out is its
/// square.
const LOW: i64 = -300;

impl Plant<'_> {
    /// The latency in steps that integrator and hold add to a slow command on its way to the state.
    ///
    /// The step takes a command to the state by `adj(λ − Φ)Γ/det(λ − Φ)` with `λ = e^{sΔt}`, the plant by `(1, s)` over its
    /// own polynomial. `det(λ − Φ)/λ` is the free motion: with eigenvalues `e^{pΔt}` it is the product of `2·sinh((s − p)Δt/2)`,
    /// but for a constant, which shifts phases as `s − p` does. What `adj(λ − Φ)Γ/λ` shifts beside `(1, s)` is the latency.
    /// A hold alone has half a step (K. J. Åström, B. Wittenmark, *Computer-Controlled Systems*, 3rd ed., 1997).
    ///
    /// None where a constant command does not in the end move the plant to rest at another position, as at the
    /// largest stable step of velocity Verlet.
    pub fn hidden_latency(&self) -> Option<HiddenLatency> {
        self.shift(Wide::one().scaled(LOW))
    }

    /// The hidden latency at the frequency of this angle per step.
    fn shift(&self, angle: Wide) -> Option<HiddenLatency> {
        let ZohStep { phi, gamma } = (self.step)(self.dt);
        // adj(λ − Φ)Γ = λΓ + (Φ − trace)Γ.
        let rest = phi.apply(&gamma).plus(-phi.trace(), gamma);
        let (im, re) = angle.sin_cos();
        let through = |gamma: Wide, rest: Wide| Complex { re: gamma * re + rest, im: gamma * im };
        let position = through(gamma.q[0], rest.q[0]);
        let velocity = through(gamma.v[0], rest.v[0]);
        // Of the velocity, the plant turns by a right angle; a negative factor is none of latency.
        let latency = |along: Wide, across: Wide| {
            let turned = if along.is_negative() { -across } else { across }.atan2(along.abs());
            let steps = (angle - turned) / angle;
            // An angle that does not vanish with the frequency is no latency.
            (!along.is_zero() && !steps.is_nan() && steps.exponent().is_none_or(|e| e < -LOW / 2))
                .then_some(steps)
        };
        Some(HiddenLatency {
            position: latency(position.re, position.im)?,
            velocity: latency(velocity.im, -velocity.re)?,
        })
    }
}

#[cfg(test)]
mod tests {
    use libration_core::control::Feedback;
    use libration_core::integrator::{Rk4, SymplecticEulerDriftFirst, VelocityVerlet};
    use libration_core::system::{DampedOscillator, Oscillator};

    use super::super::sample::{ORIGIN, all, textbook};
    use super::*;

    const MODEL: Oscillator<f64> = Oscillator { omega2: 10.0 };

    fn found(plant: &Plant<'_>) -> [f64; 2] {
        let HiddenLatency { position, velocity } = plant.hidden_latency().unwrap();
        [position, velocity].map(Wide::to_f64)
    }

    #[test]
    fn a_hold_and_a_symmetric_method_hide_half_a_step_and_the_eulers_none_or_one_of_position() {
        for dt in [0.01, 0.1, 0.3] {
            let latencies = textbook(MODEL, dt).into_iter().map(|(_, plant)| found(&plant));
            // RK4 is symmetric but for an error of its order, which by its matrices begins with −z⁴/144.
            let z = 10.0_f64.sqrt() * dt;
            let runge_kutta = 0.5 - z.powi(4) / 144.0;
            let wanted = [[1.0, 0.5], [0.0, 0.5], [0.5, 0.5], [runge_kutta, 0.5], [0.5, 0.5]];
            for (i, (found, wanted)) in latencies.zip(wanted).enumerate() {
                let error = if i == 3 { z.powi(6) / 144.0 } else { 1e-15 };
                for (found, wanted) in found.into_iter().zip(wanted) {
                    assert!((found - wanted).abs() < error, "{i} {dt}: {found} {wanted}");
                }
            }
        }
    }

    #[test]
    fn a_drift_before_the_kick_hides_a_step_of_the_position() {
        let plant = Plant::new(SymplecticEulerDriftFirst, MODEL, ORIGIN, 0.1);
        let [position, velocity] = found(&plant);
        assert!((position - 1.0).abs() < 1e-15 && (velocity - 0.5).abs() < 1e-15, "{position}");
    }

    #[test]
    fn it_is_the_same_at_every_frequency_where_the_step_is_symmetric() {
        for (i, (name, plant)) in textbook(MODEL, 0.1).into_iter().enumerate() {
            if i == 3 {
                continue;
            }
            let HiddenLatency { position, velocity } = plant.hidden_latency().unwrap();
            for angle in [0.01, 0.3, 1.0, 1.5] {
                let at = plant.shift(Wide::from_f64(angle)).unwrap();
                assert!((at.position - position).abs().to_f64() < 1e-80, "{name} {angle}");
                assert!((at.velocity - velocity).abs().to_f64() < 1e-80, "{name} {angle}");
            }
        }
    }

    #[test]
    fn every_method_has_it_and_damping_changes_it_by_a_part_of_a_step() {
        for (name, plant) in all(DampedOscillator { omega2: 10.0, gamma: 0.5 }, 0.01) {
            let [position, velocity] = found(&plant);
            // The command of a step acts at its beginning at the earliest, and within it; damping moves that by γΔt.
            assert!((-0.006..=1.006).contains(&position), "{name} {position}");
            assert!((velocity - 0.5).abs() < 1e-80, "{name} {velocity}");
        }
    }

    #[test]
    fn it_is_what_the_critical_latency_lacks_of_the_delay_margin() {
        let lost = |plant: &Plant<'_>, feedback| {
            let margin = plant.delay_margin(feedback).unwrap().to_f64() / plant.dt.to_f64();
            margin - plant.latency_windows(feedback).critical().unwrap()
        };
        // Of the velocity alone. Explicit Euler loses more: its free motion grows.
        let slow = Feedback { position: 0.0, velocity: 1.0 };
        for (name, plant) in textbook(MODEL, 0.01).into_iter().skip(1) {
            let [_, velocity] = found(&plant);
            // Beside it comes an error of first order, Δt·K_d/2 and the like: 0.0025 steps were found.
            assert!((lost(&plant, slow) - velocity).abs() < 5e-3, "{name}");
        }
        // Of the position alone, where damping keeps the loop stable; RK4 and exact steps get damping right.
        let model = DampedOscillator { omega2: 10.0, gamma: 1.0 };
        let stiff = Feedback { position: 8.0, velocity: 0.0 };
        for plant in [Plant::new(Rk4, model, ORIGIN, 0.01), Plant::exact(model, ORIGIN, 0.01)] {
            let [position, _] = found(&plant);
            assert!((lost(&plant, stiff) - position).abs() < 5e-3, "{}", lost(&plant, stiff));
        }
    }

    #[test]
    fn a_step_that_moves_the_position_alone_has_none() {
        // At z = 2 the command of velocity Verlet leaves the velocity as it is.
        let edge = Plant::new(VelocityVerlet, Oscillator { omega2: 4.0 }, ORIGIN, 1.0);
        assert!(edge.hidden_latency().is_none());
        assert!(Plant::new(Rk4, MODEL, ORIGIN, f64::NAN).hidden_latency().is_none());
    }
}
