//! The motion of a system under steps, line by line.

use std::fmt::Write as _;

use libration_analyze::SteppedMotion;

use super::summary;

/// Appends the order, the errors and the energy.
pub(super) fn describe(motion: &SteppedMotion, is_smooth: bool, text: &mut String) {
    // Writing into a string cannot fail.
    let _ = writeln!(text, "  {:<22} {}", "order", order_in_words(motion, is_smooth));
    let _ = writeln!(text, "  {:<22} {} a step", "operations", motion.operations_per_step);
    if let Some(radius) = motion.spectral_radius {
        let _ = writeln!(
            text,
            "  {:<22} 1 {:+.6e}, of the derivative of a step there",
            "at the equilibrium",
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
        None => writeln!(text, "\nenergy: the system has none, so nothing is said of its drift"),
    };
}

/// The errors over all steps, and those that halved steps reduce.
fn describe_errors(motion: &SteppedMotion, text: &mut String) {
    let SteppedMotion { examination, errors, dt, .. } = motion;
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
pub(super) fn order_in_words(motion: &SteppedMotion, is_smooth: bool) -> String {
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
