//! `libration analyze`.

use std::fmt::Write as _;
use std::io::{self, Write as _};

use libration_lab::analyze::{
    self, Analysis, Criteria, ModifiedHamiltonian, Request, Stepping, Timing, TimingAnswer,
};
use libration_lab::config::limits;
use libration_lab::setting::Setting;

use crate::args::{AnalyzeArgs, CostArgs};
use crate::error::Failure;

/// Analyses one step and prints what theory says of it.
pub(crate) fn run(args: &AnalyzeArgs) -> Result<(), Failure> {
    let Setting { system, q, v } = args.system.resolve()?;
    let (stepping, dt) = (args.step.integrator, args.step.dt);
    let CostArgs { loss, cost_weights: weights } = args.cost;
    let timing = Timing { loss, weights, ..args.timing.timing() };
    if !system.is_linear() {
        // What cannot be forecast is simulated.
        limits::steps("--steps", args.steps.into()).map_err(Failure::usage)?;
    }
    let criteria = Criteria {
        max_drift: args.max_drift,
        max_amplitude: args.max_amplitude,
        max_error: args.max_error,
    };
    let request = Request { system, stepping, dt, q, v, steps: args.steps, criteria, timing };
    let analysis = analyze::analyze(&request).map_err(Failure::usage)?;
    let text = match args.json {
        true => serde_json::to_string_pretty(&analysis).map_err(Failure::run)? + "\n",
        false => describe(&analysis, &request.criteria),
    };
    match io::stdout().lock().write_all(text.as_bytes()) {
        // A reader that has seen enough is not an error.
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        outcome => Ok(outcome?),
    }
}

/// The analysis for a reader at a terminal.
fn describe(analysis: &Analysis, criteria: &Criteria) -> String {
    let about = &analysis.about;
    let parameters: Vec<String> =
        about.parameters.iter().map(|(name, value)| format!("{name} = {value}")).collect();
    let mut text = format!(
        "{} ({}), {} with dt = {} s\n",
        about.system,
        parameters.join(", "),
        about.integrator,
        about.dt
    );
    // Writing into a string cannot fail.
    let mut line = |name: &str, value: String| {
        let _ = writeln!(text, "  {name:<22} {value}");
    };
    let rows = |rows: &[Vec<f64>]| -> Vec<String> {
        rows.iter().map(|r| r.iter().map(|x| format!("{x:>24?}")).collect()).collect()
    };
    for (i, row) in rows(&analysis.update_matrix).into_iter().enumerate() {
        line(if i == 0 { "update matrix" } else { "" }, row.trim_end().to_owned());
    }
    if let Some(symbolic) = &analysis.update_matrix_in_z {
        for (i, row) in symbolic.iter().enumerate() {
            let name = if i == 0 { "at omega = 1, z = dt" } else { "" };
            line(name, row.iter().map(|entry| format!("{entry:>24}")).collect());
        }
    }
    line(
        "determinant",
        format!("{:?}  (1 {:+e})", analysis.determinant, analysis.determinant_minus_one),
    );
    line("trace", format!("{:?}", analysis.trace));
    for (i, [re, im]) in analysis.eigenvalues.iter().enumerate() {
        let sign = if im.is_sign_negative() { '-' } else { '+' };
        let name = if i == 0 { "eigenvalues" } else { "" };
        line(name, format!("{re:?} {sign} {:?} i", im.abs()));
    }
    let excess = analysis.spectral_radius_minus_one;
    line("spectral radius", format!("{:?}  (1 {excess:+e})", analysis.spectral_radius));
    if let Some(bounded) = analysis.bounded {
        line("orbits", if bounded { "bounded" } else { "unbounded" }.into());
    }
    if let Some(windows) = &analysis.stability_windows {
        let end = |x: Option<f64>| x.map_or("∞".into(), |x| format!("{x:?}"));
        let shown: Vec<String> =
            windows.iter().map(|&[from, to]| format!("{} to {}", end(from), end(to))).collect();
        let shown = if shown.is_empty() { "none".into() } else { shown.join(", ") };
        line("stable for dt in s", shown);
    }
    let one_mode = matches!(about.system, "oscillator" | "damped-oscillator");
    let derived = about.integrator != Stepping::EXACT;
    if analysis.stability_windows.is_none() && one_mode && derived {
        line("stable for dt in s", UNKNOWN.into());
    }
    let mut largest = |what: &str, asked: Option<f64>, dt: Option<Option<f64>>| {
        if let Some(asked) = asked {
            line("largest dt in s", format!("{} for {what} {asked:?}", known(dt)));
        }
    };
    if let Some(dt) = &analysis.largest_dt {
        largest("drift", criteria.max_drift, dt.energy_drift);
        largest("drift from the worst start", criteria.max_drift, dt.energy_drift_worst_start);
        largest("amplitude", criteria.max_amplitude, dt.amplitude);
        largest("error", criteria.max_error, dt.trajectory_error);
    }
    if let Some(form) = &analysis.modified_hamiltonian {
        let ModifiedHamiltonian { qq, qv, vv } = form;
        line("conserved", format!("{vv:?} v² {:+?} q v {qq:+?} q²", 2.0 * qv));
    }
    if let Some(word) = &analysis.order_of_word {
        line("splitting", format!("order {}: {}", word.order, word.word.join(", ")));
    }
    line("symplecticity defect", format!("{:e}", analysis.symplecticity_defect));
    line("reversibility defect", format!("{:e}", analysis.reversibility_defect));
    line(
        "phase error per step",
        match analysis.phase_error_per_step {
            Some(error) => format!("{error:e} rad"),
            None => "none: nothing oscillates".into(),
        },
    );
    line("force evaluations", format!("{} a step", analysis.force_evaluations_per_step));
    line(
        "largest energy drift",
        match &analysis.drift {
            Some(drift) => {
                let stopped = drift.stopped_at_step.map_or_else(String::new, |step| {
                    format!("; the state leaves the range of f64 at step {step}")
                });
                let size = match drift.max_energy_drift.get() {
                    "null" => "beyond the range of f64; more than any part",
                    size => size,
                };
                format!(
                    "{size} of the start, at step {} of {} ({}{stopped})",
                    drift.max_energy_drift_step, about.steps, drift.max_energy_drift_method
                )
            }
            None => "undefined: the energy at the start is zero".into(),
        },
    );
    if let Some(timing) = &analysis.timing {
        describe_timing(timing, &mut text);
    }
    if let Some(note) = &about.note {
        let _ = writeln!(text, "note: {note}");
    }
    text
}

/// What timing does to the loop.
fn describe_timing(timing: &TimingAnswer, text: &mut String) {
    let mut line = |name: &str, value: String| {
        let _ = writeln!(text, "  {name:<22} {value}");
    };
    let number = |x: Option<f64>, unit: &str| {
        x.map_or_else(|| "none".to_owned(), |x| format!("{x:?} {unit}"))
    };
    if let (Some([kp, kd]), Some(steps)) = (timing.feedback, timing.latency_steps) {
        line("command", format!("-{kp:?} q - {kd:?} v, {steps:?} steps late"));
    }
    if let Some(critical) = &timing.critical {
        line("critical latency", number(critical.critical_latency_steps, "steps"));
        line("", number(critical.critical_latency_seconds, "s"));
        line("of split steps", number(critical.critical_latency_split_steps, "steps"));
        let end = |x: Option<f64>| x.map_or("∞".into(), |x| format!("{x:?}"));
        let shown: Vec<String> = critical
            .latency_windows
            .iter()
            .map(|&(from, to)| format!("{from:?} to {}", end(to)))
            .collect();
        let shown = if shown.is_empty() { "none".into() } else { shown.join(", ") };
        line("stable, steps late", shown);
        line("continuous margin", number(critical.delay_margin_seconds, "s"));
    }
    if let (Some(radius), Some(growth)) = (timing.mean_square_radius, timing.mean_square_growth) {
        let grown = radius.zip(growth);
        let shown = grown.map(|(radius, growth)| format!("{radius:?} a step  (1 {growth:+e})"));
        line("second moments grow by", shown.unwrap_or_else(|| TOO_FAR.into()));
        if timing.jitter_clips == Some(true) {
            line("", CLIPPED.into());
        }
    }
    if let Some(exponent) = timing.lyapunov_exponent {
        let late = timing.latency_steps.is_some_and(|steps| steps > 0.0);
        let shown = if late { LATE.into() } else { number(exponent, "a step") };
        line("a typical run grows", shown);
    }
    if let Some(cost) = &timing.cost {
        let [q, v, u] = cost.cost_weights;
        let command = if u == 0.0 { String::new() } else { format!(" {u:+?} u²") };
        let of = format!("{q:?} q² {v:+?} v²{command} under unit noise");
        line(
            "cost",
            match (cost.cost, cost.cost_infinite) {
                (Some(cost), _) => format!("{cost:?}, the mean of {of}"),
                (None, Some(_)) => "infinite: second moments grow".into(),
                (None, None) => "not known: the loop has to know too many numbers".into(),
            },
        );
        if let Some(increase) = cost.cost_increase {
            line("", format!("{:+e} of that of an ideal clock and link", increase));
        }
    }
    if let Some(steps) = timing.dephasing_steps {
        line("mean falls to 1/e in", number(steps, "steps"));
    }
}

/// Why there are no second moments.
const TOO_FAR: &str =
    "not known: steps turn too far in a deviation, or the latency is above 90 steps";

/// Why there is no exponent.
const LATE: &str = "not known with a latency";

/// The rule of steps that would be negative.
const CLIPPED: &str = "some steps would be negative: they are of length zero";

/// What stands for a number that is not derived.
const UNKNOWN: &str = "not known: the polynomials of this step outgrow exact arithmetic";

/// A largest time step, in words where there is none.
fn known(dt: Option<Option<f64>>) -> String {
    match dt {
        Some(Some(dt)) => format!("{dt:?}"),
        Some(None) => "any".into(),
        None => UNKNOWN.into(),
    }
}
