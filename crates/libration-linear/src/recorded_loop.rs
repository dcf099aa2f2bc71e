//! Loops around linear plants whose periods repeat a record.

use crate::loop_layout::MOST_RANDOM;
use crate::{LinearLoop, LinearLoopError, LoopTiming, RecordedSchedule};

/// Most states of a loop that replays a record with losses.
const MOST_RECORDED: usize = 24;

impl LinearLoop {
    /// The mean growth rate of second moments per period where the lengths of periods, relative to their mean, repeat `record`. The
    /// jitter of the timing is ignored.
    ///
    /// # Errors
    /// As for [`LinearLoop::growth`], and [`LinearLoopError::Record`].
    pub fn recorded_growth(
        &self,
        timing: &LoopTiming,
        record: &[f64],
    ) -> Result<f64, LinearLoopError> {
        Ok(self.recorded(timing, record, false)?.growth())
    }

    /// The stationary cost of that loop; infinite where second moments grow.
    ///
    /// # Errors
    /// As for [`LinearLoop::recorded_growth`].
    pub fn recorded_cost(
        &self,
        timing: &LoopTiming,
        record: &[f64],
    ) -> Result<f64, LinearLoopError> {
        Ok(self.recorded(timing, record, true)?.cost())
    }

    fn recorded(
        &self,
        timing: &LoopTiming,
        record: &[f64],
        with_cost: bool,
    ) -> Result<RecordedSchedule, LinearLoopError> {
        let wrong = record.iter().find(|length| !(**length >= 0.0 && length.is_finite()));
        let none = if record.iter().any(|length| *length > 0.0) { None } else { Some(&0.0) };
        if let Some(&length) = wrong.or(none) {
            return Err(LinearLoopError::Record(length));
        }
        let even = LoopTiming { jitter: timing.jitter.with_rms(0.0), ..timing.clone() };
        let size = self.size(&even)?;
        let most = if timing.loss > 0.0 { MOST_RECORDED } else { MOST_RANDOM };
        if size > most {
            return Err(LinearLoopError::Size { size, most });
        }
        let controllers = self.controllers();
        // Checked once, for all lengths.
        self.stages_of(0, &even, (&[(1.0, 0.0)], true), with_cost)?;
        let draws = timing.loss > 0.0;
        let stages = |length: f64, kind: usize| {
            let nodes = [(1.0, length - 1.0)];
            self.stages_of(kind, &even, (&nodes, true), with_cost).unwrap_or_default()
        };
        Ok(RecordedSchedule::with_controllers(record, controllers.order(), draws, stages))
    }
}
