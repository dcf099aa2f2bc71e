//! The block of `libration analyze` for a loop around a linear plant.

use std::fmt::Write as _;

use libration_analyze::linear_analysis::ClosedLoop;

use super::mode_text::{counted, known, shape};

/// Appends the modes, the growth, the cost and the deviations of a loop.
pub(super) fn closed_loop(own: &ClosedLoop, text: &mut String) {
    let _ = writeln!(
        text,
        "\nClosed loop with a period of {} s, {} with commands and measurements in transit",
        own.period,
        counted(own.size, "state")
    );
    let mut line = |name: &str, value: String| {
        let _ = writeln!(text, "  {name:<22} {value}");
    };
    line(
        "spectral radius",
        format!("{:?}  (1 {:+e})", own.spectral_radius, own.spectral_radius - 1.0),
    );
    line(
        "second moments",
        format!(
            "{} by {:+.6e} per period, with jitter and losses",
            if own.mean_square_growth < 0.0 { "fall" } else { "grow" },
            own.mean_square_growth.exp_m1()
        ),
    );
    line("verdict", own.verdict.to_string());
    line(
        "cost per second",
        own.cost.map_or_else(|| "infinite: second moments grow".into(), |cost| format!("{cost:?}")),
    );
    let _ = writeln!(
        text,
        "\n{:>4} {:>14} {:>24} {:>12} {:>12} {:>14} {:>14}  states that move most",
        "mode",
        "growth/period",
        "eigenvalue of a period",
        "damping",
        "freq./Hz",
        "nat./(rad/s)",
        "time const./s"
    );
    for (i, mode) in own.modes.iter().enumerate() {
        let [re, im] = mode.eigenvalue;
        let value = if im == 0.0 { format!("{re:.6}") } else { format!("{re:.6} ± {im:.6} i") };
        let _ = writeln!(
            text,
            "{:>4} {:>14.9} {:>24} {:>12} {:>12.6} {:>14.6} {:>14}  {}",
            i + 1,
            mode.growth,
            value,
            known(mode.damping_ratio, 6),
            mode.frequency,
            mode.natural_frequency,
            known(mode.time_constant, 6),
            shape(&mode.states)
        );
    }
    if own.vanishing_modes > 0 {
        let count = counted(own.vanishing_modes, "mode");
        let _ = writeln!(
            text,
            "and {count} of commands and measurements in transit that vanish within a period"
        );
    }
    if !own.deviations.is_empty() {
        let _ = writeln!(text, "\n{:<24} {:<10} {:>14}", "deviation (rms)", "unit", "under noise");
    }
    for deviation in &own.deviations {
        let _ = writeln!(
            text,
            "{:<24} {:<10} {:>14.6e}",
            deviation.state, deviation.unit, deviation.deviation
        );
    }
}
