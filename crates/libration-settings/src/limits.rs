//! What the numbers of a configuration may be; the command line's flags obey the same limits.

use std::ops::RangeInclusive;

use libration::catalog::Allowed;

/// Time steps, in s.
pub const TIME_STEP: Allowed = Allowed::Positive;
/// Masses in kg and stiffnesses in N/m.
pub const SPRING: Allowed = Allowed::Positive;
/// Coordinates of a start.
pub const COORDINATE: Allowed = Allowed::Finite;
/// Errors that are tolerated.
pub const TOLERANCE: Allowed = Allowed::Positive;
/// Numbers of steps.
pub const STEPS: RangeInclusive<u64> = 1..=1_000_000_000;

/// Numbers of steps of a trajectory: up to 2⁵³ an `f64` tells each from the next, and time is a step times `dt`.
pub const TRAJECTORY_STEPS: RangeInclusive<u64> = 1..=1 << 53;

/// Numbers of steps over which a linear system is forecast, in closed form.
pub const FORECAST_STEPS: RangeInclusive<u64> = 1..=1_000_000_000_000_000;

/// Sizes of a system's parameters that are not 0, and of times in s, of which `advise` is asked: what is derived from them must
/// stay far within the range of floats.
pub const SIZE: RangeInclusive<f64> = 1e-60..=1e60;
/// The angle, in rad, by which a motion may turn in an exact step that is analysed: of a larger one 1024 bits lose too many digits.
pub const MOST_TURN: f64 = 1e9;

/// The first of `parameters` whose size theory cannot be asked about.
pub fn beyond_theory(
    parameters: impl IntoIterator<Item = (&'static str, f64)>,
) -> Option<(&'static str, f64)> {
    parameters.into_iter().find(|(_, value)| *value != 0.0 && !SIZE.contains(&value.abs()))
}

/// Bytes of the longest file of settings: a hundred times the longest default, for lists of time steps.
pub const SETTINGS_BYTES: u64 = 1 << 20;

/// Gains and weights of a loop: their products must stay far within the range of floats.
pub const MOST_GAIN: f64 = 1e50;
/// Relative rms of step times and clock rates: nobody's clock is worse.
pub const MOST_RMS: f64 = 100.0;
/// What a criterion for the largest time step tolerates. Roots are known to 96 digits, which is why it ends somewhere.
pub const CRITERION: RangeInclusive<f64> = 1e-60..=1e60;

/// `value`, if `allowed` admits it as `what`.
///
/// # Errors
/// A sentence that names the value and what is allowed.
pub fn within(allowed: Allowed, what: &str, value: f64) -> Result<f64, String> {
    if allowed.admits(value) {
        Ok(value)
    } else {
        Err(format!("`{what}` is {value:?}, but it must be {allowed}"))
    }
}

/// `steps`, if it is an allowed number of steps for `what`.
///
/// # Errors
/// A sentence that names the value and what is allowed.
pub fn steps(what: &str, steps: i128) -> Result<u64, String> {
    match u64::try_from(steps) {
        Ok(allowed) if STEPS.contains(&allowed) => Ok(allowed),
        _ => Err(format!("`{what}` is {steps}, but it must be {}", steps_allowed())),
    }
}

/// `steps`, if a linear system can be forecast over as many for `what`.
///
/// # Errors
/// A sentence that names the value and what is allowed.
pub fn forecast_steps(what: &str, steps: i128) -> Result<u64, String> {
    match u64::try_from(steps) {
        Ok(allowed) if FORECAST_STEPS.contains(&allowed) => Ok(allowed),
        _ => Err(format!("`{what}` is {steps}, but it must be {}", forecast_steps_allowed())),
    }
}

/// `steps`, if it is an allowed number of steps of a trajectory for `what`.
///
/// # Errors
/// A sentence that names the value and what is allowed.
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
    format!("{} to {}, which takes minutes already", STEPS.start(), STEPS.end())
}
