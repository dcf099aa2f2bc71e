//! Numbers that a loop cannot be made of.

use thiserror::Error;

use crate::Float;
use crate::control::Jitter;

/// A number that a clock, a delay or a controller cannot have.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
#[error(
    "{name}{} is {}; it must be {allowed}",
    index.map_or_else(String::new, |i| format!(" {i}")),
    shown(*value)
)]
pub struct ControlError {
    /// Which of its numbers.
    pub name: &'static str,
    /// Which of those of that name, from 0 on, if there are several.
    pub index: Option<usize>,
    /// What it is.
    pub value: f64,
    /// What it may be.
    pub allowed: &'static str,
}

/// A number without rows of zeros.
fn shown(value: f64) -> String {
    let plain = value == 0.0 || !value.is_finite() || (1e-6..1e16).contains(&value.abs());
    if plain { value.to_string() } else { format!("{value:e}") }
}

/// `value`, if it is what is allowed.
pub fn ensure(
    name: &'static str,
    value: f64,
    allowed: &'static str,
    holds: impl Fn(f64) -> bool,
) -> Result<(), ControlError> {
    if holds(value) { Ok(()) } else { Err(ControlError { name, index: None, value, allowed }) }
}

/// Neither infinite nor no number, in `T` either.
pub fn finite<T: Float>(name: &'static str, value: f64) -> Result<(), ControlError> {
    ensure(name, value, "a finite number", f64::is_finite)?;
    let held = |x: f64| T::from_f64(x).is_finite();
    ensure(name, value, "small enough for the float type", held)
}

/// [`finite`], and not below zero.
pub fn not_negative<T: Float>(name: &'static str, value: f64) -> Result<(), ControlError> {
    ensure(name, value, "a finite number of at least 0", |x| x >= 0.0 && x.is_finite())?;
    finite::<T>(name, value)
}

/// What [`not_negative`] says of each of several.
pub fn none_negative<T: Float>(name: &'static str, values: &[f64]) -> Result<(), ControlError> {
    let each = values.iter().enumerate().map(|(i, &value)| {
        not_negative::<T>(name, value).map_err(|error| ControlError { index: Some(i), ..error })
    });
    each.collect()
}

/// From 0 to 1.
pub fn probability(name: &'static str, value: f64) -> Result<(), ControlError> {
    ensure(name, value, "from 0 to 1", |x| (0.0..=1.0).contains(&x))
}

/// A law has a standard deviation.
pub fn law<T: Float>(name: &'static str, law: Jitter) -> Result<(), ControlError> {
    not_negative::<T>(name, law.rms())
}
