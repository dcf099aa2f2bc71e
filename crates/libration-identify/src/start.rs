//! What is assumed of a loop before its recording.

use serde::Serialize;

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
