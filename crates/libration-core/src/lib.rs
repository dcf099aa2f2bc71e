//! Numbers, integrators, systems, and the parts of control loops.
//!
//! An integrator is a pure function of a number type. The step `(q, v) ↦ (q', v')` is written once; on floats it simulates, on
//! dual numbers it differentiates itself, on polynomials it yields its own update matrix.
//!
//! This crate does no input or output, reads no clock and prints nothing.

pub mod array;
pub mod catalog;
pub mod control;
pub mod elementary;
pub mod elimination;
mod implicit_method;
pub mod integrator;
mod method;
pub mod number;
pub mod random;
mod scalar;
pub mod simulation;
mod state;
pub mod system;
pub mod thermostat;

pub use catalog::{AnySystem, CatalogError};
pub use implicit_method::{AnyMethod, ImplicitMethod};
pub use integrator::Integrator;
pub use method::Method;
pub use scalar::{Elementary, Float, Scalar};
pub use state::State;
pub use system::{Hamiltonian, Model, System};
