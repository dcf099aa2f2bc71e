//! The coordinates of a loop with a timing.

use libration_core::control::Latency;

use crate::{Layout, LinearLoop, LinearLoopError, LoopTiming, Transit};

/// Most states of a loop whose periods are drawn.
pub(crate) const MOST_RANDOM: usize = 100;

/// Most states of a loop whose periods are all the same.
const MOST_REPEATED: usize = 300;

impl LinearLoop {
    /// The coordinates of the loop, after all numbers of the timing are checked.
    pub(crate) fn layout(&self, timing: &LoopTiming) -> Result<Layout, LinearLoopError> {
        let LoopTiming { input_latency, output_latency, jitter, skew, loss } = timing;
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
        let mut noises = if self.holds_noise() { self.plant().g.columns() } else { 0 };
        if self.plant().sampling_period.is_some() {
            let split = |latency: &Latency| latency.part() > 0.0;
            if input_latency.iter().chain(output_latency).any(split) {
                return Err(LinearLoopError::BetweenSamples("a latency of a part of a period"));
            }
            if jitter.rms() > 0.0 || *skew != 0.0 {
                return Err(LinearLoopError::BetweenSamples("another period"));
            }
            noises = self.plant().g.columns();
        }
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
        let most = if timing.repeats() { MOST_REPEATED } else { MOST_RANDOM };
        match layout.size() > most {
            true => Err(LinearLoopError::Size { size: layout.size(), most }),
            false => Ok(layout),
        }
    }
}
