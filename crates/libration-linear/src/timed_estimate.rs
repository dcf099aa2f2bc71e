//! Feedback of an estimate whose time update has the measured length of a period.

use crate::{DiscreteController, Discretisation, LinearPlant, Matrix};

impl LinearPlant {
    /// The controller `u = −K x̂` with the state estimated by the filter of gain `L`, after a period of `passed` seconds.
    ///
    /// Its memory is the last estimate and the last command: `x̃ = Φx̂₋ + Γu₋` over the seconds that have passed, and
    /// `x̂ = x̃ + L(y − Cx̃ − Du₋)`. The gains are those of the nominal period. Where that has passed, it is the controller of
    /// [`LinearPlant::estimated_feedback`], whose memory is `x̃`.
    pub fn timed_feedback(
        &self,
        gain: &Matrix,
        filter: &Matrix,
        passed: f64,
    ) -> DiscreteController {
        let Discretisation { phi, gamma } = self.step(passed);
        let (n, m) = (self.states.len(), self.inputs.len());
        // x̃ and then x̂ over the memory.
        let mut predicted = Matrix::zeros(n, n + m);
        predicted.set_block((0, 0), &phi);
        predicted.set_block((0, n), &gamma);
        let mut expected = &self.c * &predicted;
        for j in 0..self.outputs.len() {
            for i in 0..m {
                expected[(j, n + i)] += self.d[(j, i)];
            }
        }
        let mut estimate = predicted;
        estimate.add_scaled(-1.0, &(filter * &expected));
        let c = (gain * &estimate).scaled(-1.0);
        let d = (gain * filter).scaled(-1.0);
        let mut a = Matrix::zeros(n + m, n + m);
        a.set_block((0, 0), &estimate);
        a.set_block((n, 0), &c);
        let mut b = Matrix::zeros(n + m, self.outputs.len());
        b.set_block((0, 0), filter);
        b.set_block((n, 0), &d);
        DiscreteController { a, b, c, d }
    }
}

#[cfg(test)]
mod tests {
    use libration_core::control::{Jitter, Latency};

    use super::*;
    use crate::{ClockedController, CostWeights, LinearLoop, LoopTiming, Simulation};

    /// A pendulum upside down, of which the angle is measured.
    fn pendulum() -> LinearPlant {
        let a = Matrix::from_rows(&[[0.0, 1.0], [9.0, -0.2]]).unwrap();
        let b = Matrix::from_rows(&[[0.0], [1.0]]).unwrap();
        let c = Matrix::from_rows(&[[1.0, 0.0]]).unwrap();
        LinearPlant::new(a, b, c, Matrix::zeros(1, 1)).unwrap()
    }

    /// The loop with the nominal clock and with the measured one.
    fn loops() -> [LinearLoop; 2] {
        let plant = pendulum();
        let weights = CostWeights {
            states: Matrix::diagonal(&[10.0, 1.0]),
            inputs: Matrix::diagonal(&[0.1]),
        };
        let period = 0.1;
        let gain = plant.design_regulator(&weights, period).unwrap().gain;
        let filter = plant.design_filter(&Matrix::diagonal(&[1e-3]), period).unwrap();
        let controller = plant.estimated_feedback(&gain, &filter, period);
        let form = weights.form();
        let nominal = LinearLoop::new(plant.clone(), controller, period, form, vec![1e-3]).unwrap();
        let of_length = move |seconds| plant.timed_feedback(&gain, &filter, seconds);
        let clocked = ClockedController::new(period, of_length);
        let measured = nominal.with_measured_clock(clocked).unwrap();
        [nominal, measured]
    }

    #[test]
    fn without_jitter_both_clocks_are_the_same_and_with_little_nearly() {
        let [nominal, measured] = loops();
        let mut timing = nominal.ideal();
        timing.input_latency = vec![Latency::of_steps(0.6).unwrap()];
        timing.output_latency = vec![Latency::of_steps(0.3).unwrap()];
        let cost = |linear: &LinearLoop, timing: &LoopTiming| {
            linear.stationary(timing).unwrap().unwrap().cost
        };
        let found = [&nominal, &measured]
            .map(|linear| (linear.growth(&timing).unwrap(), cost(linear, &timing)));
        assert!((found[0].0 / found[1].0 - 1.0).abs() < 1e-11, "{found:?}");
        assert!((found[0].1 / found[1].1 - 1.0).abs() < 1e-11, "{found:?}");
        // The layout that ends with the controller: deviations of 10⁻⁶ change costs by their square, 10⁻¹², times some.
        timing.jitter = Jitter::Gaussian(1e-6);
        let little = cost(&measured, &timing);
        assert!((little / found[0].1 - 1.0).abs() < 1e-9, "{little} {found:?}");
    }

    #[test]
    fn an_estimate_that_measures_time_costs_less_under_jitter_as_predicted_and_simulated() {
        let [nominal, measured] = loops();
        for (skew, loss) in [(0.0, 0.0), (0.1, 0.2)] {
            let timing = LoopTiming {
                jitter: Jitter::Uniform(0.3),
                skew,
                loss,
                input_latency: vec![Latency::of_steps(0.25).unwrap()],
                ..nominal.ideal()
            };
            let of = |linear: &LinearLoop| linear.stationary(&timing).unwrap().unwrap().cost;
            assert!(of(&measured) < of(&nominal), "{} {}", of(&measured), of(&nominal));
            let predicted = of(&measured.with_held_noise());
            let one = Simulation { linear: &measured, timing: &timing, record: None, seed: 3 };
            let costs: Vec<f64> = (0..48).map(|k| one.mean_cost(k, 200, 2000)).collect();
            let mean = costs.iter().sum::<f64>() / 48.0;
            let variance = costs.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / 47.0;
            let z = (mean - predicted) / (variance / 48.0).sqrt();
            assert!(z.abs() < 4.0, "{skew} {loss}: {mean} {predicted} {z}");
        }
    }
}
