//! What is assumed of a loop before its recording.

use serde::Serialize;

use crate::estimate::Estimate;
use crate::plant_step::PlantSteps;
use crate::recording::Recording;

/// What is assumed of a loop before its recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Start {
    /// The loop rests under the first command.
    Rest,
    /// The first command acts, and the loop moves.
    Held,
    /// Nothing: responses up to the largest dead time, which earlier commands may have caused, are not used.
    Unknown,
}

impl Start {
    /// All kinds.
    pub const ALL: [Start; 3] = [Start::Rest, Start::Held, Start::Unknown];

    /// The name on the command line and in results.
    pub fn name(self) -> &'static str {
        match self {
            Start::Rest => "rest",
            Start::Held => "held",
            Start::Unknown => "unknown",
        }
    }
}

/// Fewest changes of a command that suffice behind the largest dead time, and their least share of the squares of all changes.
const ENOUGH_CHANGES: (usize, f64) = (3, 0.5);
/// A command that changes as often as this in a recording did so before it too.
const MANY_CHANGES: usize = 10;

/// A first hold of a command that is this many times as long as each later one is a rest.
const LONG_HOLD: f64 = 2.0;

/// The start of a recording, which a fit has to confirm: at rest if it begins with a long hold, or if nearly all of a few changes of the command
/// would be lost with the responses up to the largest dead time.
pub(crate) fn likely_start(recording: &Recording, largest: f64) -> Start {
    let changes: Vec<(f64, f64)> = recording
        .commands
        .windows(2)
        .zip(&recording.command_times[1..])
        .filter(|(pair, _)| pair[0] != pair[1])
        .map(|(pair, &time)| (time, (pair[1] - pair[0]).powi(2)))
        .collect();
    let Some(&(first, _)) = changes.first() else { return Start::Unknown };
    let late = || changes.iter().filter(|(time, _)| *time >= largest);
    let total: f64 = changes.iter().map(|(_, square)| square).sum();
    let left: f64 = late().map(|(_, square)| square).sum();
    let is_little = late().count() < ENOUGH_CHANGES.0 || left < ENOUGH_CHANGES.1 * total;
    let longest = changes.windows(2).map(|pair| pair[1].0 - pair[0].0).fold(0.0, f64::max);
    let before = first - recording.command_times[0];
    match (is_little && changes.len() < MANY_CHANGES) || before >= LONG_HOLD * longest {
        true => Start::Rest,
        false => Start::Unknown,
    }
}

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
