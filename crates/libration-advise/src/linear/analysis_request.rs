//! Requests for analyses of the plant or the loop of a request file.

use libration::linear::LinearLoopError;
use libration_analyze::{Stepping, linear_analysis};
use libration_settings::linear_loop::{LinearControllerTable, LinearLoopTable};

use super::{LinearRequest, RequestFile};

/// What a request file for an analysis states before it is completed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct AnalysisFile {
    /// Whether there is a controller.
    pub has_controller: bool,
    /// The keys of the loop that an analysis does not use.
    unused: Vec<&'static str>,
}

impl AnalysisFile {
    /// Completes a file without a controller: commands are zero.
    pub fn complete(file: &mut RequestFile) -> Self {
        let LinearLoopTable { deadline_misses, overrun_probability, time_stamps, .. } =
            &file.looped;
        let keys = [
            (!deadline_misses.is_empty(), "`deadline-misses`"),
            (overrun_probability.0 != 0.0, "`overrun-probability`"),
            (!time_stamps.is_empty(), "the order of `time-stamps`"),
        ];
        let unused = keys.into_iter().filter_map(|(given, key)| given.then_some(key)).collect();
        let has_controller = file.controller.is_some();
        if !has_controller && let Ok(plant) = file.system.linear.plant() {
            file.controller = Some(LinearControllerTable::open_loop(&plant));
        }
        AnalysisFile { has_controller, unused }
    }

    /// The request for an analysis of the completed file.
    ///
    /// # Errors
    /// [`LinearLoopError`]: a latency that is too large.
    pub fn request(
        &self,
        request: &LinearRequest,
        dt: Option<f64>,
        integrator: Option<Stepping>,
    ) -> Result<linear_analysis::LinearRequest, LinearLoopError> {
        let is_partial = self.has_controller && !self.unused.is_empty();
        let note = is_partial.then(|| {
            let keys = self.unused.join(", ");
            format!("this analysis does not use {keys} of [loop]; help: `libration advise` does")
        });
        Ok(linear_analysis::LinearRequest {
            linear: request.linear_loop().clone(),
            timing: self.has_controller.then(|| request.loop_timing()).transpose()?,
            dt,
            integrator,
            operating_point: request.operating_point().cloned(),
            is_linearised: request.is_linearised,
            system: request.system_loop(),
            note,
        })
    }
}
