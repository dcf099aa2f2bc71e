//! The coordinates of a loop with a timing.

use libration_core::control::Latency;

use crate::{Layout, LinearLoop, LinearLoopError, LoopTiming, Transit};

impl LinearLoop {
    /// Checks that a timing fits the loop.
    ///
    /// # Errors
    /// [`LinearLoopError`]: an invalid timing.
    pub fn check_timing(&self, timing: &LoopTiming) -> Result<(), LinearLoopError> {
        let LoopTiming { input_latency, output_latency, jitter, skew, loss, .. } = timing;
        let (m, p) = (self.plant().inputs.len(), self.plant().outputs.len());
        for (of, given, count) in
            [("inputs", input_latency.len(), m), ("outputs", output_latency.len(), p)]
        {
            if given != count {
                return Err(LinearLoopError::Latencies { of, given, count });
            }
        }
        if !(0.0..1.0).contains(loss) {
            return Err(LinearLoopError::Loss(*loss));
        }
        if !(skew.is_finite() && *skew > -1.0) {
            return Err(LinearLoopError::Skew(*skew));
        }
        if self.plant().sampling_period.is_some() {
            let split = |latency: &Latency| latency.part() > 0.0;
            if input_latency.iter().chain(output_latency).any(split) {
                return Err(LinearLoopError::BetweenSamples("a latency of a part of a period"));
            }
            if jitter.rms() > 0.0 || *skew != 0.0 {
                return Err(LinearLoopError::BetweenSamples("another period"));
            }
        }
        Ok(())
    }

    /// The coordinates of the loop, after all numbers of the timing are checked.
    pub(crate) fn layout(&self, timing: &LoopTiming) -> Result<Layout, LinearLoopError> {
        self.check_timing(timing)?;
        let LoopTiming { input_latency, output_latency, loss, .. } = timing;
        let p = self.plant().outputs.len();
        let noises = if self.holds_noise_and_cost() { self.plant().g.columns() } else { 0 };
        let direct = |i: usize| (0..p).any(|j| self.plant().d[(j, i)] != 0.0);
        let inputs: Vec<Transit> = input_latency
            .iter()
            .enumerate()
            .map(|(i, latency)| {
                let transit = Transit::of_commands(*latency, *loss > 0.0);
                // An output that is measured at the beginning of a period sees the command that acts.
                Transit { acts_on: transit.acts_on || direct(i), ..transit }
            })
            .collect();
        let outputs: Vec<Transit> =
            output_latency.iter().map(|latency| Transit::of_measurements(*latency)).collect();
        let sizes = [self.plant().states.len(), self.controller().memory(), noises];
        let layout = Layout::new(sizes, &inputs, &outputs);
        let most = timing.most_states();
        match layout.size() > most {
            true => Err(LinearLoopError::Size { size: layout.size(), most }),
            false => Ok(layout),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{DiscreteController, LinearPlant, Matrix, log_spectral_radius};

    /// Two springs in a row, with all states measured.
    fn two_springs() -> LinearLoop {
        let mass = Matrix::diagonal(&[1.0, 0.5]);
        let stiffness = Matrix::from_rows(&[[30.0, -10.0], [-10.0, 10.0]]).unwrap();
        let damping = Matrix::diagonal(&[0.2, 0.1]);
        let force = Matrix::identity(2);
        let names = crate::Signal::numbered("q", 2);
        let plant = LinearPlant::mechanical([&mass, &damping, &stiffness], &force, &names).unwrap();
        let plant = plant.with_all_states_measured();
        let gain = Matrix::from_fn(2, 4, |i, j| -0.7 * ((i + 2 * j) % 3) as f64);
        let controller = DiscreteController::gain(gain);
        LinearLoop::new(plant, controller, 0.05, Matrix::identity(6), vec![1e-4; 4]).unwrap()
    }

    #[test]
    fn a_latency_that_rounding_keeps_from_a_whole_number_is_that_number() {
        let linear = two_springs();
        let at = |steps: f64| {
            let latency = Latency::of_steps(steps).unwrap();
            let mut all = Vec::new();
            for i in 0..6 {
                let mut timing = linear.ideal();
                let channels = timing.input_latency.iter_mut().chain(&mut timing.output_latency);
                if let Some(channel) = channels.into_iter().nth(i) {
                    *channel = latency;
                }
                let radius = log_spectral_radius(&linear.period_matrix(&timing).unwrap());
                let cost = linear.stationary(&timing).unwrap().map_or(0.0, |found| found.cost);
                all.push((radius, cost));
            }
            all
        };
        for whole in [1.0, 3.0, 7.0] {
            for off in [-1e-14, 1e-14, -1e-9, 1e-9] {
                for (near, exact) in at(whole * (1.0 + off)).into_iter().zip(at(whole)) {
                    // Both change by less than a hundred times what the latency does.
                    assert!((near.0 - exact.0).abs() < 1e-6, "{whole} {off}: {near:?} {exact:?}");
                    assert!((near.1 - exact.1).abs() < 1e-6 * exact.1.max(1.0), "{whole} {off}");
                }
            }
        }
    }
}
