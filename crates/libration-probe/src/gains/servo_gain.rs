//! A servo of a simulator.

use serde::Deserialize;

/// A servo of a simulator whose gains can be changed.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ServoGain {
    /// Its name.
    pub name: String,
    /// Its gain of position.
    pub kp: f64,
    /// Its gain of velocity.
    pub kv: f64,
    /// The inertia that it moves with all others free; 0 of a servo that moves nothing at the point.
    pub inertia: f64,
    /// The joint on which it acts; none if there are several.
    pub joint: Option<String>,
}
