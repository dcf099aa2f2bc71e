//! Modes of a linear plant as results.

use libration::linear::ModeDetails;
use serde::Serialize;

/// A mode of a plant.
#[derive(Clone, Debug, Serialize)]
pub struct Mode {
    /// The eigenvalue `[re, im]` in 1/s; of a pair the upper one.
    pub eigenvalue: [f64; 2],
    /// The growth rate in 1/s; below zero the mode decays.
    pub growth_rate: f64,
    /// The frequency of its oscillation in Hz; 0 without oscillation.
    pub frequency: f64,
    /// The natural frequency, the size of the eigenvalue, in rad/s.
    pub natural_frequency: f64,
    /// The natural frequency in Hz.
    pub natural_frequency_hz: f64,
    /// The damping ratio, from −1 to 1; none of the eigenvalue 0.
    pub damping_ratio: Option<f64>,
    /// The time in s in which it decays to 1/e; none if it does not decay.
    pub time_constant: Option<f64>,
    /// The states that move most, with their sizes relative to the largest.
    pub states: Vec<(String, f64)>,
    /// Whether inputs reach all motions with this eigenvalue.
    pub controllable: bool,
    /// Whether outputs show all motions with this eigenvalue.
    pub observable: bool,
    /// The relative change of the entries of `A` and `B` up to which inputs reach all motions with this eigenvalue, from 0 to 1.
    pub controllability: f64,
    /// The same of `A` and `C`, and of motions that outputs show.
    pub observability: f64,
    /// Whether inputs reach its motions only as long as the entries of the plant do not change by less than 10⁻⁶.
    pub weakly_controllable: bool,
    /// The same of motions that outputs show.
    pub weakly_observable: bool,
}

impl From<&ModeDetails> for Mode {
    fn from(details: &ModeDetails) -> Self {
        Mode {
            eigenvalue: [details.value.re, details.value.im],
            growth_rate: details.value.re,
            frequency: details.mode.frequency,
            natural_frequency: details.natural_frequency(),
            natural_frequency_hz: details.natural_frequency() / core::f64::consts::TAU,
            damping_ratio: details.damping_ratio(),
            time_constant: details.time_constant(),
            states: details.mode.states.clone(),
            controllable: details.is_controllable(),
            observable: details.is_observable(),
            controllability: details.controllability,
            observability: details.observability,
            weakly_controllable: details.is_weakly_controllable(),
            weakly_observable: details.is_weakly_observable(),
        }
    }
}
