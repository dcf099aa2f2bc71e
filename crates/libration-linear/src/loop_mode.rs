//! Modes of a loop.

use core::f64::consts::{PI, TAU};

use num_complex::Complex64;

use crate::loop_growth::product;
use crate::plant_modes::largest;
use crate::{LinearLoop, LinearLoopError, LoopTiming, Matrix, eigenvalues, eigenvector};

/// A mode of a loop, from period to period.
#[derive(Clone, Debug, PartialEq)]
pub struct LoopMode {
    /// The factor by which it grows in a period; of a schedule of controllers the mean over its periods.
    pub radius: f64,
    /// The angle by which it turns in a period, from 0 to π rad: 0 without oscillation, and π where it changes its sign with every
    /// period. Under a schedule of controllers a mode has several, of which this has the largest part of its motion.
    pub angle: f64,
    /// The states of the plant that move most, with their sizes relative to the largest: at least a tenth of it, at most four.
    pub states: Vec<(String, f64)>,
}

impl LinearLoop {
    /// The modes of the loop without jitter and losses, the one that grows fastest first; of a pair one, and at most `count`.
    ///
    /// # Errors
    /// [`LinearLoopError`]: an invalid timing.
    pub fn modes(
        &self,
        timing: &LoopTiming,
        count: usize,
    ) -> Result<Vec<LoopMode>, LinearLoopError> {
        let steps = self.period_matrices(timing)?;
        let matrix = product(&steps);
        let mut values = eigenvalues(&matrix).unwrap_or_default();
        values.retain(|value| value.im >= 0.0);
        values.sort_by(|a, b| b.norm().total_cmp(&a.norm()));
        let states = &self.plant().states;
        let mode = |value: Complex64| {
            let shape = eigenvector(&matrix, value).unwrap_or_default();
            let shown = &shape[..states.len().min(shape.len())];
            let periods = steps.len() as f64;
            LoopMode {
                radius: value.norm().powf(periods.recip()),
                angle: angle(&steps, value, &shape, states.len()),
                states: largest(states, shown),
            }
        };
        Ok(values.into_iter().take(count).map(mode).collect())
    }
}

/// The angle per period of a mode with this multiplier over all steps and this shape before the first.
///
/// In `r` steps a multiplier of angle `φ` turns by `(φ + 2πj)/r` each, for every `j` (G. Floquet, 1883). The states of the plant in the
/// course of the steps have a part with each of these angles, and the largest one counts, each state in its own size.
fn angle(steps: &[Matrix], value: Complex64, shape: &[Complex64], states: usize) -> f64 {
    let count = steps.len();
    if count == 1 || shape.is_empty() {
        return value.arg();
    }
    let pace = value.norm().powf((count as f64).recip());
    let mut course = vec![shape.to_vec()];
    for step in &steps[..count - 1] {
        let last = &course[course.len() - 1];
        let [re, im] = [|x: &Complex64| x.re, |x: &Complex64| x.im]
            .map(|part| step.apply(&last.iter().map(part).collect::<Vec<f64>>()));
        let next = re.into_iter().zip(im).map(|(re, im)| Complex64::new(re, im) / pace);
        course.push(next.collect());
    }
    let parts = |angle: f64, i: usize| {
        let turned = course.iter().enumerate();
        let sum: Complex64 =
            turned.map(|(k, x)| x[i] * Complex64::from_polar(1.0, -angle * k as f64)).sum();
        sum.norm_sqr()
    };
    let all: Vec<f64> = (0..count).map(|j| (value.arg() + TAU * j as f64) / count as f64).collect();
    let totals: Vec<f64> =
        (0..states).map(|i| all.iter().map(|&angle| parts(angle, i)).sum()).collect();
    let size = |angle: f64| -> f64 {
        (0..states).filter(|&i| totals[i] > 0.0).map(|i| parts(angle, i) / totals[i]).sum()
    };
    let most = all.into_iter().map(|angle| (angle, size(angle))).max_by(|a, b| a.1.total_cmp(&b.1));
    let (angle, _) = most.unwrap_or((value.arg(), 0.0));
    // From 0 to π, as of the pair the one with the other sign.
    if angle > PI { TAU - angle } else { angle }
}

#[cfg(test)]
mod tests {
    use libration_core::control::Latency;

    use super::*;
    use crate::{ControllerSchedule, DiscreteController, LinearPlant};

    #[test]
    fn a_schedule_of_equal_controllers_has_the_modes_of_one() {
        let a = Matrix::from_rows(&[[0.0, 1.0], [-400.0, -0.5]]).unwrap();
        let b = Matrix::from_rows(&[[0.0], [1.0]]).unwrap();
        let plant = LinearPlant::new(a, b, Matrix::identity(2), Matrix::zeros(2, 1)).unwrap();
        let controller = DiscreteController::gain(Matrix::from_rows(&[[-3.0, -2.0]]).unwrap());
        let cost = Matrix::identity(3);
        let one = LinearLoop::new(plant, controller.clone(), 0.06, cost, vec![0.0; 2]).unwrap();
        let timing =
            LoopTiming { input_latency: vec![Latency::of_steps(0.7).unwrap()], ..one.ideal() };
        let wanted = one.modes(&timing, 9).unwrap();
        // The plant turns by 1.2 rad per period, which five periods take for less.
        assert!(wanted.iter().any(|mode| (0.9..1.5).contains(&mode.angle)), "{wanted:?}");
        for periods in [2, 3, 5, 8] {
            let schedule = ControllerSchedule::new(vec![controller.clone(); periods]).unwrap();
            let several = one.with_controller(schedule).unwrap();
            // The fastest; of those that vanish in many periods rounding leaves little.
            let found = &several.modes(&timing, 9).unwrap()[0];
            assert!((found.radius - wanted[0].radius).abs() < 1e-12, "{found:?}");
            assert!((found.angle - wanted[0].angle).abs() < 1e-10, "{periods}: {found:?}");
            assert_eq!(found.states[0].0, wanted[0].states[0].0);
            for (a, b) in [
                (several.growth(&timing).unwrap(), one.growth(&timing).unwrap()),
                (
                    several.stationary(&timing).unwrap().unwrap().cost,
                    one.stationary(&timing).unwrap().unwrap().cost,
                ),
            ] {
                assert!((a / b - 1.0).abs() < 1e-12, "{periods}: {a} {b}");
            }
        }
    }
}
