//! Designed controllers of linear plants.

use libration::linear::{
    ClockedController, ControllerSchedule, CostWeights, LinearPlant, Matrix, Signal,
};

/// A controller and what its design knows.
#[derive(Clone, Debug)]
pub struct Design {
    /// The plant with the outputs that the controller measures.
    pub plant: LinearPlant,
    /// The controller, or the schedule of a cascade.
    pub controllers: ControllerSchedule,
    /// The controller with a measured clock; none if it uses no time, and of a cascade.
    pub clocked: Option<ClockedController>,
    /// The rates and references of a cascade.
    pub cascade: Option<Cascaded>,
    /// The weights of the design.
    pub weights: Option<CostWeights>,
    /// The gain of the state or its estimate.
    pub gain: Option<Matrix>,
    /// The gain of the estimator.
    pub filter: Option<Matrix>,
    /// The variances of the measurements.
    pub measurement: Vec<f64>,
    /// The controller in words.
    pub description: String,
}

/// The rates and the references of a cascade.
#[derive(Clone, Debug, PartialEq)]
pub struct Cascaded {
    /// Names and units of the references.
    pub references: Vec<Signal>,
    /// The periods between two runs of the inner controller.
    pub inner_every: usize,
    /// The periods between two runs of the outer controller.
    pub outer_every: usize,
    /// The periods until references act.
    pub outer_latency: usize,
}

/// The design of a controller that measures the outputs of `plant`.
pub(super) fn by_outputs(
    plant: &LinearPlant,
    controllers: ControllerSchedule,
    description: String,
) -> Design {
    Design {
        plant: plant.clone(),
        controllers,
        clocked: None,
        cascade: None,
        weights: None,
        gain: None,
        filter: None,
        measurement: vec![0.0; plant.outputs.len()],
        description,
    }
}
