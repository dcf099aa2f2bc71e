//! A mode that a simulation measures.

use libration::Float;
use libration::analysis::{StepMode, StepOn};
use serde::Serialize;

/// The growth and the angle per step of a simulation that starts with the shape of a mode.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct SimulatedMode {
    /// Number of steps.
    pub steps: u32,
    /// The factor by which the mode grows in a step: the geometric mean.
    pub growth: f64,
    /// The angle in rad by which it turns in a step: the mean.
    pub angle: f64,
}

impl SimulatedMode {
    /// Simulates `mode` with `step`; none if the states do not stay finite.
    pub(super) fn new<S: Float>(
        mode: &StepMode,
        step: &StepOn<'_, S>,
        radius: f64,
        states: usize,
    ) -> Option<Self> {
        // Each step costs the square of the number of states.
        let most = (400_000 / states.pow(2)).clamp(50, 1000) as u32;
        let (mean, steps) = mode.simulated(step, radius, most)?;
        Some(SimulatedMode { steps, growth: mean.norm(), angle: mean.arg() })
    }
}
