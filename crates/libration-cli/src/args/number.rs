//! Parsers of numbers.

use std::fmt;

use libration_analyze::comparison;
use libration_settings::{duration, limits};

/// The coordinates of one option.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Coordinates(pub(super) Vec<f64>);

impl Coordinates {
    /// Returns the origin of one degree of freedom.
    pub(super) fn origin() -> Self {
        Coordinates(vec![0.0])
    }

    /// Returns the numbers.
    pub(crate) fn values(&self) -> &[f64] {
        &self.0
    }
}

impl fmt::Display for Coordinates {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let words: Vec<String> = self.0.iter().map(f64::to_string).collect();
        f.write_str(&words.join(","))
    }
}

/// Parses coordinates: finite numbers, separated by commas.
pub(super) fn coordinates(text: &str) -> Result<Coordinates, String> {
    text.split(',').map(coordinate).collect::<Result<_, _>>().map(Coordinates)
}

fn coordinate(word: &str) -> Result<f64, String> {
    let word = word.trim();
    let rule = "expected finite numbers, separated by commas, e.g. 1,-0.5";
    match word.parse::<f64>() {
        _ if word.is_empty() => Err(format!("a coordinate is missing; {rule}")),
        Ok(x) if limits::COORDINATE.admits(x) => Ok(x),
        Ok(_) => Err(format!("`{word}` is not finite; {rule}")),
        Err(_) => Err(format!("`{word}` is not a number; {rule}")),
    }
}

/// Parses `KEY=VALUE`. The system determines which keys and values are allowed.
pub(super) fn assignment(text: &str) -> Result<(String, f64), String> {
    let (key, value) =
        text.split_once('=').ok_or("expected KEY=VALUE, e.g. omega2=10".to_owned())?;
    let (key, value) = (key.trim(), value.trim());
    if key.is_empty() {
        return Err("the key is missing; expected KEY=VALUE, e.g. omega2=10".into());
    }
    let value = value.parse().map_err(|_| format!("the value `{value}` is not a number"))?;
    Ok((key.to_owned(), value))
}

/// Parses a time step in s.
pub(super) fn time_step(text: &str) -> Result<f64, String> {
    let rule =
        || format!("expected a time step that is {}, also as 2ms or 500Hz", limits::TIME_STEP);
    let dt = duration::period(text).ok_or_else(|| format!("not a number; {}", rule()))?;
    limits::within(limits::TIME_STEP, "--dt", dt)?;
    Ok(dt)
}

/// Parses a time step in the unit of a system.
pub(super) fn time_step_of_system(text: &str) -> Result<f64, String> {
    let rule = limits::TIME_STEP;
    let number = text.trim().parse();
    let dt = number.map_err(|_| format!("not a number; expected a time step that is {rule}"))?;
    limits::within(limits::TIME_STEP, "--dt", dt)?;
    Ok(dt)
}

/// Parses a finite number of seconds.
pub(super) fn time(text: &str) -> Result<f64, String> {
    let seconds = duration::seconds(text).filter(|x| x.is_finite());
    seconds.ok_or_else(|| format!("expected {}", duration::DURATION))
}

/// Parses the period of a loop in s.
pub(super) fn period(text: &str) -> Result<f64, String> {
    let seconds = duration::period(text).filter(|x| x.is_finite());
    seconds.ok_or_else(|| format!("expected {}", duration::PERIOD))
}

/// Parses the rate of a loop in Hz, and returns its period in s.
pub(super) fn period_of_rate(text: &str) -> Result<f64, String> {
    let rate = duration::rate(text).filter(|x| x.is_finite() && *x > 0.0);
    let period = rate.map(|rate| 1.0 / rate).filter(|period| period.is_finite());
    period.ok_or_else(|| "expected a rate above 0 in Hz, e.g. 500, 500Hz or 0.5kHz".to_owned())
}

/// Parses the tolerance of a comparison.
pub(super) fn tolerance(text: &str) -> Result<f64, String> {
    let tolerance = text.trim().parse().ok().filter(|x| comparison::TOLERANCES.contains(x));
    tolerance.ok_or_else(|| "expected a number from 1e-13 to 0.1".to_owned())
}

/// Parses the time of a comparison.
pub(super) fn compared_time(text: &str) -> Result<f64, String> {
    let time = duration::seconds(text).filter(|x| limits::CRITERION.contains(x));
    time.ok_or_else(|| "expected a duration between 1e-60 and 1e60 s, also as 10min".to_owned())
}

/// Parses the limit of a criterion.
pub(super) fn criterion(text: &str) -> Result<f64, String> {
    let rule = "expected a number between 1e-60 and 1e60";
    match text.trim().parse::<f64>() {
        Ok(x) if limits::CRITERION.contains(&x) => Ok(x),
        Ok(_) => Err(rule.into()),
        Err(_) => Err(format!("not a number; {rule}")),
    }
}

/// Parses a number of steps of a trajectory; also as `1e6`.
pub(super) fn trajectory_steps(text: &str) -> Result<u64, String> {
    let steps = whole_number(text).ok_or_else(|| {
        format!("not a whole number; expected {}", limits::trajectory_steps_allowed())
    })?;
    limits::trajectory_steps("--steps", steps)
}

/// Parses a number of steps of a forecast; also as `1e12`.
pub(super) fn forecast_steps(text: &str) -> Result<u64, String> {
    let steps = whole_number(text).ok_or_else(|| {
        format!("not a whole number; expected {}", limits::forecast_steps_allowed())
    })?;
    limits::forecast_steps("--steps", steps)
}

/// Parses a whole number, written as `1000` or `1e3`.
pub(super) fn whole_number(text: &str) -> Option<i128> {
    let text = text.trim();
    let with_exponent = || {
        let x: f64 = text.parse().ok()?;
        (x.fract() == 0.0).then_some(x as i128)
    };
    text.parse().ok().or_else(with_exponent)
}

/// Parses a seed.
pub(super) fn seed(text: &str) -> Result<u64, String> {
    let seed = whole_number(text).and_then(|n| u64::try_from(n).ok());
    seed.ok_or_else(|| format!("expected a whole number from 0 to {}", u64::MAX))
}

/// Parses a number of trajectories; also as `1e5`.
pub(super) fn count(text: &str) -> Result<usize, String> {
    let count = whole_number(text).and_then(|n| usize::try_from(n).ok()).filter(|&n| n >= 1);
    count.ok_or_else(|| "expected a whole number of at least 1 and below 2⁶⁴".to_owned())
}
