//! The states of a plant at the first response.

use crate::estimate::Estimate;
use crate::plant_step::PlantSteps;
use crate::recording::Recording;

impl Estimate<'_> {
    /// The states of the plant at the first response that is used.
    pub(crate) fn initial_states(&self, recording: &Recording) -> Vec<f64> {
        let coefficients = &self.regression.coefficients;
        let mut states = coefficients[2..].to_vec();
        if !self.model.window(recording).is_at_rest {
            return states;
        }
        let plant = self.model.response.dynamics(&self.point.shape[1..]);
        let driven = |command: f64| coefficients[0] * command + coefficients[1];
        let (times, values) = (&recording.command_times[..], &recording.commands[..]);
        for (state, rest) in states.iter_mut().zip(plant.rest()) {
            if let Some(rest) = rest {
                *state = rest * driven(values[0]);
            }
        }
        // Rest is that at the first command: from there to the first response.
        let (end, dead_time) = (recording.response_times[0], self.point.shape[0]);
        let mut steps = PlantSteps::new(&plant, false);
        let (mut now, mut active) = (times[0], 0);
        while now < end && !states.is_empty() {
            let arrival = times.get(active + 1).map(|time| time + dead_time);
            let until = arrival.map_or(end, |arrival| arrival.min(end));
            if until > now {
                let (command, slope) = self.model.hold.at(times, values, active, now - dead_time);
                let step = steps.step(until - now);
                states = step.moved(&states, driven(command), coefficients[0] * slope);
                now = until;
            }
            active += usize::from(arrival.is_some_and(|arrival| arrival <= end));
        }
        states
    }
}
