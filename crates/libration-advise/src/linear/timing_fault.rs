//! Faults of the timing of a request.

use libration::linear::LinearLoopError;
use libration_settings::{Fault, duration};

use crate::timed_loop::StatedTiming;

/// Latency in periods above which one that is refused has the wrong unit. Loops of shorter ones are too large for other reasons.
const MOST_PERIODS: f64 = 60.0;

/// The fault of a loop that cannot be analysed with this timing.
pub(super) fn fault_of_timing(
    error: &LinearLoopError,
    timing: &StatedTiming,
    period: f64,
) -> Fault {
    let longest = |all: &[f64]| all.iter().copied().fold(0.0, f64::max);
    let [of_inputs, of_outputs] =
        [&timing.input_latency, &timing.output_latency].map(|all| longest(all));
    let (key, seconds) = match of_inputs >= of_outputs {
        true => ("loop.latency", of_inputs),
        false => ("loop.output-latency", of_outputs),
    };
    match error {
        LinearLoopError::Latency { .. } | LinearLoopError::Size { .. } => Fault::new(
            key,
            match seconds > MOST_PERIODS * period {
                true => duration::excessive_latency(seconds, period),
                false => error.to_string(),
            },
        ),
        _ => Fault::new("loop", error.to_string()),
    }
}
