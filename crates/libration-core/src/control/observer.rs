//! An observer of the state.

/// A Luenberger observer: the step of its model and its correction gains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StateObserver {
    /// The matrix of a step on position and velocity, row by row.
    pub phi: [[f64; 2]; 2],
    /// The effect of a unit command.
    pub gamma: [f64; 2],
    /// The correction of position and velocity per metre of position error; that of the velocity is in 1/s.
    pub correction: [f64; 2],
}
