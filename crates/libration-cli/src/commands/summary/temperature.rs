//! Temperatures of thermostats.

use libration_analyze::temperature::{TemperatureBias, TemperatureReport, significant};

use libration_report::notation::cut_off;

use super::super::repeat_command::with_option;
use super::super::temperature::decimals;
use super::{Summary, numbers, words};

/// Largest number of thermostats.
const MOST: usize = 8;

/// Standard error of a bias from which more steps are proposed.
const COARSE: f64 = 0.01;

/// Returns a screen of temperatures with this verdict and this setting.
pub(crate) fn of_temperatures(report: &TemperatureReport, verdict: &str, setting: &str) -> String {
    let mut summary = Summary::new(verdict);
    summary.sentence(setting);
    let mut notes: Vec<&String> =
        report.thermostats.iter().filter_map(|one| one.note.as_ref()).collect();
    notes.sort();
    notes.dedup();
    for note in notes {
        let names = report.thermostats.iter().filter(|one| one.note.as_ref() == Some(note));
        let names: Vec<&str> = names.map(|one| one.thermostat.as_str()).collect();
        summary.warnings(&[format!("{}: {note}", names.join(", "))]);
    }
    let percent = |x: Option<f64>| x.map_or("-".to_owned(), |x| decimals(100.0 * x));
    let measured = |bias: &TemperatureBias| match (bias.measured_bias, bias.standard_error) {
        (Some(x), Some(error)) => format!("{:.1} ± {:.1}", 100.0 * x, 100.0 * error),
        _ => "-".to_owned(),
    };
    let rows: Vec<Vec<String>> = report
        .thermostats
        .iter()
        .take(MOST)
        .map(|one| {
            vec![
                one.thermostat.clone(),
                percent(one.configuration.predicted_bias),
                measured(&one.configuration),
                percent(one.kinetic.predicted_bias),
                measured(&one.kinetic),
                significant(cut_off(one.stable_dt, 5)),
            ]
        })
        .collect();
    let heads = [
        words("bias in %"),
        numbers("positions"),
        numbers("measured"),
        numbers("velocities"),
        numbers("measured"),
        numbers("stable up to dt (s)"),
    ];
    summary.blank();
    summary.table(&heads, &rows);
    summary.rest(report.thermostats.len() - rows.len());
    if let Some(best) =
        report.thermostats.iter().find(|one| report.recommended.as_ref() == Some(&one.thermostat))
    {
        let [positions, velocities] = [&best.configuration, &best.kinetic]
            .map(|bias| significant(cut_off(bias.accurate_dt, 5)));
        summary.blank();
        let shown = format!("{positions} s (positions), {velocities} s (velocities)");
        summary.row(
            "bias of 1 % at dt of",
            &format!("{shown} of the fastest mode with {}", best.thermostat),
        );
        if best.configuration.accurate_dt < report.dt {
            let dt = significant(cut_off(best.configuration.accurate_dt, 5));
            summary.command("Take shorter steps", &with_option("--dt", &dt));
        } else if best.configuration.standard_error.is_some_and(|error| error > COARSE) {
            let steps = report.steps.saturating_mul(10).to_string();
            summary.command("Measure with a third of the error", &with_option("--steps", &steps));
        }
    } else if let Some(dt) = report.thermostats.iter().map(|one| one.stable_dt).reduce(f64::max) {
        summary.command("Take shorter steps", &with_option("--dt", &significant(0.5 * dt)));
    }
    summary
        .finish("the bias of the fastest mode, its order and formula, and steps with a bias of 1 %")
}
