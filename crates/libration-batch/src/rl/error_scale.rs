//! Error scales of the clock and of the sensor.

use libration_core::Float;
use libration_core::control::ControlError;
use libration_core::control::error::ensure_not_negative;
use libration_core::random::Purpose;

use super::start::{Episode, uniform};

/// Factors of the errors of the clock and of the sensor, drawn uniformly for every environment at the beginning of every episode.
/// 1 leaves the errors unchanged, 0 removes them.
///
/// Negative steps become steps of length zero, as with clocks. An exact clock or sensor has no errors to scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorScale {
    /// The range of the factor of clock errors.
    pub clock: [f64; 2],
    /// The range of the factor of sensor noise.
    pub sensor: [f64; 2],
}

impl Default for ErrorScale {
    /// Factors of 1.
    fn default() -> Self {
        ErrorScale { clock: [1.0; 2], sensor: [1.0; 2] }
    }
}

impl ErrorScale {
    /// Whether factors differ between episodes.
    pub(super) fn varies(&self) -> bool {
        [self.clock, self.sensor].iter().any(|[least, most]| least != most)
    }

    pub(super) fn check<T: Float>(&self) -> Result<(), ControlError> {
        for (name, [least, most]) in
            [("error scale of the clock", self.clock), ("error scale of the sensor", self.sensor)]
        {
            ensure_not_negative::<T>(name, least)?;
            ensure_not_negative::<T>(name, most)?;
        }
        let ends = [self.clock, self.sensor].map(|[least, most]| (least, most));
        uniform::check("range of the error scale", ends)
    }

    /// The factors of the clock and of the sensor in an episode.
    pub(super) fn draw(&self, episode: Episode) -> [f64; 2] {
        if !self.varies() {
            return [self.clock[0], self.sensor[0]];
        }
        // The first two numbers are latencies.
        let shares = uniform::shares::<2>(episode, Purpose::Delay, 2);
        let drawn = |[least, most]: [f64; 2], share| uniform::at((least, most), share);
        [drawn(self.clock, shares[0]), drawn(self.sensor, shares[1])]
    }
}
