//! Errors of the parameters of a loop.

use thiserror::Error;

use crate::Float;
use crate::control::Jitter;

/// An invalid parameter of a clock, a delay, a controller or an environment.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[error(
    "{name}{} is {}; it must be {allowed}",
    index.map_or_else(String::new, |i| format!(" {i}")),
    shown(*value)
)]
pub struct ControlError {
    /// The name of the parameter.
    pub name: &'static str,
    /// The index, from 0, if several have that name.
    pub index: Option<usize>,
    /// The value.
    pub value: f64,
    /// The allowed values.
    pub allowed: &'static str,
}

/// The number, with an exponent instead of many zeros.
fn shown(value: f64) -> String {
    let plain = value == 0.0 || !value.is_finite() || (1e-6..1e16).contains(&value.abs());
    if plain { value.to_string() } else { format!("{value:e}") }
}

/// Returns an error unless `holds(value)`.
pub fn ensure(
    name: &'static str,
    value: f64,
    allowed: &'static str,
    holds: impl Fn(f64) -> bool,
) -> Result<(), ControlError> {
    if holds(value) { Ok(()) } else { Err(ControlError { name, index: None, value, allowed }) }
}

/// Returns an error unless `value` is finite, in `T` as well.
pub fn ensure_finite<T: Float>(name: &'static str, value: f64) -> Result<(), ControlError> {
    ensure(name, value, "a finite number", f64::is_finite)?;
    let held = |x: f64| T::from_f64(x).is_finite();
    ensure(name, value, "small enough for the float type", held)
}

/// Returns an error unless `value` is [`ensure_finite`] and at least 0.
pub fn ensure_not_negative<T: Float>(name: &'static str, value: f64) -> Result<(), ControlError> {
    ensure(name, value, "a finite number of at least 0", |x| x >= 0.0 && x.is_finite())?;
    ensure_finite::<T>(name, value)
}

/// Applies [`ensure_not_negative`] to each value.
pub fn ensure_none_negative<T: Float>(
    name: &'static str,
    values: &[f64],
) -> Result<(), ControlError> {
    let each = values.iter().enumerate().map(|(i, &value)| {
        ensure_not_negative::<T>(name, value)
            .map_err(|error| ControlError { index: Some(i), ..error })
    });
    each.collect()
}

/// Returns an error unless `value` is from 0 to 1.
pub fn ensure_probability(name: &'static str, value: f64) -> Result<(), ControlError> {
    ensure(name, value, "from 0 to 1", |x| (0.0..=1.0).contains(&x))
}

/// Returns an error unless the standard deviation of the distribution is valid.
pub fn ensure_law<T: Float>(name: &'static str, law: Jitter) -> Result<(), ControlError> {
    ensure_not_negative::<T>(name, law.rms())
}
