//! Loops whose step times repeat a record.

use libration_core::control::{Jitter, LqrWeights};
use libration_linear::RecordedSchedule;

use super::imperfections::{MOST_RANDOM, MOST_RECORDED};
use super::{CostError, Imperfections, LinearController, Plant};

impl Plant<'_> {
    /// The mean growth rate of second moments per step, over `steps`, of the loop that `controller` closes. The lengths of its steps,
    /// in periods, repeat `steps` in this order. `imperfections` are the other imperfections; their jitter is ignored.
    ///
    /// By [`RecordedSchedule`]; steps are rounded to 2⁻¹⁴ of a period.
    ///
    /// # Errors
    /// [`CostError`], as for [`Plant::cost`], and [`CostError::Step`].
    pub fn recorded_growth(
        &self,
        controller: &LinearController,
        imperfections: &Imperfections,
        steps: &[f64],
    ) -> Result<f64, CostError> {
        Ok(self.recorded_schedule(controller, imperfections, steps, None)?.growth())
    }

    /// The stationary cost of that loop, as [`Plant::cost`] has it.
    ///
    /// # Errors
    /// As for [`Plant::recorded_growth`].
    pub fn recorded_cost(
        &self,
        controller: &LinearController,
        imperfections: &Imperfections,
        steps: &[f64],
        weights: LqrWeights,
    ) -> Result<f64, CostError> {
        Ok(self.recorded_schedule(controller, imperfections, steps, Some(weights))?.cost())
    }

    fn recorded_schedule(
        &self,
        controller: &LinearController,
        imperfections: &Imperfections,
        steps: &[f64],
        weights: Option<LqrWeights>,
    ) -> Result<RecordedSchedule, CostError> {
        if let Some(&wrong) = steps.iter().find(|step| !(**step >= 0.0 && step.is_finite())) {
            return Err(CostError::Step(wrong));
        }
        if !steps.iter().any(|step| *step > 0.0) {
            return Err(CostError::Step(0.0));
        }
        // What holds for all steps is checked where they are all alike.
        let even = Imperfections { jitter: Jitter::Gaussian(0.0), ..*imperfections };
        let periods = self.periods(controller, &even, weights)?;
        let Imperfections { skew, loss, .. } = even;
        let most = if loss > 0.0 { MOST_RECORDED } else { MOST_RANDOM };
        if periods.size() > most {
            return Err(CostError::Size { size: periods.size() });
        }
        let dt = self.dt.to_f64() * (1.0 + skew);
        Ok(RecordedSchedule::new(steps, loss > 0.0, |length| {
            let arrives = [(1.0 - loss, false), (loss, true)].into_iter();
            let arrives = arrives.filter(|(share, _)| *share > 0.0);
            arrives.map(|(share, lost)| periods.stage(share, dt * length, lost)).collect()
        }))
    }
}

#[cfg(test)]
mod tests {
    use libration_core::control::{Feedback, Latency};
    use libration_core::system::Oscillator;
    use libration_linear::Matrix;

    use super::super::sample::{ORIGIN, textbook};
    use super::*;

    const MODEL: Oscillator<f64> = Oscillator { omega2: 10.0 };
    const WEIGHTS: LqrWeights = LqrWeights { position: 5.0, velocity: 0.5, command: 0.1 };

    fn late(steps: f64, loss: f64) -> Imperfections {
        Imperfections { latency: Latency::of_steps(steps).unwrap(), loss, ..Imperfections::NONE }
    }

    #[test]
    fn a_record_of_even_steps_is_a_loop_of_even_steps() {
        let gains = Feedback { position: 4.0, velocity: 1.0 }.into();
        for (name, plant) in textbook(MODEL, 0.1) {
            for (steps, loss) in [(0.0, 0.0), (1.5, 0.0), (1.0, 0.1), (0.7, 0.2)] {
                let late = late(steps, loss);
                for record in [&[1.0][..], &[1.0; 7]] {
                    let growth = plant.mean_square_growth(&gains, &late).unwrap();
                    let found = plant.recorded_growth(&gains, &late, record).unwrap();
                    assert!((found - growth).abs() < 1e-11, "{name} {steps}: {found} {growth}");
                    let cost = plant.cost(&gains, &late, WEIGHTS).unwrap();
                    let found = plant.recorded_cost(&gains, &late, record, WEIGHTS).unwrap();
                    let alike = found == cost || (found / cost - 1.0).abs() < 1e-10;
                    assert!(alike, "{name} {steps}: {found} {cost}");
                }
            }
        }
    }

    #[test]
    fn steps_in_blocks_grow_as_the_products_of_their_maps_say() {
        // Of a free mass under a strong damper v' = (1 − K·h)·v: −1.1 of long steps, 0.7 of short ones.
        let plant = Plant::exact(Oscillator { omega2: 0.0 }, ORIGIN, 0.1);
        let gains = Feedback { position: 0.0, velocity: 12.0 }.into();
        let velocity = LqrWeights { position: 0.0, velocity: 1.0, command: 0.0 };
        let record: Vec<f64> = (0..40).map(|i| if i < 20 { 1.75 } else { 0.25 }).collect();
        let none = Imperfections::NONE;
        // Positions stay: nothing pulls them.
        let held = Feedback { position: 1e-3, velocity: 12.0 }.into();
        assert!(plant.recorded_growth(&gains, &none, &record).unwrap().abs() < 1e-9);
        assert!(plant.recorded_growth(&held, &none, &record).unwrap() < -1e-9);
        // Twenty long steps carry noise up by 1.1² each; an even clock, and one that alternates, never do.
        let at = |record: &[f64]| plant.recorded_cost(&held, &none, record, velocity).unwrap();
        let alternating: Vec<f64> = (0..40).map(|i| [1.75, 0.25][i % 2]).collect();
        assert!(at(&record) > 3.0 * at(&alternating) && at(&alternating) > at(&[1.0]));
        let longer: Vec<f64> = (0..400).map(|i| if i < 200 { 1.75 } else { 0.25 }).collect();
        assert!(at(&longer) > 1e6 * at(&record), "{} {}", at(&longer), at(&record));
        let all_long = plant.recorded_growth(&held, &none, &[1.75]).unwrap();
        assert!((all_long - 2.0 * 1.1_f64.ln()).abs() < 1e-3, "{all_long}");
        assert_eq!(plant.recorded_cost(&held, &none, &[1.75], velocity), Ok(f64::INFINITY));
    }

    #[test]
    fn losses_in_a_record_are_those_of_a_plain_recursion() {
        let plant = Plant::exact(MODEL, ORIGIN, 0.1);
        let gains: LinearController = Feedback { position: 4.0, velocity: 1.0 }.into();
        let (late, record) = (late(1.0, 0.3), [1.5, 0.5, 1.25]);
        let found = plant.recorded_growth(&gains, &late, &record).unwrap();
        // Three steps after each other, each as a law of its own that draws nothing but the loss.
        let mut moments = Matrix::identity(4);
        let mut logarithms = vec![0.0];
        for i in 0..30_000 {
            let skew = record[i % 3] - 1.0;
            let stages = plant.stages(&gains, &Imperfections { skew, ..late }, None).unwrap();
            let mut sum = Matrix::zeros(4, 4);
            for stage in &stages {
                sum.add_scaled(stage.weight, &stage.step.congruence(&moments));
            }
            let size = sum.largest();
            moments = sum.scaled(size.recip());
            logarithms.push(logarithms[i] + size.ln());
        }
        // What turns beside the fastest motion has died out after half of them.
        let wanted = (logarithms[30_000] - logarithms[15_000]) / 15_000.0;
        assert!((found - wanted).abs() < 1e-9, "{found} {wanted}");
    }

    #[test]
    fn steps_that_are_none_are_refused() {
        let plant = Plant::exact(MODEL, ORIGIN, 0.1);
        let gains = Feedback::default().into();
        for record in [&[][..], &[0.0, 0.0], &[1.0, -0.5], &[f64::NAN]] {
            let refused = plant.recorded_growth(&gains, &Imperfections::NONE, record).unwrap_err();
            assert!(refused.to_string().contains("of the record is"), "{record:?}");
        }
    }
}
