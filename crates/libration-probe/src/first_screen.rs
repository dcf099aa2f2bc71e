//! The first screen of the page of an audit: its verdict, its numbers, and what to do.

use libration_report::notation::{cut_off, number, plural};
use libration_report::page::Highlight;
use libration_report::verdict::Outcome;

use crate::ProbeReport;
use crate::summary::capitalised;

/// The most that the first screen says to do; the table below has all.
const MOST_ACTIONS: usize = 3;

/// The verdict.
pub(crate) fn title(audit: &ProbeReport) -> String {
    let faults = audit.findings.iter().filter(|finding| finding.is_fault).count();
    let warnings = audit.findings.len() - faults;
    let outcome = audit.verdict.outcome;
    let found = match (outcome, warnings) {
        (Outcome::Fault, _) => plural(faults, "fault"),
        (Outcome::NoFault, 0) => outcome.to_string(),
        (Outcome::NoFault, _) => format!("{outcome}, but {}", plural(warnings, "warning")),
        _ => return format!("Whether the step of {} has a fault is {outcome}", audit.title),
    };
    format!("The step of {} has {found}", audit.title)
}

/// The key numbers, each beside its prediction where there is one.
pub(crate) fn numbers(audit: &ProbeReport) -> Vec<Highlight> {
    let mut shown = Vec::new();
    if audit.is_differentiable() {
        shown.extend(spectral_radius(audit));
        shown.extend(longest_step(audit));
    }
    shown.extend(order(audit));
    shown.extend(energy(audit).or_else(|| damping(audit)));
    shown
}

fn spectral_radius(audit: &ProbeReport) -> Option<Highlight> {
    let exact: Option<Vec<f64>> = audit
        .modes
        .iter()
        .map(|mode| mode.flow.map(|flow| (flow.growth_rate * audit.dt).exp()))
        .collect();
    let exact = exact.and_then(|all| all.into_iter().reduce(f64::max));
    let beside = exact.map_or_else(String::new, |exact| {
        format!("; {} in exact steps of the system", number(exact, 7))
    });
    (!audit.modes.is_empty() && audit.spectral_radius.is_finite()).then(|| Highlight {
        value: number(audit.spectral_radius, 7),
        text: format!("spectral radius: largest factor of a mode in a step{beside}"),
    })
}

fn longest_step(audit: &ProbeReport) -> Option<Highlight> {
    let limit = audit.largest_dt.as_ref()?;
    let dt = number(audit.dt, 4);
    Some(match limit.dt {
        _ if limit.grows_always => Highlight {
            value: "none".into(),
            text: format!("no step is short enough to be stable; dt = {dt} s"),
        },
        Some(longest) => Highlight {
            value: format!("{} s", number(cut_off(longest, 4), 4)),
            text: format!("longest stable step; dt = {dt} s"),
        },
        None => Highlight {
            value: format!("{} s", number(limit.tried_up_to, 3)),
            text: format!("longest step that was tried; no limit was found; dt = {dt} s"),
        },
    })
}

fn order(audit: &ProbeReport) -> Option<Highlight> {
    let found = audit.order.as_ref().filter(|found| !found.is_exact)?;
    let titles = |of: &crate::Match| of.titles().join(" or ");
    let recognition = audit.recognition.as_ref()?;
    let name = Some(titles(&recognition.by_results))
        .filter(|name| !name.is_empty())
        .or_else(|| recognition.by_matrix.as_ref().map(titles))
        .filter(|name| !name.is_empty());
    let of = name.map_or_else(String::new, |name| format!("; that of {name}"));
    Some(Highlight {
        value: found.order?.to_string(),
        text: format!("order of convergence{of}; estimates {}", found.in_words()),
    })
}

fn energy(audit: &ProbeReport) -> Option<Highlight> {
    let found = audit.defects.as_ref()?.energy.as_ref()?;
    let halved = found
        .rate_halved
        .map_or_else(String::new, |rate| format!("; {} with half the step", number(rate, 3)));
    Some(Highlight {
        value: format!("{} 1/s", number(found.rate, 3)),
        text: format!("relative drift of the energy{halved}"),
    })
}

fn damping(audit: &ProbeReport) -> Option<Highlight> {
    let known = audit.modes.iter().filter_map(|mode| Some((mode, mode.numerical_damping?)));
    let (mode, added) = known.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
    Some(Highlight {
        value: number(added, 3),
        text: format!(
            "damping ratio that the step adds to the mode of {}; an exact step: 0",
            mode.names()
        ),
    })
}

/// What to do about the findings, faults first; the command that shows whether it helped comes last.
pub(crate) fn actions(audit: &ProbeReport) -> Vec<String> {
    let mut all: Vec<_> = audit.findings.iter().collect();
    all.sort_by_key(|finding| !finding.is_fault);
    let mut actions: Vec<String> = all.iter().map(|finding| capitalised(&finding.help)).collect();
    actions.truncate(MOST_ACTIONS);
    actions.extend(next_command(audit));
    actions.truncate(MOST_ACTIONS);
    actions
}

fn next_command(audit: &ProbeReport) -> Option<String> {
    let command = &audit.repeat_command;
    // A call in Python is in the last section of the page.
    if !command.starts_with("libration ") || command.contains(['`', '\n']) {
        return None;
    }
    if !audit.findings.is_empty() {
        return Some(format!("Repeat the audit after a change: `{command}`"));
    }
    let has_plant = audit.modified_flow.is_some() && !audit.inputs.is_empty();
    Some(match has_plant && !command.contains("--save-plant") {
        true => format!(
            "Write the step as a plant, from which `libration advise` computes the limits of a control loop: \
             `{command} --save-plant plant.toml`"
        ),
        false => format!("Repeat the audit after each change of the simulator: `{command}`"),
    })
}
