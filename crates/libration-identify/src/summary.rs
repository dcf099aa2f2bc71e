//! An identification in sentences.

use libration_report::notation::{self, number};

use crate::identification::Identification;
use crate::parameters::Estimated;
use crate::response::ResponseKind;

/// A time with four digits.
pub(crate) fn seconds(time: f64) -> String {
    notation::seconds(time, 4)
}

/// A value with its unit.
pub fn with_unit(value: f64, unit: &str) -> String {
    match unit {
        "s" => seconds(value),
        "" => number(value, 4),
        unit => format!("{} {unit}", number(value, 4)),
    }
}

/// The interval of a parameter in words; empty for a given number.
pub fn interval(parameter: &Estimated) -> String {
    let Some(interval) = parameter.interval else { return String::new() };
    let low = with_unit(interval.low, &parameter.unit);
    match interval.high {
        Some(high) => format!("{low} to {}", with_unit(high, &parameter.unit)),
        None => format!("{low} or more"),
    }
}

/// The answer.
pub(crate) fn answer(found: &Identification) -> String {
    let mut numbers: Vec<String> = Vec::new();
    for parameter in &found.parameters {
        let is_noise = matches!(
            &*parameter.key,
            "load" | "noise_std" | "coloured_std" | "correlation_time" | "disturbance"
        );
        if is_noise {
            continue;
        }
        let value = with_unit(parameter.value, &parameter.unit);
        numbers.push(match parameter.interval {
            Some(_) => format!("{} {value} ({})", parameter.name, interval(parameter)),
            None => format!("{} {value}", parameter.name),
        });
    }
    let form = ResponseKind::SIMPLE.iter().find(|kind| kind.name() == found.response).map_or(
        "a lag of first order after a dead time, before the given plant",
        ResponseKind::in_words,
    );
    let verdict = match found.is_contradicted {
        false => "The residuals do not contradict the model.",
        true if !found.residuals.contradict() => {
            "Too many commands are missing from the log: the intervals cannot be trusted."
        }
        true => "The residuals contradict the model: its intervals cannot be trusted.",
    };
    if !found.depends_on_command {
        return "The response does not depend on this command: no model with it is better than one without.".to_owned();
    }
    let mut text = format!(
        "The response is {form}: {}. The noise is {}. {verdict}",
        numbers.join(", "),
        found.noise.in_words()
    );
    if let Some(correlation) = found.correlation.filter(|correlation| *correlation < -0.9) {
        text += &format!(
            " With this command the errors of dead time and lag have the correlation {correlation:.2}: their sum is known better than each of them."
        );
    }
    text
}
