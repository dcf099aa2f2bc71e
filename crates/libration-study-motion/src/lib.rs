//! Studies of free motion: stability, drift, errors, orders and rounding.

mod adaptive;
mod convergence;
mod coverage;
mod drift;
mod efficiency;
mod error;
mod growth;
mod method_color;
mod nonlinear;
mod precision;
mod program_stepper;
mod rounding;
mod spectrum;
mod stability;
mod stable_step;
mod subject;

pub use adaptive::{Adaptive, AdaptiveSettings};
pub use convergence::{Convergence, ConvergenceSettings};
pub use drift::{Drift, DriftSettings};
pub use efficiency::{Efficiency, EfficiencySettings};
pub use error::{Error, ErrorSettings};
pub use nonlinear::{Nonlinear, NonlinearSettings};
pub use precision::{Precision, PrecisionSettings, SystemPrecision};
pub use spectrum::{Spectrum, SpectrumSettings};
pub use stability::{Stability, StabilitySettings, SystemStability};
pub use subject::{
    Change, Changes, Errors, Halvings, Horizon, Kind, Law, Orbits, Portrait, Problem, SYSTEMS,
    StabilityLimit, StudiedState, Symmetry,
};
