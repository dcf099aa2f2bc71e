//! Findings about what a step remembers.

use libration_report::notation::plural;

use crate::FindingKind::*;
use crate::{Finding, Memory, Observed, Subject};

/// Part of a step by which a delay may differ from the stated one.
const DELAY: f64 = 1e-3;

/// Findings about what a step remembers.
pub(crate) fn of_memory(memory: &Memory, subject: &Subject, found: &mut Vec<Finding>) {
    let dt = subject.dt;
    if let Some(settling) = &memory.settling {
        let (of, held) = match settling.is_of_commands {
            Some(true) if settling.is_settled => ("the commands of ", "; the audit holds them"),
            Some(true) => ("the commands of ", ""),
            Some(false) => ("the states of ", ""),
            None => ("", ""),
        };
        found.push(Finding::fault(
            HiddenState,
            format!(
                "results depend on {of}many calls ago, as those of a filter do: their influence falls by {:.4} per call (time constant {:.4} s), and the step does not return that state{held}",
                settling.factor, settling.time_constant
            ),
        ));
        return;
    }
    if memory.calls.is_none() {
        found.push(Finding::fault(
            HiddenState,
            format!(
                "results depend on calls more than {} calls ago: the step has a state that it does not return",
                memory.tried
            ),
        ));
        return;
    }
    for (j, input) in memory.inputs.iter().enumerate() {
        let stated = subject.stated_delays.get(j).copied().unwrap_or(0.0) / dt;
        // A delay that the simulator states is none that it hides.
        // Between two steps a queue that holds its commands is read at the later one.
        let held = (stated - DELAY).ceil();
        if (input.mean - stated).abs() < DELAY || (input.mean - held).abs() < DELAY {
            continue;
        }
        let first = input.first.unwrap_or(0);
        let beside = match stated {
            0.0 => String::new(),
            stated => format!(", {stated:.3} are stated"),
        };
        found.push(Finding::fault(
            LateCommand,
            format!(
                "a command of `{}` acts {:.3} steps late ({:.4} s) on average{beside}: the first result that responds is {} later",
                input.of,
                input.mean,
                input.mean * dt,
                plural(first, "call")
            ),
        ));
    }
    if memory.state.last.unwrap_or(0) > 0 {
        found.push(Finding::fault(
            LateState,
            format!(
                "the returned states are those of {:.3} calls ago on average, not of the given state",
                memory.state.mean
            ),
        ));
    }
    match memory.observed {
        Some(Observed::Nothing) => found.push(Finding::fault(
            ConstantObservation,
            "observations do not respond to the states".into(),
        )),
        Some(Observed::Varying) => found.push(Finding::fault(
            NotReproducible,
            "observations of the same state vary on and on: by random numbers, or by a filter that the state does not have".into(),
        )),
        Some(Observed::Given) => found.push(Finding::fault(
            StaleObservation,
            format!(
                "observations are those of the given states and not of the returned ones, {:.3} steps ({:.4} s) older: the simulator stores them before its update",
                memory.staleness(),
                memory.staleness() * dt
            ),
        )),
        _ => {}
    }
    if memory.observed == Some(Observed::Asked) && memory.staleness() != 0.0 {
        found.push(Finding::fault(
            StaleObservation,
            format!(
                "observations are {:.3} steps ({:.4} s) older than the states",
                memory.staleness(),
                memory.staleness() * dt
            ),
        ));
    }
}
