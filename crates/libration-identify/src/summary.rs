//! An identification in sentences.

use libration_report::Outcome;
use libration_report::notation::{self, number};

use crate::identification::Identification;
use crate::parameters::Estimated;
use crate::response::ResponseKind;
use crate::start::Start;

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

fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
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
    let evidence = &found.verdict.evidence;
    match (found.depends_on_command, found.verdict.outcome) {
        (true, _) => {}
        (false, Outcome::Unknown) => {
            return format!("Whether the response depends on this command is unknown: {evidence}.");
        }
        (false, _) => return format!("{}.", capitalised(evidence)),
    }
    let judgement = match found.verdict.outcome {
        Outcome::NoFault => "The residuals do not contradict the model.".to_owned(),
        Outcome::Unknown => {
            format!(
                "Whether these numbers are right is unknown: {evidence}. They have no intervals."
            )
        }
        _ => format!("{}. The numbers have no intervals.", capitalised(evidence)),
    };
    let start = match found.start {
        Start::Rest => " It starts from rest under the first command.",
        Start::Held => " It starts in motion under the first command.",
        Start::Unknown => "",
    };
    let mut text = format!(
        "The response is {form}: {}.{start} The noise is {}. {judgement}",
        numbers.join(", "),
        found.noise.in_words()
    );
    let correlation = found.correlation.filter(|_| found.has_intervals());
    if let Some(correlation) = correlation.filter(|correlation| *correlation < -0.9) {
        text += &format!(
            " With this command the errors of dead time and lag have the correlation {correlation:.2}: their sum is known better than each of them."
        );
    }
    text
}
