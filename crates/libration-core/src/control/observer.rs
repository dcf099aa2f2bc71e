//! An observer of the state.

/// What a Luenberger observer is made of: the model's own step, and how the position that is seen corrects what was foretold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StateObserver {
    /// What a step makes of position and velocity, row by row.
    pub phi: [[f64; 2]; 2],
    /// What it adds for each unit of the command.
    pub gamma: [f64; 2],
    /// What is added to position and velocity for each metre that the position is off; the velocity's is in 1/s.
    pub correction: [f64; 2],
}
