//! Libration: integrators, systems and number types for the stability of simulations.
//!
//! The one idea: *an integrator is a pure function of a number type*. The step `(q, v) ↦ (q', v')`
//! is written once; on floats it simulates, on dual numbers it differentiates itself, on
//! polynomials it yields its own update matrix.
//!
//! This crate does no input or output, reads no clock and prints nothing.

pub mod analysis;
mod array;
pub mod catalog;
pub mod checkpoint;
pub mod control;
pub mod elementary;
pub mod ensemble;
pub mod integrator;
mod method;
pub mod number;
pub mod random;
pub mod replay;
pub mod rl;
mod scalar;
pub mod simulation;
mod state;
pub mod system;

pub use catalog::{AnySystem, CatalogError};
pub use ensemble::Ensemble;
pub use integrator::Integrator;
pub use method::Method;
pub use scalar::{Elementary, Float, Scalar};
pub use state::State;
pub use system::{Hamiltonian, Model, System};
