//! What an integrator does to a system, derived from the shipped step itself.
//!
//! Nothing here is typed in from a textbook: the step is run on numbers that carry a derivative,
//! on polynomials in the time step, or with 1024 bits, and the answer is read off.

mod band;
mod eigenvalues;
mod energy;
mod linearisation;
mod matrix;
mod spectrum;
mod symbolic;

pub use band::EnergyBand;
pub use eigenvalues::{Complex, determinant, eigenvalues};
pub use energy::{DriftForecast, forecast_drift};
pub use linearisation::Linearisation;
pub use matrix::UpdateMatrix;
pub use spectrum::{Eigenvalues, Spectrum};
pub use symbolic::{SymbolicStep, UnknownStep};
