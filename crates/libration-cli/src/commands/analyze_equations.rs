//! `libration analyze` for systems by equations.

use std::fmt::Write as _;

use libration_analyze::equation_analysis::{EquationAnalysis, EquationMotion, analyze};
use libration_analyze::{AnalyzeError, DEFAULT_STEPS};
use libration_report::verdict::exit_code;
use libration_settings::equations::EquationSystem;

use super::{analyze_linear, step_matrix, summary};
use crate::args::AnalyzeArgs;
use crate::error::Failure;
use crate::interrupt;

/// Returns the analysis as text or as JSON, its exit code, and the error of steps that do not solve their equations.
pub(super) fn run(
    args: &AnalyzeArgs,
    system: &EquationSystem,
) -> Result<(String, u8, Option<String>), Failure> {
    let (Some(stepping), Some(dt)) = (args.integrator, args.dt) else {
        return Err(Failure::usage("--integrator and --dt are required with --system"));
    };
    if let Some(flag) = args.unsupported_for_equations() {
        return Err(Failure::usage(format!(
            "{flag} requires a system of the catalogue; a loop around equations is that of their plant: --plant FILE with --lqr or --gain"
        )));
    }
    let Some(method) = stepping.any_method() else {
        return Err(Failure::usage(
            "--integrator exact: exact steps require a linear system of the catalogue or --plant",
        ));
    };
    let steps = args.steps.unwrap_or(DEFAULT_STEPS);
    let analysis = interrupt::compute(|stop| analyze(system, method, dt, steps, stop));
    let analysis = analysis.map_err(|error| match error {
        AnalyzeError::Interrupted => Failure::Interrupted(error.to_string()),
        error => Failure::usage(error),
    })?;
    let text = match (args.json, args.verbose) {
        (true, _) => serde_json::to_string_pretty(&analysis).map_err(Failure::run)? + "\n",
        (false, true) => describe(&analysis),
        (false, false) => {
            let order = order_in_words(&analysis.motion, analysis.system.smooth);
            summary::of_equations(&analysis, &order)
        }
    };
    let residual = analysis.newton_residual.and_then(|residual| residual.error());
    Ok((text, exit_code(analysis.verdicts.all()), residual))
}

fn describe(analysis: &EquationAnalysis) -> String {
    let EquationAnalysis { system, operating_point, linear, no_modes, motion, .. } = analysis;
    let mut text = format!("{}, {} with dt = {} s\n", system.name, motion.integrator, motion.dt);
    if let Some(step) = &analysis.verdicts.step {
        text += &format!("  verdict on the step  {step}\n");
    }
    if let Some(motion) = &analysis.verdicts.motion {
        text += &format!("  of the motion        {motion}\n");
    }
    describe_motion(motion, system.smooth, &mut text);
    if let Some(matrix) = &analysis.matrix {
        text += "\none step from the start, as a matrix\n";
        let mut line = |name: &str, value: String| {
            let _ = writeln!(text, "  {name:<20} {value}");
        };
        step_matrix::describe(matrix, None, &mut line);
        step_matrix::describe_defects(matrix, &mut line);
    }
    let steps = summary::along_motion(&analysis.steps_along_motion, motion);
    text += &format!("\nalong the motion: {steps}\n");
    text += "\n";
    if let Some(point) = operating_point {
        text += &format!("{}\n", point.sentence());
    }
    if let Some(linear) = linear {
        text += &analyze_linear::describe(linear, false);
    }
    if let Some(reason) = no_modes {
        text += &format!("No modes: {reason}.\n");
    }
    text
}

// Writing into a string cannot fail.
fn describe_motion(motion: &EquationMotion, is_smooth: bool, text: &mut String) {
    let _ = writeln!(text, "  order                {}", order_in_words(motion, is_smooth));
    let _ = writeln!(text, "  operations           {} a step", motion.operations_per_step);
    if let Some(radius) = motion.spectral_radius {
        let _ = writeln!(
            text,
            "  spectral radius      1 {:+.6e}, of the derivative of a step at the equilibrium below",
            radius - 1.0
        );
    }
    if let Some(step) = motion.diverged_at_step {
        let _ = writeln!(text, "  a state is not finite after step {step}");
    }
    describe_errors(motion, text);
    let _ = match &motion.energy {
        Some(energy) => writeln!(
            text,
            "\nenergy: {} at the start; {}\n  largest change at step {}; in the end {:+.3e}",
            format!("{:.9e} {}", energy.start, energy.unit).trim_end(),
            summary::energy_change(energy),
            energy.largest_at_step,
            energy.last
        ),
        None => writeln!(text, "\nenergy: the file has none, so nothing is said of its drift"),
    };
}

/// The errors over all steps, and those that halved steps reduce.
fn describe_errors(motion: &EquationMotion, text: &mut String) {
    let EquationMotion { examination, errors, dt, .. } = motion;
    let examined = examination.examined_steps;
    let _ = writeln!(
        text,
        "\nagainst the exact motion ({}, known to {:.1e}), {examined} of {} steps ({} s)\n  {:<24} {:>20} {:>12} {:>12}",
        examination.reference,
        examination.reference_error,
        examination.requested_steps,
        examined as f64 * dt,
        "state",
        "size of the motion",
        "error",
        "at step"
    );
    let named = |name: &str, unit: &str| match unit {
        "" => name.to_owned(),
        unit => format!("{name} ({unit})"),
    };
    for state in &examination.states {
        let _ = writeln!(
            text,
            "  {:<24} {:>20.6e} {:>12.2e} {:>12}{}",
            named(&state.name, &state.unit),
            state.range,
            state.largest_error,
            state.largest_error_at_step,
            if state.resolved { "" } else { "  not resolved" }
        );
    }
    let ratio = |x: Option<f64>| x.map_or_else(|| "-".to_owned(), |x| format!("{x:.4}"));
    let _ = writeln!(
        text,
        "\nafter {} steps ({} s)  {:>20} {:>12} {:>22} {:>12}",
        motion.error_steps,
        motion.error_steps as f64 * dt,
        "value",
        "error",
        "halved steps reduce by",
        "predicted"
    );
    let predicted = motion.predicted_reduction;
    for state in errors {
        let _ = writeln!(
            text,
            "  {:<24} {:>20.12e} {:>12.2e} {:>22} {:>12}",
            named(&state.name, &state.unit),
            state.value,
            state.error,
            ratio(state.reduction),
            predicted.map_or_else(|| "-".to_owned(), |least| format!("{least:.0} or more"))
        );
    }
}

/// The order of steps, with its restrictions.
fn order_in_words(motion: &EquationMotion, is_smooth: bool) -> String {
    let classical = motion.classical_order;
    let order = match motion.order {
        Some(order) if motion.order_is_certified => format!("{order}, by its certificate"),
        Some(order) if order == classical => format!("{order}, derived with 1024 bits"),
        Some(order) if order < classical => format!(
            "{order}, derived with 1024 bits; {classical} where forces depend on positions alone"
        ),
        Some(order) => format!("{order}, derived with 1024 bits; {classical} in general"),
        None => "none: a step has no error, or no derivative".to_owned(),
    };
    let kinks = if is_smooth {
        ""
    } else {
        "; the equations have kinks or jumps, beyond which it does not hold"
    };
    format!("{order}{kinks}")
}
