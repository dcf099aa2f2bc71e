//! The loop that a request describes, for simulations.

use libration::linear::{LinearLoop, LinearLoopError, LoopTiming};
use libration_analyze::linear_analysis::SystemLoop;
use libration_settings::linear_loop::OperatingPoint;

use super::LinearRequest;

impl LinearRequest {
    /// The loop, with the lags and filters of its channels.
    pub fn linear_loop(&self) -> &LinearLoop {
        &self.timed.linear
    }

    /// The operating point at which the plant is a linearisation, if it is one.
    pub fn operating_point(&self) -> Option<&OperatingPoint> {
        self.operating_point.as_ref()
    }

    /// The stated timing.
    ///
    /// # Errors
    /// [`LinearLoopError`]: a latency that is too large.
    pub fn loop_timing(&self) -> Result<LoopTiming, LinearLoopError> {
        self.timed.stated()
    }

    /// Whether the request states missed deadlines or overruns.
    pub fn misses_deadlines(&self) -> bool {
        self.deadlines.misses.is_some() || self.deadlines.probability > 0.0
    }

    /// The lengths of recorded periods, as multiples of their mean; none without time stamps.
    pub fn recorded_periods(&self) -> Option<&[f64]> {
        self.timed.timing.record.as_deref()
    }

    /// The system by equations under the loop; none of other plants.
    pub(super) fn system_loop(&self) -> Option<SystemLoop> {
        Some(SystemLoop {
            system: self.system.clone()?,
            point: self.operating_point.clone()?,
            has_stated_point: self.has_stated_point,
            record: self.recorded_periods().map(<[f64]>::to_vec),
            rate: self.timed.rate(),
        })
    }
}
