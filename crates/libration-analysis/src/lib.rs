//! What an integrator does to a system, derived from the shipped step itself.
//!
//! Nothing here is typed in from a textbook: the step is run on numbers that carry a derivative,
//! on polynomials in the time step, or with 1024 bits, and the answer is read off.

mod band;
mod complex;
mod data_flow;
mod eigenvalues;
mod energy;
mod error;
mod exponential;
mod form;
mod largest_step;
mod linearisation;
mod matrix;
mod orbit_start;
mod order;
mod precision;
mod roots;
mod slip;
mod spectrum;
mod symbolic;
mod tableau;
mod timing;
mod traced;
mod window;

pub use band::EnergyBand;
pub use complex::Complex;
pub use data_flow::{DataFlow, Operation};
pub use eigenvalues::{determinant, eigenvalues};
pub use energy::{DriftForecast, forecast_drift};
pub use error::ErrorForecast;
pub use form::QuadraticForm;
pub use largest_step::{Criterion, LargestStep};
pub use linearisation::Linearisation;
pub use matrix::UpdateMatrix;
pub use orbit_start::OrbitStart;
pub use order::OrderCertificate;
pub use precision::{Cycle, LocalRounding, float_clock};
pub use slip::Slip;
pub use spectrum::{Eigenvalues, Spectrum};
pub use symbolic::{SymbolicStep, UnknownStep};
pub use tableau::{Letter, Tableau};
pub use timing::{
    CostError, HeldStep, HiddenLatency, Imperfections, JitterMargin, LinearController, LqrError,
    MeanSquare, Mode, NotLinear, ObserverNoise, Plant, Regulator, Resonance, StepNoise, Switching,
    SwitchingError, Windows,
};
pub use window::StabilityWindow;
