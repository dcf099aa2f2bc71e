//! `libration analyze`.

use std::fmt::Write as _;

use libration_analyze::{
    AboutEquilibrium, Analysis, AnalyzeError, Criteria, DEFAULT_STEPS, ModifiedHamiltonian,
    OrderOfWord, Request, StepMatrix, Timing, analyze_until,
};
use libration_report::notation::plural;
use libration_report::verdict::{self, exit_code};
use libration_settings::limits;

use super::closed_loop::{dephasing, describe_loop};
use super::digits::{UNKNOWN, exact, short, sum};
use super::motion_text::order_in_words;
use super::simulate::linear_file;
use super::{
    analyze_linear, compare_integrators, equation_file, motion_text, step_matrix, summary,
    temperature,
};
use crate::args::{AnalyzeArgs, CostArgs};
use crate::error::Failure;
use crate::{interrupt, terminal};

/// Analyzes one step and prints the result.
pub(crate) fn run(args: &AnalyzeArgs) -> Result<(), Failure> {
    if args.compare {
        return compare_integrators::run(args);
    }
    // The parser does not require what conflicts with other options.
    let of_comparisons = [("--tolerance", args.tolerance), ("--horizon", args.horizon)];
    if let Some((flag, _)) = of_comparisons.into_iter().find(|(_, value)| value.is_some()) {
        return Err(Failure::usage(format!("{flag} requires --compare")));
    }
    if let Some(temperature) = args.temperature {
        let (text, code) = temperature::run(args, temperature)?;
        return judged(&text, code, None);
    }
    if let Some(failure) = temperature::option_without_temperature(args) {
        return Err(failure);
    }
    if let Some(request) = args.linear_request(linear_file) {
        let (text, code) = analyze_linear::run(&request?, args)?;
        return judged(&text, code, None);
    }
    let (Some(options), Some(stepping), Some(dt)) = (&args.system, args.integrator, args.dt) else {
        return Err(Failure::usage("--system is required without --plant and --config"));
    };
    let system = equation_file::any_system(options)?;
    if let (None, Some(flag)) = (system.twin, args.loop_option()) {
        return Err(Failure::usage(format!(
            "{flag} requires a system of the catalogue; a loop around equations is that of their plant: --plant FILE with --lqr or --gain"
        )));
    }
    let CostArgs { loss, cost_weights: weights } = args.cost;
    let timing = Timing { loss, weights, ..args.timing.timing() };
    let steps = args.steps.unwrap_or(DEFAULT_STEPS);
    if !system.is_linear() {
        // What cannot be forecast is simulated.
        limits::steps("--steps", steps.into()).map_err(Failure::usage)?;
    }
    let criteria = Criteria {
        max_drift: args.max_drift,
        max_amplitude: args.max_amplitude,
        max_error: args.max_error,
    };
    let request = Request { system, stepping, dt, steps, criteria, timing };
    let analysis = interrupt::compute(|stop| analyze_until(&request, stop));
    let analysis = analysis.map_err(|error| match error {
        AnalyzeError::Interrupted => Failure::Interrupted(error.to_string()),
        error => Failure::usage(error),
    })?;
    let order = |motion| order_in_words(motion, analysis.system.smooth);
    let order = analysis.motion.as_ref().map(order);
    let text = match (args.json, args.verbose) {
        (true, _) => serde_json::to_string_pretty(&analysis).map_err(Failure::run)? + "\n",
        (false, true) => describe(&analysis, &request),
        (false, false) => summary::of_analysis(&analysis, &request, order.as_deref()),
    };
    let residual = analysis.newton_residual.and_then(|residual| residual.error());
    judged(&text, exit_code(analysis.verdicts.all()), residual)
}

/// Prints a result, and fails if one of its verdicts is not good or its steps do not solve their equations.
fn judged(text: &str, code: u8, residual: Option<String>) -> Result<(), Failure> {
    print(text)?;
    match (residual, code) {
        (Some(error), _) => Err(Failure::run(error)),
        (None, verdict::GOOD) => Ok(()),
        (None, _) => Err(Failure::Disagreement),
    }
}

/// The properties of a splitting method.
fn certified(word: &OrderOfWord) -> String {
    let OrderOfWord { stages, order, nystrom_order, weak_order, symmetric, error_constant, .. } =
        word;
    let mut text = plural(*stages, "evaluation") + " a step";
    if nystrom_order > order {
        text += &format!(", order {nystrom_order} for forces of positions");
    }
    if weak_order > nystrom_order {
        text += &format!(", order {weak_order} in weak kicks");
    }
    text += if *symmetric { ", symmetric" } else { ", not symmetric" };
    text + &format!(", error constant {error_constant:.3e}")
}

/// Prints the result.
fn print(text: &str) -> Result<(), Failure> {
    Ok(terminal::print(text)?)
}

/// Returns the analysis as text.
fn describe(analysis: &Analysis, request: &Request) -> String {
    let of_system = summary::named(&analysis.system);
    let mut text = format!("{of_system}, {} with dt = {} s\n", analysis.integrator, analysis.dt);
    for (what, own) in [
        ("verdict on the step", &analysis.verdicts.step),
        ("verdict on the motion", &analysis.verdicts.motion),
        ("verdict on the loop", &analysis.verdicts.closed_loop),
    ] {
        if let Some(own) = own {
            text += &format!("  {what:<22} {own}\n");
        }
    }
    if let Some(note) = &analysis.note {
        text += &format!("note: {note}\n");
    }
    if let Some(motion) = &analysis.motion {
        motion_text::describe(motion, analysis.system.smooth, &mut text);
    }
    if let Some(matrix) = &analysis.matrix {
        describe_step(matrix, analysis, request, &mut text);
    }
    if let Some(timing) = &analysis.timing {
        if let Some(steps) = timing.dephasing_steps {
            text += &format!("  {:<22} {}\n", "mean falls to 1/e in", dephasing(steps));
        }
        describe_loop(timing, &request.timing, &mut text);
    }
    if let (Some(motion), Some(steps)) = (&analysis.motion, &analysis.steps_along_motion) {
        text += &format!("\nalong the motion: {}\n", summary::along_motion(steps, motion));
    }
    if let Some(about) = &analysis.equilibrium {
        describe_equilibrium(about, &mut text);
    }
    text
}

/// Appends the step from the start without feedback.
fn describe_step(matrix: &StepMatrix, analysis: &Analysis, request: &Request, text: &mut String) {
    text.push_str(match analysis.timing {
        Some(_) => "Open loop: one step of the plant\n",
        None => "\none step from the start, as a matrix\n",
    });
    // Writing into a string cannot fail.
    let mut line = |name: &str, value: String| {
        let _ = writeln!(text, "  {name:<22} {value}");
    };
    step_matrix::describe(matrix, analysis.update_matrix_in_z.as_deref(), &mut line);
    if let Some(bounded) = analysis.bounded {
        line("orbits", if bounded { "bounded" } else { "unbounded" }.into());
    }
    if let Some(windows) = &analysis.stability_windows {
        let end = |x: Option<f64>| x.map_or("∞".into(), exact);
        let shown: Vec<String> =
            windows.iter().map(|&[from, to]| format!("{} to {}", end(from), end(to))).collect();
        let shown = if shown.is_empty() { "none".into() } else { shown.join(", ") };
        line("stable for dt in s", shown);
    }
    let mut largest = |what: &str, limit: Option<f64>, dt: Option<Option<f64>>| {
        if let Some(limit) = limit {
            line("largest dt in s", format!("{} for {what} {}", known(dt), short(limit)));
        }
    };
    if let Some(dt) = &analysis.largest_dt {
        let criteria = &request.criteria;
        largest("drift", criteria.max_drift, dt.energy_drift);
        largest("drift from the worst start", criteria.max_drift, dt.energy_drift_worst_start);
        largest("amplitude", criteria.max_amplitude, dt.amplitude);
        largest("error", criteria.max_error, dt.trajectory_error);
    }
    if let Some(form) = &analysis.modified_hamiltonian {
        let ModifiedHamiltonian { qq, qv, vv } = form;
        line("conserved", sum(&[(*vv, "v²"), (2.0 * qv, "q v"), (*qq, "q²")]));
    }
    if let Some(word) = &analysis.order_of_word {
        line("splitting", format!("order {}: {}", word.order, word.word.join(", ")));
        line("", certified(word));
    }
    step_matrix::describe_defects(matrix, &mut line);
    if let Some(drift) = &analysis.drift {
        line(
            "largest energy drift",
            format!(
                "{} of the start, at step {} of {} (exact)",
                drift.max_energy_drift, drift.max_energy_drift_step, analysis.steps
            ),
        );
    }
}

/// Appends the equilibrium near the start and the system about it.
fn describe_equilibrium(about: &AboutEquilibrium, text: &mut String) {
    text.push('\n');
    if let Some(point) = &about.operating_point {
        *text += &format!("{}\n", point.sentence());
    }
    if let Some(linear) = &about.linear {
        *text += &analyze_linear::describe(linear, false);
    }
    if let Some(reason) = &about.no_modes {
        *text += &format!("No modes: {reason}.\n");
    }
}

/// Returns a largest time step as text.
fn known(dt: Option<Option<f64>>) -> String {
    match dt {
        Some(Some(dt)) => exact(dt),
        Some(None) => "any".into(),
        None => UNKNOWN.into(),
    }
}
