//! The equilibrium near the start of a system, and the system about it.

use std::sync::atomic::AtomicBool;

use libration_settings::linear_loop::{OperatingPoint, linearised_equations};
use serde::Serialize;

use crate::linear_analysis::{self, LinearAnalysis, LinearAnalysisError, LinearRequest};
use crate::step::{AnalyzeError, Request};

/// The equilibrium near the start of a system, and the system about it.
#[derive(Clone, Debug, Serialize)]
pub struct AboutEquilibrium {
    /// The equilibrium; none if none was found.
    pub operating_point: Option<OperatingPoint>,
    /// The system about it.
    pub linear: Option<LinearAnalysis>,
    /// The reason why there are no modes, if there are none.
    pub no_modes: Option<String>,
}

impl AboutEquilibrium {
    /// The search begins at the start of the request.
    ///
    /// # Errors
    /// [`AnalyzeError::Interrupted`].
    pub(super) fn new(request: &Request, stop: &AtomicBool) -> Result<Self, AnalyzeError> {
        let (plant, point) = match linearised_equations(&request.system) {
            Ok(found) => found,
            Err(fault) => {
                let no_modes = Some(fault.message);
                return Ok(AboutEquilibrium { operating_point: None, linear: None, no_modes });
            }
        };
        let open_loop = LinearRequest::open_loop(plant, request.dt, Some(request.stepping));
        let open_loop =
            open_loop.map(|own| LinearRequest { operating_point: Some(point.clone()), ..own });
        let analysis = open_loop.and_then(|request| {
            linear_analysis::analyze(&request, stop).or_else(|error| match error {
                // With states of first order the theory of an integrator applies only if it treats all states alike.
                LinearAnalysisError::Integrator { .. } => {
                    let all = LinearRequest { integrator: None, ..request };
                    linear_analysis::analyze(&all, stop)
                }
                error => Err(error),
            })
        });
        let (linear, no_modes) = match analysis {
            Ok(linear) => (Some(LinearAnalysis { operating_point: None, ..linear }), None),
            Err(LinearAnalysisError::Interrupted) => return Err(AnalyzeError::Interrupted),
            Err(error) => (None, Some(error.to_string())),
        };
        Ok(AboutEquilibrium { operating_point: Some(point), linear, no_modes })
    }
}
