//! `libration analyze` for linear plants and loops around them.

use std::fmt::Write as _;
use std::sync::atomic::AtomicBool;

use libration_analyze::linear_analysis::{
    LinearAnalysis, LinearAnalysisError, LinearRequest, Mode, SimulatedMode, StepAnalysis, analyze,
};

use libration_report::verdict::exit_code;

use super::digits::{least, limit};
use super::linear_closed_loop::closed_loop;
use super::mode_text::{counted, known, shape};
use super::summary;
use crate::args::AnalyzeArgs;
use crate::error::Failure;

/// Returns the analysis as text or as JSON, and its exit code.
pub(super) fn run(request: &LinearRequest, args: &AnalyzeArgs) -> Result<(String, u8), Failure> {
    let analysis = analyze(request, &AtomicBool::new(false)).map_err(|error| match error {
        LinearAnalysisError::Interrupted => Failure::Interrupted(error.to_string()),
        error => Failure::usage(error),
    })?;
    let is_one = request.integrator.is_some();
    let text = match (args.json, args.verbose) {
        (true, _) => serde_json::to_string_pretty(&analysis).map_err(Failure::run)? + "\n",
        (false, true) => describe(&analysis, is_one),
        (false, false) => summary::of_plant(&analysis, is_one),
    };
    Ok((text, exit_code(analysis.verdicts.all())))
}

/// Returns the analysis as text.
pub(super) fn describe(analysis: &LinearAnalysis, detail: bool) -> String {
    let mut text = String::new();
    let verdicts = &analysis.verdicts;
    for (what, own) in [("step", &verdicts.step), ("loop", &verdicts.closed_loop)] {
        if let Some(own) = own.as_ref().filter(|_| detail) {
            let _ = writeln!(text, "Verdict on the {what}: {own}");
        }
    }
    plant(analysis, &mut text);
    if let Some(point) = &analysis.operating_point {
        text += &format!("{}\n", point.sentence());
    }
    modes(analysis, &mut text);
    if let (Some(dt), false) = (analysis.dt, analysis.steps.is_empty()) {
        let _ = writeln!(text, "\nSteps of dt = {dt} s");
        steps(&analysis.steps, &mut text);
    }
    stable_steps(analysis, &mut text);
    if detail {
        analysis.steps.iter().for_each(|step| step_modes(step, &mut text));
    }
    if let Some(own) = &analysis.closed_loop {
        closed_loop(own, &mut text);
    }
    if let Some(note) = &analysis.note {
        let _ = writeln!(text, "note: {note}");
    }
    text
}

fn plant(analysis: &LinearAnalysis, text: &mut String) {
    let counts =
        [(&analysis.states, "state"), (&analysis.inputs, "input"), (&analysis.outputs, "output")]
            .map(|(signals, noun)| counted(signals.len(), noun));
    let clock = match analysis.sampling_period {
        Some(period) => format!("sampled every {period} s"),
        None => "in continuous time".to_owned(),
    };
    let kind = if analysis.mechanical { ", positions and velocities" } else { "" };
    let _ = writeln!(text, "Linear plant {clock}: {}{kind}", counts.join(", "));
    let ratio =
        analysis.stiffness.map_or_else(|| "none".to_owned(), |ratio| format!("{ratio:.4e}"));
    let slowest =
        analysis.slowest_rate.map_or_else(|| "none".to_owned(), |rate| format!("{rate:.6} 1/s"));
    let _ = writeln!(
        text,
        "  fastest rate {:.6} 1/s, slowest other than zero {slowest}, stiffness (their ratio) {ratio}",
        analysis.fastest_rate
    );
}

fn modes(analysis: &LinearAnalysis, text: &mut String) {
    let _ = writeln!(
        text,
        "\n{:>4} {:>14} {:>12} {:>14} {:>14} {:>14}  states that move most",
        "mode", "growth/(1/s)", "damping", "nat./(rad/s)", "natural/Hz", "time const./s"
    );
    // Rounding parts eigenvalues that repeat by its root.
    let repeats = |i: usize| {
        let [re, im] = analysis.modes[i].eigenvalue;
        let near = |other: &Mode| {
            let apart = (other.eigenvalue[0] - re).hypot(other.eigenvalue[1] - im);
            apart <= 1e-6 * re.hypot(im)
        };
        analysis.modes.iter().filter(|other| near(other)).count() > 1
    };
    for (i, mode) in analysis.modes.iter().enumerate() {
        let _ = writeln!(
            text,
            "{:>4} {:>14.6} {:>12} {:>14.6} {:>14.6} {:>14}  {}{}{}",
            i + 1,
            mode.growth_rate,
            known(mode.damping_ratio, 6),
            mode.natural_frequency,
            mode.natural_frequency_hz,
            known(mode.time_constant, 6),
            shape(&mode.states),
            match (mode.controllable, repeats(i)) {
                (true, _) => "",
                (false, false) => "; not controllable: no input reaches it",
                (false, true) =>
                    "; not controllable: the inputs do not reach all motions with this eigenvalue",
            },
            match (mode.observable, repeats(i)) {
                (true, _) => "",
                (false, false) => "; not observable: no output shows it",
                (false, true) =>
                    "; not observable: the outputs do not show all motions with this eigenvalue",
            },
        );
        for (is_weak, word, of) in [
            (mode.weakly_controllable, "controllable", mode.controllability),
            (mode.weakly_observable, "observable", mode.observability),
        ] {
            if is_weak {
                let _ = writeln!(
                    text,
                    "     weakly {word}: a change of the plant's numbers by a part of {of:.1e} ends that"
                );
            }
        }
    }
}

/// The table of integrators.
fn steps(all: &[StepAnalysis], text: &mut String) {
    let _ = writeln!(
        text,
        "{:<28} {:>16} {:>16} {:>16} {:>16} {:>22} {:>22}",
        "spectral radius less 1",
        "predicted",
        "update matrix",
        "simulated f64",
        "simulated f32",
        "growth error/(1/s)",
        "phase error/rad"
    );
    for step in all {
        let excess = |radius: Option<f64>| {
            radius.map_or_else(|| "-".to_owned(), |x| format!("{:+.6e}", x - 1.0))
        };
        let simulated = |own: Option<SimulatedMode>| excess(own.map(|own| own.growth));
        let error = |own: Option<(f64, usize)>| match own {
            Some((error, mode)) => format!("{error:+.3e}, mode {}", mode + 1),
            None => "-".to_owned(),
        };
        let _ = writeln!(
            text,
            "{:<28} {:>16} {:>16} {:>16} {:>16} {:>22} {:>22}",
            step.integrator,
            excess(step.predicted_spectral_radius),
            excess(step.spectral_radius),
            simulated(step.simulated),
            simulated(step.simulated_f32),
            error(step.largest_growth_error),
            error(step.largest_phase_error),
        );
    }
}

/// The time steps at which integrators are stable.
fn stable_steps(analysis: &LinearAnalysis, text: &mut String) {
    if analysis.steps.is_empty() {
        return;
    }
    let _ = writeln!(text, "\n{:<28} stable for dt in s", "integrator");
    for step in &analysis.steps {
        let end =
            |x: Option<f64>, cut: fn(f64, usize) -> String| x.map_or("∞".into(), |x| cut(x, 9));
        let window =
            |&[from, to]: &[Option<f64>; 2]| format!("{} to {}", end(from, least), end(to, limit));
        let shown = match &step.stable_dt {
            None => match step.unknown_stable_dt {
                Some(why) => format!("not known, {why}"),
                None => "not known".to_owned(),
            },
            Some(windows) if windows.is_empty() => "none".to_owned(),
            Some(windows) => windows.iter().map(window).collect::<Vec<_>>().join(", "),
        };
        let _ = writeln!(text, "{:<28} {shown}", step.integrator);
    }
    if !analysis.not_applicable.is_empty() {
        let names = analysis.not_applicable.join(", ");
        let _ = writeln!(
            text,
            "not applicable, half of the states are not the rates of the other half: {names}"
        );
    }
}

/// Each mode under steps of one integrator.
fn step_modes(step: &StepAnalysis, text: &mut String) {
    if let Some(function) = &step.stability_function {
        let _ = writeln!(text, "\nstability function, z = dt·λ: {function}");
    }
    let head = |text: &mut String, what: &str| {
        let _ = writeln!(
            text,
            "\n{:>4} {:>22} {:>22} {:>14} {:>14} {:>22} {:>16} {:>8}",
            "mode",
            format!("exact {what}"),
            "step",
            "error/step",
            "error/s",
            "simulated f64",
            "f32 less f64",
            "steps"
        );
    };
    let simulated = |own: Option<SimulatedMode>, of: fn(SimulatedMode) -> f64| own.map(of);
    let shown = |x: Option<f64>| x.map_or_else(|| "-".to_owned(), |x| format!("{x:.15}"));
    let less = |a: Option<f64>, b: Option<f64>| {
        a.zip(b).map_or_else(|| "-".to_owned(), |(a, b)| format!("{:+.3e}", a - b))
    };
    let row = |text: &mut String,
               i: usize,
               values: [f64; 4],
               own: [Option<f64>; 2],
               count: Option<u32>| {
        let [exact, of_step, per_step, per_second] = values;
        let _ = writeln!(
            text,
            "{:>4} {exact:>22.15} {of_step:>22.15} {per_step:>+14.4e} {per_second:>+14.4e} {:>22} {:>16} {:>8}",
            i + 1,
            shown(own[0]),
            less(own[1], own[0]),
            count.map_or_else(|| "-".to_owned(), |count| count.to_string()),
        );
    };
    if step.modes.is_empty() {
        return;
    }
    head(text, "growth per step");
    for (i, mode) in step.modes.iter().enumerate() {
        let own = [mode.simulated, mode.simulated_f32].map(|own| simulated(own, |own| own.growth));
        let values =
            [mode.exact_growth, mode.growth, mode.growth_error_per_step, mode.growth_error];
        row(text, i, values, own, mode.simulated.map(|own| own.steps));
    }
    head(text, "angle/rad");
    for (i, mode) in step.modes.iter().enumerate() {
        let own = [mode.simulated, mode.simulated_f32].map(|own| simulated(own, |own| own.angle));
        let values = [mode.exact_angle, mode.angle, mode.phase_error_per_step, mode.phase_error];
        row(text, i, values, own, mode.simulated.map(|own| own.steps));
    }
}
