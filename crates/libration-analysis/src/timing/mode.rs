//! The motion of a loop that decays last.

use libration_core::Scalar;
use libration_core::number::Wide;
use libration_linear::log_spectral_radius;

use super::{CostError, Imperfections, LinearController, Plant};
use crate::Complex;
use crate::eigenvalues::{characteristic_polynomial, roots};

/// The motion of a loop that decays last, or grows fastest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mode {
    /// The factor by which it grows in a step.
    pub radius: f64,
    /// The angle by which it turns in a step, from 0 to π rad: 0 where it does not swing, and π where it changes its sign with every
    /// step.
    pub angle: f64,
}

/// Steps after which the fastest motion is left alone.
const STEPS: u32 = 4096;

impl Plant<'_> {
    /// The motions of the loop that `controller` closes, with nothing wrong with it, that do not decay: the fastest first, and of a pair
    /// one.
    ///
    /// # Errors
    /// [`CostError`], as for [`Plant::cost`].
    pub fn unstable_modes(&self, controller: &LinearController) -> Result<Vec<Mode>, CostError> {
        let stages = self.stages(controller, &Imperfections::NONE, None)?;
        let mode = |root: Complex| {
            let (radius, angle) = (root.abs().to_f64(), root.arg().to_f64());
            (radius >= 1.0 && angle >= 0.0).then_some(Mode { radius, angle })
        };
        let matrix = &stages[0].step;
        let wide = |i| matrix.row(i).iter().map(|&x| Wide::from_f64(x)).collect();
        let step: Vec<Vec<Wide>> = (0..matrix.rows()).map(wide).collect();
        let all = roots(&characteristic_polynomial(&step));
        let mut modes: Vec<Mode> = all.into_iter().filter_map(mode).collect();
        modes.sort_by(|a, b| b.radius.total_cmp(&a.radius));
        Ok(modes)
    }

    /// The motion that decays last in the loop that `controller` closes with this latency and this skew; without jitter and losses,
    /// where there are no motions.
    ///
    /// It is found by letting the loop run, as the eigenvalue of largest size (or the pair), to some six digits; where several of
    /// different angles are as large, one of their mixtures.
    ///
    /// # Errors
    /// [`CostError`], as for [`Plant::cost`].
    pub fn slowest_mode(
        &self,
        controller: &LinearController,
        imperfections: &Imperfections,
    ) -> Result<Mode, CostError> {
        let none = Imperfections::NONE;
        let alone = Imperfections { jitter: none.jitter, loss: 0.0, ..*imperfections };
        let stages = self.stages(controller, &alone, None)?;
        let step = &stages[0].step;
        let mut state: Vec<f64> = (0..step.rows()).map(|i| 1.0 / (1.0 + i as f64)).collect();
        for _ in 0..STEPS {
            state = step.apply(&state);
            let size = state.iter().fold(0.0, |size: f64, x| size.max(x.abs()));
            if size == 0.0 {
                return Ok(Mode { radius: 0.0, angle: 0.0 });
            }
            state.iter_mut().for_each(|x| *x /= size);
        }
        let next = step.apply(&state);
        let last = step.apply(&next);
        let radius = log_spectral_radius(step).exp();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let (xx, xy, yy) = (dot(&state, &state), dot(&state, &next), dot(&next, &next));
        // Of a pair λ² = 2ρ cos θ·λ − ρ²; of one that is real all three lie on a line.
        let apart = xx * yy - xy * xy;
        if apart <= 1e-10 * xx * yy {
            return Ok(Mode { radius, angle: if xy < 0.0 { core::f64::consts::PI } else { 0.0 } });
        }
        let trace = (dot(&last, &next) * xx - dot(&last, &state) * xy) / apart;
        let angle = (trace / (2.0 * radius)).clamp(-1.0, 1.0).acos();
        Ok(Mode { radius, angle })
    }
}

#[cfg(test)]
mod tests {
    use libration_core::control::{Feedback, Latency};
    use libration_core::integrator::VelocityVerlet;
    use libration_core::system::Oscillator;

    use super::super::sample::{ORIGIN, textbook};
    use super::*;

    #[test]
    fn without_feedback_it_is_the_oscillator() {
        let model = Oscillator { omega2: 10.0 };
        let plant = Plant::exact(model, ORIGIN, 0.1);
        let found = plant.slowest_mode(&Feedback::default().into(), &Imperfections::NONE).unwrap();
        assert!((found.radius - 1.0).abs() < 1e-12, "{found:?}");
        assert!((found.angle - 0.1 * 10.0_f64.sqrt()).abs() < 1e-9, "{found:?}");
    }

    #[test]
    fn at_the_critical_latency_its_size_is_one_and_it_turns_as_the_crossing_says() {
        let feedback = Feedback { position: 10.0, velocity: 2.0 };
        for (name, plant) in textbook(Oscillator { omega2: 10.0 }, 0.02) {
            let Some(critical) = plant.split_critical_latency(feedback) else { continue };
            let latency = Latency::of_steps(critical).unwrap();
            let late = Imperfections { latency, ..Imperfections::NONE };
            let found = plant.slowest_mode(&feedback.into(), &late).unwrap();
            assert!((found.radius - 1.0).abs() < 1e-9, "{name}: {found:?}");
            // The continuous loop swings at its margin with (Ω² − 10)² = 10² + 4Ω²: Ω² = 24. Steps of order one are off by ωΔt/2.
            assert!((found.angle / 0.02 / 24.0_f64.sqrt() - 1.0).abs() < 0.06, "{name}: {found:?}");
        }
    }

    #[test]
    fn what_does_not_swing_has_no_angle_and_what_alternates_has_half_a_turn() {
        let free = Oscillator { omega2: 0.0 };
        let one = |position, velocity, dt| {
            let plant = Plant::new(VelocityVerlet, free, ORIGIN, dt);
            let feedback = Feedback { position, velocity };
            plant.slowest_mode(&feedback.into(), &Imperfections::NONE).unwrap().angle
        };
        assert_eq!(one(0.1, 2.0, 0.1), 0.0);
        assert_eq!(one(0.1, 25.0, 0.1), core::f64::consts::PI);
    }

    #[test]
    fn all_motions_that_grow_are_told_and_no_other() {
        // Upside down, (λ − e^{ωΔt})(λ − e^{−ωΔt}): one grows.
        let upright = Plant::exact(Oscillator { omega2: -9.0 }, ORIGIN, 0.1);
        let [one] = upright.unstable_modes(&Feedback::default().into()).unwrap()[..] else {
            panic!("one motion falls");
        };
        assert!((one.radius - 0.3_f64.exp()).abs() < 1e-12 && one.angle == 0.0, "{one:?}");
        // With velocities that are fed back the wrong way both do, and slowly enough they swing.
        let spring = Plant::exact(Oscillator { omega2: 10.0 }, ORIGIN, 0.01);
        let push = |velocity| Feedback { position: 0.0, velocity }.into();
        let swing = spring.unstable_modes(&push(-1.0)).unwrap();
        let slowest = spring.slowest_mode(&push(-1.0), &Imperfections::NONE).unwrap();
        assert!(swing.len() == 1 && (swing[0].radius - slowest.radius).abs() < 1e-9, "{swing:?}");
        assert!((swing[0].angle - slowest.angle).abs() < 1e-6, "{swing:?} {slowest:?}");
        let both = spring.unstable_modes(&push(-10.0)).unwrap();
        assert!(both.len() == 2 && both.iter().all(|mode| mode.angle == 0.0), "{both:?}");
        assert_eq!(spring.unstable_modes(&push(1.0)), Ok(Vec::new()));
    }

    #[test]
    fn a_step_of_many_is_the_step_itself_where_it_is_exact() {
        let model = Oscillator { omega2: 10.0 };
        let whole = Plant::exact(model, ORIGIN, 0.1).with_simulated_noise();
        let many = Plant::exact(model, ORIGIN, 0.1).with_simulated_noise().substeps(7);
        let gains = Feedback { position: 10.0, velocity: 2.0 }.into();
        let weights = whole.energy();
        let cost = |plant: &Plant<'_>| plant.cost(&gains, &Imperfections::NONE, weights).unwrap();
        assert!((cost(&whole) / cost(&many) - 1.0).abs() < 1e-12);
        // With a method of order two it comes as the square of the number.
        let method = |count| Plant::new(VelocityVerlet, model, ORIGIN, 0.1).substeps(count);
        let [two, four] = [2, 4].map(|count| cost(&method(count)) / cost(&whole) - 1.0);
        assert!((two / four - 4.0).abs() < 0.1, "{two} {four}");
    }
}
