//! Steps of integrators on a linear plant.

use libration_analyze::linear_analysis::{LinearAnalysis, StepAnalysis};
use libration_analyze::{beside_one, is_at_limit, is_within};
use libration_report::verdict::Outcome;

use super::super::digits::{least, limit, significant};
use super::Summary;
use super::linear_plant::is_unstable;

/// Appends the integrators whose steps are stable, those that are not, and the difference of simulations from predictions.
pub(super) fn append_steps(analysis: &LinearAnalysis, is_one: bool, summary: &mut Summary) {
    let Some(first) = analysis.steps.first() else { return };
    let end = |x: Option<f64>| x.map_or("∞".to_owned(), |x| limit(x, 4));
    let names: [String; 3] = match (analysis.dt, is_unstable(analysis)) {
        (Some(dt), false) => {
            [format!("stable at dt = {dt} s"), "unstable there".into(), "never stable".into()]
        }
        (None, false) => {
            ["stable for any dt", "stable for some dt", "never stable"].map(str::to_owned)
        }
        // The plant grows; the question is whether the steps let other modes grow.
        (Some(dt), true) => [
            format!("only the growth of the plant at dt = {dt} s"),
            "more growth there".into(),
            "more growth at any dt".into(),
        ],
        (None, true) => [
            "only the growth of the plant for any dt",
            "only that growth for some dt",
            "more growth at any dt",
        ]
        .map(str::to_owned),
    };
    let mut groups: Vec<(String, Vec<String>)> =
        names.into_iter().map(|name| (name, Vec::new())).collect();
    for step in &analysis.steps {
        let name = step.integrator;
        let mut group_of = |title: String| {
            let known = groups.iter().position(|(name, _)| *name == title);
            known.unwrap_or_else(|| {
                groups.push((title, Vec::new()));
                groups.len() - 1
            })
        };
        let (group, text) = match step.stable_dt.as_deref() {
            None => {
                let reason = step.unknown_stable_dt.map_or(String::new(), |why| format!(", {why}"));
                (group_of(format!("not known{reason}")), name.to_owned())
            }
            // Windows say nothing of modes that grow by themselves, and faster in steps.
            Some([[Some(0.0), None]])
                if step.verdict.as_ref().is_some_and(|own| own.outcome == Outcome::Unstable) =>
            {
                (1, name.to_owned())
            }
            Some(windows) if analysis.dt.is_some_and(|dt| is_at_limit(windows, dt)) => {
                (group_of("at the limit of stability".to_owned()), name.to_owned())
            }
            Some([]) => (2, name.to_owned()),
            Some(windows) => {
                let again = if windows.len() > 1 { ", and again later" } else { "" };
                let first = match windows[0] {
                    [Some(0.0), to] => format!("up to {} s", end(to)),
                    [from, to] => {
                        let from = from.map_or("∞".to_owned(), |x| least(x, 4));
                        format!("{from} to {} s", end(to))
                    }
                };
                let limits = format!("{name} ({first}{again})");
                let holds = analysis.dt.map(|dt| is_within(windows, dt));
                let is_unlimited = matches!(windows, [[Some(0.0), None]]);
                match (holds, is_unlimited) {
                    (Some(true) | None, true) => (0, name.to_owned()),
                    (Some(true), false) => (0, limits),
                    (Some(false), _) => (1, limits),
                    (None, false) => (1, limits),
                }
            }
        };
        groups[group].1.push(text);
    }
    for (name, members) in groups.iter().filter(|(_, members)| !members.is_empty()) {
        summary.wrap(&format!("{name}: "), &members.join(", "), 2);
    }
    append_predictions(&analysis.steps, summary);
    if is_one && let Some(radius) = first.predicted_spectral_radius {
        summary.row("spectral radius", &format!("{}, predicted", beside_one(radius - 1.0)));
    }
}

/// Relative difference of a simulated growth from the prediction that is rounding.
const AGREES: [f64; 2] = [1e-12, 1e-4];

/// Appends the largest difference of the growth in simulations from predictions.
pub(super) fn append_predictions(steps: &[StepAnalysis], summary: &mut Summary) {
    let largest = |of: fn(&StepAnalysis) -> Option<f64>| {
        let own = steps.iter().filter_map(|step| {
            let (measured, predicted) = (of(step)?, step.predicted_spectral_radius?);
            Some(((measured - predicted).abs() / predicted.abs().max(1.0), step.integrator))
        });
        own.max_by(|a, b| a.0.total_cmp(&b.0))
    };
    let both = [
        ("f64", AGREES[0], largest(|step| step.simulated.map(|own| own.growth))),
        ("f32", AGREES[1], largest(|step| step.simulated_f32.map(|own| own.growth))),
    ];
    let shown = both.into_iter().filter_map(|(float, rounding, found)| {
        let (size, integrator) = found?;
        Some(match size <= rounding {
            true => format!("as predicted in {float}"),
            false => format!("differs by {} in {float} ({integrator})", significant(size, 2)),
        })
    });
    let shown: Vec<String> = shown.collect();
    if !shown.is_empty() {
        summary.row("simulated growth", &shown.join(", "));
    }
}
