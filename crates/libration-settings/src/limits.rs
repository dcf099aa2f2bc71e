//! Allowed values of numbers in settings files and flags.

use std::ops::RangeInclusive;

use libration::catalog::Allowed;

/// Time steps, in s.
pub const TIME_STEP: Allowed = Allowed::Positive;
/// Masses in kg and stiffnesses in N/m.
pub const SPRING: Allowed = Allowed::Positive;
/// Initial coordinates.
pub const COORDINATE: Allowed = Allowed::Finite;
/// Error tolerances.
pub const TOLERANCE: Allowed = Allowed::Positive;
/// Numbers of steps.
pub const STEPS: RangeInclusive<u64> = 1..=1_000_000_000;

/// Numbers of steps of a trajectory. Up to 2⁵³ an `f64` represents each step, so that time is a step times `dt`.
pub const TRAJECTORY_STEPS: RangeInclusive<u64> = 1..=1 << 53;

/// Numbers of steps of the closed-form forecast of a linear system.
pub const FORECAST_STEPS: RangeInclusive<u64> = 1..=1_000_000_000_000_000;

/// Sizes of nonzero parameters and of times in s that theory accepts: derived numbers must stay within the range of floats.
pub const SIZE: RangeInclusive<f64> = 1e-60..=1e60;
/// Largest angle of a motion in an analysed exact step, in rad. Beyond it 1024 bits lose too many digits.
pub const MOST_TURN: f64 = 1e9;

/// The first of `parameters` whose size is outside [`SIZE`].
pub fn find_out_of_range(
    parameters: impl IntoIterator<Item = (&'static str, f64)>,
) -> Option<(&'static str, f64)> {
    parameters.into_iter().find(|(_, value)| *value != 0.0 && !SIZE.contains(&value.abs()))
}

/// Largest size of a settings file in bytes: a hundred times the longest default.
pub const SETTINGS_BYTES: u64 = 1 << 20;

/// Largest gain or weight of a loop: products must stay within the range of floats.
pub const MOST_GAIN: f64 = 1e50;
/// Largest relative rms of step times and clock rates.
pub const MOST_RMS: f64 = 100.0;
/// Tolerances of the criteria for the largest time step. Roots are known to 96 digits.
pub const CRITERION: RangeInclusive<f64> = 1e-60..=1e60;

/// Checks that `allowed` admits `value`; `what` is its name.
///
/// # Errors
/// The value and the allowed values, in words.
pub fn within(allowed: Allowed, what: &str, value: f64) -> Result<f64, String> {
    if allowed.admits(value) {
        Ok(value)
    } else {
        Err(format!("`{what}` is {value:?}, but it must be {allowed}"))
    }
}

/// Checks a number of steps; `what` is its name.
///
/// # Errors
/// The value and the allowed values, in words.
pub fn steps(what: &str, steps: i128) -> Result<u64, String> {
    match u64::try_from(steps) {
        Ok(allowed) if STEPS.contains(&allowed) => Ok(allowed),
        _ => Err(format!("`{what}` is {steps}, but it must be {}", steps_allowed())),
    }
}

/// Checks a number of steps of a forecast; `what` is its name.
///
/// # Errors
/// The value and the allowed values, in words.
pub fn forecast_steps(what: &str, steps: i128) -> Result<u64, String> {
    match u64::try_from(steps) {
        Ok(allowed) if FORECAST_STEPS.contains(&allowed) => Ok(allowed),
        _ => Err(format!("`{what}` is {steps}, but it must be {}", forecast_steps_allowed())),
    }
}

/// Checks a number of steps of a trajectory; `what` is its name.
///
/// # Errors
/// The value and the allowed values, in words.
pub fn trajectory_steps(what: &str, steps: i128) -> Result<u64, String> {
    match u64::try_from(steps) {
        Ok(allowed) if TRAJECTORY_STEPS.contains(&allowed) => Ok(allowed),
        _ => Err(format!("`{what}` is {steps}, but it must be {}", trajectory_steps_allowed())),
    }
}

/// The allowed numbers of steps of a trajectory, in words.
pub fn trajectory_steps_allowed() -> String {
    format!("{} to {}", TRAJECTORY_STEPS.start(), TRAJECTORY_STEPS.end())
}

/// The allowed numbers of steps of a forecast, in words.
pub fn forecast_steps_allowed() -> String {
    format!("{} to {}", FORECAST_STEPS.start(), FORECAST_STEPS.end())
}

/// The allowed numbers of steps, in words.
pub fn steps_allowed() -> String {
    format!("{} to {}", STEPS.start(), STEPS.end())
}
