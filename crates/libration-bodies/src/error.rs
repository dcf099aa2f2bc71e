//! Why bodies cannot be simulated.

use thiserror::Error;

/// Why bodies cannot be simulated. Bodies are counted from 0.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum BodiesError {
    /// No bodies, or too many.
    #[error("{count} bodies; expected 1 to {most}")]
    Count {
        /// The number given.
        count: usize,
        /// The largest number.
        most: usize,
    },
    /// A coordinate that is no number.
    #[error("body {body}: {field} = {value}; expected a finite number")]
    NotFinite {
        /// The body.
        body: usize,
        /// `x` to `vz`.
        field: &'static str,
        /// The value.
        value: f64,
    },
    /// A mass or radius that is not allowed.
    #[error("body {body}: {field} = {value}; expected a finite number of at least 0")]
    Negative {
        /// The body.
        body: usize,
        /// `mass` or `radius`.
        field: &'static str,
        /// The value.
        value: f64,
    },
    /// A constant of gravitation that is not allowed.
    #[error(
        "gravitational constant {value}; expected a positive number whose products with all masses are finite"
    )]
    Constant {
        /// The value.
        value: f64,
    },
    /// A softening length that is not allowed.
    #[error("softening {length}; expected a length of at least 0")]
    Softening {
        /// The value.
        length: f64,
    },
    /// A time step that is not allowed.
    #[error("dt {dt}; expected a finite number other than 0")]
    TimeStep {
        /// The value.
        dt: f64,
    },
    /// Two bodies at the same place.
    #[error(
        "bodies {} and {} are at the same place at t = {time}; help: softening makes their force finite",
        pair[0], pair[1]
    )]
    SamePlace {
        /// The bodies.
        pair: [usize; 2],
        /// The time.
        time: f64,
    },
    /// Two bodies nearer than the sum of their radii.
    #[error("bodies {} and {} collide at t = {time}: distance {distance}", pair[0], pair[1])]
    Collision {
        /// The bodies.
        pair: [usize; 2],
        /// The time.
        time: f64,
        /// The distance of their centres.
        distance: f64,
    },
    /// Numbers outgrew the floats.
    #[error(
        "the motion is not finite after t = {time}; bodies {} and {} were nearest; help: a shorter time step or softening",
        pair[0], pair[1]
    )]
    Overflow {
        /// The bodies that were nearest before.
        pair: [usize; 2],
        /// The time before the step.
        time: f64,
    },
    /// A splitting around a central body that does not apply.
    #[error("wisdom-holman: {reason}")]
    CentralBody {
        /// The reason.
        reason: &'static str,
    },
}
