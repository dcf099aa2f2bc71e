//! `libration analyze` for systems by equations.

use std::fmt::Write as _;

use libration_analyze::AnalyzeError;
use libration_analyze::equation_analysis::{EquationAnalysis, EquationMotion, analyze};
use libration_settings::equations::EquationSystem;

use super::{analyze_linear, summary};
use crate::args::AnalyzeArgs;
use crate::error::Failure;
use crate::interrupt;

/// Returns the analysis as text or as JSON, and the error of steps that do not solve their equations.
pub(super) fn run(
    args: &AnalyzeArgs,
    system: &EquationSystem,
) -> Result<(String, Option<String>), Failure> {
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
    let analysis = analyze(system, method, dt, args.steps, interrupt::listen());
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
    Ok((text, analysis.newton_residual.and_then(|residual| residual.error())))
}

fn describe(analysis: &EquationAnalysis) -> String {
    let EquationAnalysis { system, operating_point, linear, no_modes, motion, .. } = analysis;
    let mut text = format!("{}, {} with dt = {} s\n", system.name, motion.integrator, motion.dt);
    describe_motion(motion, system.smooth, &mut text);
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
    let ratio = |x: Option<f64>| x.map_or_else(|| "-".to_owned(), |x| format!("{x:.4}"));
    let time = motion.error_steps as f64 * motion.dt;
    let _ = writeln!(
        text,
        "\nafter {} steps ({time} s)  {:>20} {:>12} {:>22} {:>12}",
        motion.error_steps, "value", "error", "halved steps reduce by", "predicted"
    );
    let predicted = || match motion.predicted_reduction {
        Some(least) => format!("{least:.0} or more"),
        None => "-".to_owned(),
    };
    for state in &motion.errors {
        let name = match state.unit.as_str() {
            "" => state.name.clone(),
            unit => format!("{} ({unit})", state.name),
        };
        let _ = writeln!(
            text,
            "  {name:<24} {:>20.12e} {:>12.2e} {:>22} {:>12}{}",
            state.value,
            state.error,
            ratio(state.reduction),
            predicted(),
            if motion.is_resolved(state.reduction) {
                ""
            } else {
                "  not resolved: take smaller steps"
            }
        );
    }
    match &motion.energy {
        Some(energy) => {
            let part = match energy.start {
                0.0 => String::new(),
                start => format!(" ({:.2e} of the start)", energy.largest / start.abs()),
            };
            let _ = writeln!(
                text,
                "\nenergy: {} at the start; largest change over {} steps {:.3e}{part}, at step {}; in the end {:+.3e}",
                format!("{:.9e} {}", energy.start, energy.unit).trim_end(),
                energy.steps,
                energy.largest,
                energy.largest_at_step,
                energy.last
            );
            let _ = writeln!(
                text,
                "  halved steps reduce the largest change by {}, predicted {}{}",
                ratio(energy.reduction),
                predicted(),
                if motion.is_resolved(energy.reduction) {
                    ""
                } else {
                    "; not resolved: take smaller steps"
                }
            );
        }
        None => {
            let _ = writeln!(text, "\nenergy: the file has none, so nothing is said of its drift");
        }
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
