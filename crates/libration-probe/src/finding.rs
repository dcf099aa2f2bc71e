//! Findings of an audit: what a user of the step should know or mend.

use libration_report::notation::{number, plural};
use serde::Serialize;

use crate::energy_finding::{energy_leak, negative_damping};
use crate::report::ProbeReport;
use crate::{Bits, Memory, Observed, Subject};

/// Rounding from which a step is rough, far above that of `f64`.
const COARSE: f64 = 1e-9;
/// Part of a step by which a delay may differ from the stated one.
const DELAY: f64 = 1e-3;
/// Largest distance of the linear prediction from a short run.
const LINEAR: f64 = 0.01;

/// A finding.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// Its kind, the same word for the same thing.
    pub kind: &'static str,
    /// Whether it is a fault of the simulator; else a fact without which its numbers mislead.
    pub is_fault: bool,
    /// The finding in a sentence, with its evidence.
    pub text: String,
    /// What to change, in a sentence.
    pub help: String,
}

impl Finding {
    /// Without help, which requires the whole report.
    fn new(kind: &'static str, is_fault: bool, text: String) -> Self {
        Finding { kind, is_fault, text, help: String::new() }
    }

    fn fault(kind: &'static str, text: String) -> Self {
        Finding::new(kind, true, text)
    }

    fn warning(kind: &'static str, text: String) -> Self {
        Finding::new(kind, false, text)
    }
}

/// Findings about the bits of a step.
pub(crate) fn of_bits(bits: &Bits, found: &mut Vec<Finding>) {
    if let Some(random) = &bits.randomness {
        let size = random.deviations.iter().copied().fold(0.0, f64::max);
        found.push(match size > 0.0 {
            true => Finding::fault(
                "not-reproducible",
                format!(
                    "the same call gives different results (standard deviation {}): random numbers, a clock, or a state that the step hides",
                    number(size, 3)
                ),
            ),
            false => Finding::fault(
                "hidden-state",
                "the same call gives different results after other calls, and the same ones when it is repeated: the step has a state that it does not return".into(),
            ),
        });
        match (random.environments_differ, random.generator_is_shared) {
            (_, Some(true)) => found.push(Finding::fault(
                "shared-generator",
                "the results of the first environment depend on the number of environments: they share a generator of random numbers".into(),
            )),
            (Some(false), _) => found.push(Finding::fault(
                "same-noise",
                "all environments of a batch draw the same random numbers".into(),
            )),
            _ => {}
        }
        return;
    }
    for check in &bits.checks {
        let Some(difference) = &check.difference else { continue };
        let ulps = difference.ulps.map_or_else(String::new, |ulps| format!(", {ulps} ulps apart"));
        found.push(Finding::fault(
            "bits-differ",
            format!(
                "{} gives other bits: first in {} ({:e} and {:e}{ulps}); {} numbers differ",
                check.name,
                difference.place(),
                difference.first,
                difference.second,
                difference.differing
            ),
        ));
    }
    let Some(rounding) = &bits.rounding else { return };
    match &rounding.single_precision[..] {
        [] => {}
        [whole] if whole == "the step" => found.push(Finding::fault(
            "single-precision",
            format!(
                "the step computes in single precision: its rounding is {} of its results, that of f64 is 10⁻¹⁶",
                number(rounding.results, 2)
            ),
        )),
        parts => found.push(Finding::fault(
            "single-precision",
            format!("the step rounds {} to single precision", parts.join(", ")),
        )),
    }
    if rounding.single_precision.is_empty() && rounding.results > COARSE {
        found.push(Finding::warning(
            "rough",
            format!(
                "the step is rough: along a line of points 10⁻⁶ apart its results jump by {} of their size",
                number(rounding.results, 2)
            ),
        ));
    }
}

/// Findings about what a step remembers.
pub(crate) fn of_memory(memory: &Memory, subject: &Subject, found: &mut Vec<Finding>) {
    let dt = subject.dt;
    if let Some(settling) = &memory.settling {
        let (of, held) = match settling.is_of_commands {
            true => ("commands", "; the audit holds them"),
            false => ("states", ""),
        };
        found.push(Finding::fault(
            "hidden-state",
            format!(
                "results depend on the {of} of many calls ago, as those of a filter do: their influence falls by {:.4} per call (time constant {:.4} s), and the step does not return that state{held}",
                settling.factor, settling.time_constant
            ),
        ));
        return;
    }
    if memory.calls.is_none() {
        found.push(Finding::fault(
            "hidden-state",
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
        if (input.mean - stated).abs() < DELAY {
            continue;
        }
        let first = input.first.unwrap_or(0);
        let beside = match stated {
            0.0 => String::new(),
            stated => format!(", {stated:.3} are stated"),
        };
        found.push(Finding::fault(
            "late-command",
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
            "late-state",
            format!(
                "the returned states are those of {:.3} calls ago on average, not of the given state",
                memory.state.mean
            ),
        ));
    }
    match memory.observed {
        Some(Observed::Nothing) => found.push(Finding::fault(
            "constant-observation",
            "observations do not respond to the states".into(),
        )),
        Some(Observed::Given) => found.push(Finding::fault(
            "stale-observation",
            format!(
                "observations are those of the given states and not of the returned ones, one step ({dt:.4} s) older: the simulator stores them before its update"
            ),
        )),
        _ => {}
    }
    if memory.observed == Some(Observed::Asked) && memory.staleness() != 0.0 {
        found.push(Finding::fault(
            "stale-observation",
            format!(
                "observations are {:.3} steps ({:.4} s) older than the states",
                memory.staleness(),
                memory.staleness() * dt
            ),
        ));
    }
}

/// Findings about the linearised step, its flow and its energy.
pub(crate) fn of_report(report: &ProbeReport, subject: &Subject, found: &mut Vec<Finding>) {
    found.extend(
        subject.validity.iter().map(|text| Finding::warning("limited-validity", text.clone())),
    );
    if report.ignores_dt {
        found.push(Finding::fault(
            "ignores-dt",
            "a step of half the length gives the same bits: the simulator ignores dt".into(),
        ));
    }
    if !report.is_differentiable() {
        found.push(Finding::warning(
            "not-differentiable",
            format!(
                "the step has no derivative at this state (relative error {}): a contact, a limit or dry friction changes there",
                number(report.jacobian_error, 2)
            ),
        ));
    }
    let equilibrium = &report.equilibrium;
    if !equilibrium.holds && equilibrium.stated != Some(false) {
        found.push(Finding::warning(
            "no-equilibrium",
            format!(
                "the state is no equilibrium: `{}` changes by {} per step; the modes are those of deviations from a motion",
                equilibrium.state,
                number(equilibrium.change, 3)
            ),
        ));
    }
    if let Some(confirmation) =
        report.confirmation.as_ref().filter(|c| c.error > LINEAR || c.error.is_nan())
        && equilibrium.holds
        && report.is_differentiable()
    {
        found.push(Finding::warning(
            "nonlinear",
            format!(
                "after {} steps from a deviation of {} the simulator is {} % off the linear prediction",
                confirmation.steps,
                number(confirmation.displacement, 1),
                number(100.0 * confirmation.error, 2)
            ),
        ));
    }
    if let Some(difference) = report.reference.as_ref().filter(|r| r.difference > r.allowed) {
        found.push(Finding::warning(
            "derivatives-differ",
            format!(
                "the matrices of {} differ from the differences of the step by {} of the largest entry of a row; errors explain {}",
                difference.source,
                number(difference.difference, 2),
                number(difference.allowed, 2)
            ),
        ));
    }
    for audit in &report.delays {
        let Some(first) = audit.first_change else { continue };
        let shares: Vec<String> = audit
            .delays
            .iter()
            .map(|(delay, count)| {
                let share = 100.0 * *count as f64 / audit.steps as f64;
                format!("{} steps in {} %", number(*delay, 4), number(share, 3))
            })
            .collect();
        found.push(Finding::fault(
            "irregular-delay",
            format!(
                "the delay of `{}` changes from step to step, first at step {first}: {}",
                audit.input,
                shares.join(", ")
            ),
        ));
    }
    // A step cannot tell whether its author wants a drive, unless the system conserves energy.
    let is_fault = report.is_conservative;
    found.extend(
        report
            .driven_velocities
            .iter()
            .map(|driven| Finding::new("negative-damping", is_fault, negative_damping(driven))),
    );
    if report.is_conservative {
        let leak = energy_leak(report.defects.as_ref(), &report.modes);
        found.extend(leak.map(|text| Finding::fault("energy-leak", text)));
    }
    if let Some(limit) = &report.largest_dt {
        if limit.grows_always {
            found.push(Finding::warning(
                "grows-always",
                format!(
                    "the mode of {} grows with every step length though it does not grow in the system",
                    limit.mode
                ),
            ));
        } else if limit.dt.is_some_and(|dt| dt < report.dt) {
            found.push(Finding::fault(
                "unstable-step",
                format!(
                    "the step of {} s is unstable though the system is stable; the longest stable step is {} s, limited by the mode of {}",
                    number(report.dt, 6),
                    number(limit.dt.unwrap_or(0.0), 6),
                    limit.mode
                ),
            ));
        }
    }
}
