//! How well a command tells dead time and lag apart, and which command would do better.

use serde::Serialize;

use crate::arrivals::spread;
use crate::estimate::Estimate;
use crate::information::information;
use crate::recording::Recording;

/// What a command would tell, as much of it as of the recording.
#[derive(Clone, Debug, Serialize)]
pub struct ExcitationRow {
    /// The command.
    pub command: String,
    /// Time between its random changes, in s; `null` for that of the recording.
    pub dwell: Option<f64>,
    /// Standard error of the dead time, in s; `null` if the command does not tell it.
    pub dead_time_error: Option<f64>,
    /// Standard error of the second parameter; `null` if the command does not tell it.
    pub lag_error: Option<f64>,
    /// Correlation of the errors of both; −1 if only their sum is known.
    pub correlation: Option<f64>,
}

/// Dwell times, in intervals of the responses.
const DWELLS: [usize; 6] = [1, 2, 4, 8, 16, 64];

/// Rows for the recording itself and for random steps of the same size.
pub(crate) fn excitations(estimate: &Estimate<'_>, recording: &Recording) -> Vec<ExcitationRow> {
    let mut rows = vec![row(estimate, recording, "that of the recording".to_owned(), None)];
    let interval = estimate.model.interval;
    let size = spread(&recording.commands);
    let end = recording.response_times[recording.response_times.len() - 1];
    for dwell in DWELLS {
        let dwell = dwell as f64 * interval;
        if dwell > 0.25 * recording.span() {
            continue;
        }
        let count = (end / dwell).ceil() as usize + 1;
        let command_times: Vec<f64> = (0..count).map(|k| k as f64 * dwell).collect();
        let designed = Recording {
            commands: random_signs(count).iter().map(|sign| sign * size).collect(),
            command_times,
            ..recording.clone()
        };
        let name = format!("random steps, one in {} s or longer", significant(dwell));
        rows.push(row(estimate, &designed, name, Some(dwell)));
    }
    rows
}

fn row(
    estimate: &Estimate<'_>,
    recording: &Recording,
    command: String,
    dwell: Option<f64>,
) -> ExcitationRow {
    let found = information(estimate, recording);
    let free = estimate.model.free_shape();
    let error = |i: usize| {
        let found = found.as_ref().filter(|_| i < free);
        found.map(|found| found.covariance[(i, i)].sqrt()).filter(|error| error.is_finite())
    };
    let [dead_time_error, lag_error] = [error(0), error(1)];
    let correlation = match (&found, dead_time_error, lag_error) {
        (Some(found), Some(first), Some(second)) => {
            Some(found.covariance[(0, 1)] / (first * second))
        }
        _ => None,
    };
    ExcitationRow { command, dwell, dead_time_error, lag_error, correlation }
}

/// Signs by a shift register of 15 bits with the polynomial `x¹⁵ + x¹⁴ + 1`, whose period is 2¹⁵ − 1.
fn random_signs(count: usize) -> Vec<f64> {
    // A mixed start: a lone bit is followed by a long row of equal signs.
    let mut register = 0x59ab_u16 & 0x7fff;
    (0..count)
        .map(|_| {
            let bit = ((register >> 14) ^ (register >> 13)) & 1;
            register = (register << 1 | bit) & 0x7fff;
            if bit == 1 { 1.0 } else { -1.0 }
        })
        .collect()
}

fn significant(x: f64) -> String {
    libration_report::notation::number(x, 3)
}
