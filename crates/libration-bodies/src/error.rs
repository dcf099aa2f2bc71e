//! Why bodies cannot be simulated.

use std::error::Error;
use std::fmt;

use libration_equations::EquationError;

/// Why bodies cannot be simulated. Bodies are counted from 0.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum BodiesError {
    /// Too few bodies, or too many.
    Count {
        /// The number given.
        count: usize,
        /// The smallest number.
        least: usize,
        /// The largest number.
        most: usize,
    },
    /// A coordinate that is no number.
    NotFinite {
        /// The body.
        body: usize,
        /// `x` to `vz`.
        field: &'static str,
        /// The value.
        value: f64,
    },
    /// A mass or radius that is not allowed.
    Negative {
        /// The body.
        body: usize,
        /// `mass` or `radius`.
        field: &'static str,
        /// The value.
        value: f64,
    },
    /// A body without mass where forces do not follow from masses.
    Massless {
        /// The body.
        body: usize,
    },
    /// A constant of gravitation that is not allowed.
    Constant {
        /// The value.
        value: f64,
    },
    /// A pair potential that is no expression.
    PairPotential(EquationError),
    /// A softening length that is not allowed.
    Softening {
        /// The value.
        length: f64,
    },
    /// A charge without a pair potential.
    Charge {
        /// The body.
        body: usize,
        /// The charge.
        value: f64,
    },
    /// An energy that is no number.
    Energy {
        /// The time.
        time: f64,
    },
    /// A softening length without the gravity that it softens.
    NothingToSoften,
    /// A time step that is not allowed.
    TimeStep {
        /// The value.
        dt: f64,
    },
    /// Two bodies at the same place.
    SamePlace {
        /// The bodies.
        pair: [usize; 2],
        /// The time.
        time: f64,
    },
    /// Two bodies nearer than the sum of their radii.
    Collision {
        /// The bodies.
        pair: [usize; 2],
        /// The time.
        time: f64,
        /// The distance of their centres.
        distance: f64,
        /// The sum of their radii.
        radii: f64,
    },
    /// Numbers outgrew the floats.
    Overflow {
        /// The bodies that were nearest before, if there are several.
        pair: Option<[usize; 2]>,
        /// Whether softening would help: without a pair potential.
        softens: bool,
        /// The time before the step.
        time: f64,
    },
    /// A splitting around a central body that does not apply.
    CentralBody {
        /// The reason.
        reason: &'static str,
    },
    /// Adaptive steps that do not apply.
    Adaptive {
        /// The reason.
        reason: &'static str,
    },
    /// A density of steps that is not positive.
    Density {
        /// The time.
        time: f64,
    },
    /// The caller stopped the simulation.
    Stopped,
}

impl BodiesError {
    /// The error in words, with names of the bodies.
    pub fn with_names(&self, name: impl Fn(usize) -> String) -> String {
        let both = |[a, b]: [usize; 2]| format!("{} and {}", name(a), name(b));
        match self {
            BodiesError::Count { count, least, most } => {
                let bodies = if *count == 1 { "body" } else { "bodies" };
                format!("{count} {bodies}; expected {least} to {most}")
            }
            BodiesError::NotFinite { body, field, value } => {
                format!("{}: {field} = {value:?}; expected a finite number", name(*body))
            }
            BodiesError::Negative { body, field, value } => {
                let body = name(*body);
                format!("{body}: {field} = {value:?}; expected a finite number of at least 0")
            }
            BodiesError::Massless { body } => {
                format!("{}: mass = 0; expected a mass above 0 with a pair potential", name(*body))
            }
            BodiesError::Constant { value } => format!(
                "gravitational constant {value:?}; expected a number of at least 0 whose products with all masses are finite"
            ),
            BodiesError::PairPotential(error) => format!("{}: {error}", error.key),
            BodiesError::Softening { length } => {
                format!("softening {length:?}; expected a length from 0 to 1e154")
            }
            BodiesError::Charge { body, value } => {
                format!("{}: charge = {value:?} has no effect; expected a pair potential, or 0", name(*body))
            }
            BodiesError::Energy { time } => format!(
                "the energy is not finite at t = {time:?}; help: the potential must be finite at all distances that occur"
            ),
            BodiesError::NothingToSoften => "softening without gravity, which alone is softened; expected softening 0 or a gravitational constant above 0".to_owned(),
            BodiesError::TimeStep { dt } => {
                format!("dt {dt:?}; expected a finite number other than 0")
            }
            BodiesError::SamePlace { pair, time } => format!(
                "{} are at the same place at t = {time:?}; help: softening makes their force finite",
                both(*pair)
            ),
            BodiesError::Collision { pair, time, distance, radii } => {
                let bodies = both(*pair);
                format!("{bodies} collide at t = {time:?}: distance {distance:?}, sum of radii {radii:?}")
            }
            BodiesError::Overflow { pair, softens, time } => {
                let help = if *softens {
                    "a shorter time step or softening"
                } else {
                    "a shorter time step, or a potential with a derivative at all distances that occur"
                };
                let nearest =
                    pair.map_or_else(String::new, |pair| format!("; {} were nearest", both(pair)));
                format!(
                    "the motion is not finite after t = {time:?}{nearest}; help: {help}"
                )
            }
            BodiesError::CentralBody { reason } => format!("wisdom-holman: {reason}"),
            BodiesError::Adaptive { reason } => format!("adaptive {reason}"),
            BodiesError::Density { time } => format!(
                "the density of steps is not positive after t = {time:?}; help: a shorter first step"
            ),
            BodiesError::Stopped => "interrupted".to_owned(),
        }
    }
}

impl fmt::Display for BodiesError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.with_names(|body| format!("body {body}")))
    }
}

impl Error for BodiesError {}

impl From<EquationError> for BodiesError {
    fn from(error: EquationError) -> Self {
        BodiesError::PairPotential(error)
    }
}
