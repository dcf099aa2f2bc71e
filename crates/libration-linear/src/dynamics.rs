//! The motion of a plant within a period.

use crate::{Discretisation, Matrix};

/// A step of so many seconds, from one phase to another, each from 0 to 1.
pub type SplitStep<'a> = &'a dyn Fn(f64, [f64; 2]) -> Discretisation;

/// The motion of a plant under held commands.
#[derive(Clone, Copy)]
pub enum Dynamics<'a> {
    /// Exact steps of `ẋ = Ax + Bu` with white noise. The cost is an integral over continuous time.
    Exact {
        /// States × states.
        a: &'a Matrix,
        /// States × inputs.
        b: &'a Matrix,
        /// The intensity of the noise, states × states.
        noise: &'a Matrix,
    },
    /// Steps of any kind. The state at the beginning of a period counts for all of it, as in a simulation.
    Stepped {
        /// The step. The last columns of its `Γ` are the effect of noise that is held through a period.
        step: SplitStep<'a>,
        /// The number of noises.
        noises: usize,
        /// Whether it is white noise of unit intensity, of variance `1/h` in a period of `h` seconds; else it has unit variance.
        white: bool,
    },
}
