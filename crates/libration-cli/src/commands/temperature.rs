//! `libration analyze --temperature`.

use std::fmt::Write as _;

use libration::thermostat::LangevinMethod;
use libration_analyze::temperature::{
    TemperatureBias, TemperatureError, TemperatureReport, TemperatureRequest, ThermostatReport,
    analyze_temperature, significant,
};
use libration_report::verdict::{Outcome, Verdict, exit_code};
use libration_work::Work;

use super::{equation_file, summary};
use crate::args::AnalyzeArgs;
use crate::error::Failure;
use crate::interrupt;
use crate::progress::Reporter;

/// Returns the temperatures as text or as JSON, and their exit code.
pub(super) fn run(args: &AnalyzeArgs, temperature: f64) -> Result<(String, u8), Failure> {
    let (Some(system), Some(friction)) = (&args.system, args.friction) else {
        return Err(Failure::usage("--temperature requires --system and --friction"));
    };
    let thermostats = match args.thermostat.is_empty() {
        true => LangevinMethod::common(),
        false => args.thermostat.clone(),
    };
    let request = TemperatureRequest {
        system: equation_file::any_system(system)?,
        temperature,
        friction,
        dt: args.dt,
        thermostats,
        steps: args.steps.unwrap_or(AnalyzeArgs::FORECAST_STEPS),
        seed: args.seed.unwrap_or(0),
    };
    let reporter = Reporter::new(args.json);
    let found =
        interrupt::compute(|stop| analyze_temperature(&Work::new(&reporter, stop), &request));
    reporter.clear();
    let found = found.map_err(|error| match error {
        TemperatureError::Interrupted => Failure::Interrupted(error.to_string()),
        error => Failure::usage(error),
    })?;
    let text = match (args.json, args.verbose) {
        (true, _) => serde_json::to_string_pretty(&found).map_err(Failure::run)? + "\n",
        (false, true) => describe(&found),
        (false, false) => summary::of_temperatures(&found, &verdict(&found), &setting(&found)),
    };
    Ok((text, exit_code([&found.verdict])))
}

/// The first option that requires `--temperature`, without it.
pub(super) fn option_without_temperature(args: &AnalyzeArgs) -> Option<Failure> {
    let given = [
        ("--friction", args.friction.is_some()),
        ("--thermostat", !args.thermostat.is_empty()),
        ("--seed", args.seed.is_some()),
    ];
    let (flag, _) = given.into_iter().find(|(_, given)| *given)?;
    Some(Failure::usage(format!("{flag} requires --temperature")))
}

/// One of the two temperatures of a thermostat.
type BiasOf = fn(&ThermostatReport) -> &TemperatureBias;

/// The recommended thermostat in a sentence.
fn verdict(report: &TemperatureReport) -> String {
    let (system, dt) = (&report.system, significant(report.dt));
    let Verdict { outcome, evidence, .. } = &report.verdict;
    match &report.recommended {
        Some(best) => format!(
            "{best} is {outcome} and has the least bias of positions for {system} with steps of {dt} s"
        ),
        None if *outcome == Outcome::Unknown => format!(
            "Whether a thermostat is stable for {system} with steps of {dt} s is not known: {evidence}."
        ),
        None => format!("No thermostat is stable for {system} with steps of {dt} s."),
    }
}

/// The temperature, the friction and the simulation.
fn setting(report: &TemperatureReport) -> String {
    let TemperatureReport { temperature, friction, steps, trajectories, .. } = report;
    let [temperature, friction] = [temperature, friction].map(|x| significant(*x));
    let fastest = significant(report.frequencies.last().copied().unwrap_or(f64::NAN));
    format!(
        "kT = {temperature}, friction {friction} /s, fastest mode {fastest} rad/s, {steps} steps in {trajectories} trajectories"
    )
}

// Writing into a string cannot fail.
fn describe(report: &TemperatureReport) -> String {
    let mut text = format!("{}\n\n  {}\n\n", verdict(report), setting(report));
    let kinds: [(&str, BiasOf); 2] = [
        ("Positions: bias of ⟨−q·F⟩/kT", |one| &one.configuration),
        ("Velocities: bias of ⟨m v²⟩/kT", |one| &one.kinetic),
    ];
    for (title, of) in kinds {
        let _ = writeln!(
            text,
            "{title}\n  {:<16} {:>12} {:>12} {:>22} {:>6} {:>13} {:>11}  fastest mode, z = ω·dt",
            "thermostat",
            "fastest mode",
            "predicted",
            "measured",
            "order",
            "dt at 1 % (s)",
            "stable (s)"
        );
        for one in &report.thermostats {
            let bias = of(one);
            let measured = match (bias.measured_bias, bias.standard_error) {
                (Some(bias), Some(error)) => {
                    format!("{} ± {} %", decimals(100.0 * bias), decimals(100.0 * error))
                }
                _ => "-".to_owned(),
            };
            let _ = writeln!(
                text,
                "  {:<16} {:>12} {:>12} {:>22} {:>6} {:>13} {:>11}  {}",
                one.thermostat,
                percent(bias.fastest_mode_bias),
                percent(bias.predicted_bias),
                measured,
                order(bias, one),
                significant(bias.accurate_dt),
                significant(one.stable_dt),
                bias.formula.as_deref().unwrap_or("depends on the friction"),
            );
        }
        text += "\n";
    }
    for one in &report.thermostats {
        if let Some(note) = &one.note {
            let _ = writeln!(text, "{}: {note}", one.thermostat);
        }
    }
    text += "Predicted: the mean over all modes about the equilibrium, by the exact covariance of the step; order and formula are those of linear forces.\n";
    text += "Measured: on the system itself, with its standard error.\n";
    text
}

/// Returns a relative bias in percent.
fn percent(bias: Option<f64>) -> String {
    bias.map_or_else(|| "-".to_owned(), |bias| format!("{} %", decimals(100.0 * bias)))
}

/// A percentage with three decimals; scientific from a million.
pub(super) fn decimals(x: f64) -> String {
    match x.abs() < 1e6 {
        // Not the negative zero.
        true => format!("{:.3}", (x * 1e3).round() / 1e3 + 0.0),
        false => format!("{x:.2e}"),
    }
}

fn order(bias: &TemperatureBias, of: &ThermostatReport) -> String {
    match bias.order {
        Some(order) => format!("dt^{order}"),
        None if of.stable => "exact".to_owned(),
        None => "-".to_owned(),
    }
}
