//! Findings about what a step remembers.

use libration_report::notation::{number, plural};

use crate::FindingKind::*;
use crate::hidden_latency::measured_inputs;
use crate::{DelayAudit, Finding, MeasuredDelay, Memory, Observed, StrayResults, Subject};

/// Part of a step by which a delay may differ from the stated one.
const DELAY: f64 = 1e-3;

/// Findings about what a step remembers.
pub(crate) fn of_memory(
    memory: &Memory,
    delays: &[DelayAudit],
    subject: &Subject,
    found: &mut Vec<Finding>,
) {
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
                "results depend on {of}many calls ago, as those of a filter do: their influence falls to {} per call (time constant {} s), and the step does not return that state{held}",
                number(settling.factor, 4),
                number(settling.time_constant, 4)
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
        let mean = memory.latency(j, delays);
        let beside = match stated {
            0.0 => String::new(),
            stated => format!(", {} stated", steps(stated)),
        };
        let first = match input.first {
            Some(0) | None => "that of the same call responds, too".into(),
            Some(first) => {
                format!("the first result that responds is {} later", plural(first, "call"))
            }
        };
        let (how_much, direction) = (mean.abs(), if mean < 0.0 { "early" } else { "late" });
        found.push(Finding::fault(
            LateCommand,
            format!(
                "a command of `{}` acts {} {direction} ({} s) on average{beside}: {first}",
                input.of,
                steps(how_much),
                number(how_much * dt, 4)
            ),
        ));
    }
    if memory.state.last.unwrap_or(0) > 0 {
        found.push(Finding::fault(
            LateState,
            format!(
                "the returned states are those of {} ago on average, not of the given state",
                steps(memory.state.mean)
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
                "observations are those of the given states and not of the returned ones, {} ({} s) older: the simulator stores them before its update",
                steps(memory.staleness()),
                number(memory.staleness() * dt, 4)
            ),
        )),
        _ => {}
    }
    // A mean age of one that changes is that of many calls.
    let is_measured = subject.measured_observation.is_some();
    if memory.observed == Some(Observed::Asked) && memory.staleness() != 0.0 && !is_measured {
        found.push(Finding::fault(
            StaleObservation,
            format!(
                "observations are {} ({} s) older than the states",
                steps(memory.staleness()),
                number(memory.staleness() * dt, 4)
            ),
        ));
    }
}

/// Findings about the lateness that the adapter of the simulator has measured.
pub(crate) fn of_measured(subject: &Subject, delays: &[DelayAudit], found: &mut Vec<Finding>) {
    for input in measured_inputs(subject, delays) {
        let subject_of = format!("a command of `{}` acts", input.name);
        if input.varies {
            found.push(Finding::fault(
                IrregularDelay,
                match input.most_steps {
                    0.0 => format!(
                        "{} of {} changes of `{}` have no effect",
                        input.unseen, input.calls, input.name
                    ),
                    _ => varying(input, &subject_of, "late", subject.dt),
                },
            ));
        } else if input.late_steps.abs() >= DELAY {
            found.push(Finding::fault(
                LateCommand,
                format!(
                    "{subject_of} {} late ({} s)",
                    steps(input.late_steps),
                    number(input.late_steps * subject.dt, 4)
                ),
            ));
        }
    }
    let is_known = found.iter().any(|finding| finding.kind == NotReproducible);
    if let Some(StrayResults { strays, calls }) = subject.stray_results.filter(|_| !is_known) {
        let (results, have) = if strays == 1 { ("result", "has") } else { ("results", "have") };
        found.push(Finding::fault(
            NotReproducible,
            format!(
                "{strays} {results} of {calls} calls {have} no cause in this call or those before: the step, or a wrapper, replaces some of them by itself"
            ),
        ));
    }
    if let Some(observation) = &subject.measured_observation {
        found.push(Finding::fault(
            StaleObservation,
            match observation.most_steps {
                0.0 => format!(
                    "{} of {} changes of the state show in no observation",
                    observation.unseen, observation.calls
                ),
                _ => varying(observation, "observations are", "older than the states", subject.dt),
            },
        ));
    }
}

/// A delay that changes from step to step, with the error of its mean.
fn varying(delay: &MeasuredDelay, subject: &str, how: &str, dt: f64) -> String {
    format!(
        "{subject} up to {} {how}, which changes from step to step: {} ± {} ({} s) on average over {} calls",
        steps(delay.most_steps),
        number(delay.late_steps, 2),
        steps_in(delay.late_steps_error, 1),
        number(delay.late_steps * dt, 2),
        delay.calls
    )
}

/// A number of steps, such as `1 step` and `2.4 steps`.
fn steps(count: f64) -> String {
    steps_in(count, 4)
}

fn steps_in(count: f64, digits: usize) -> String {
    let shown = number(count, digits);
    let plural = if shown == "1" { "" } else { "s" };
    format!("{shown} step{plural}")
}
