//! Libration: integrators, systems and number types for the stability of simulations.
//!
//! The one idea: *an integrator is a pure function of a number type*. The step `(q, v) ↦ (q', v')`
//! is written once; on floats it simulates, on dual numbers it differentiates itself, on
//! polynomials it yields its own update matrix.
//!
//! This crate is the front of the engine: [`libration_core`] has numbers, integrators, systems and the parts of control loops,
//! [`libration_linear`] loops as matrices, [`libration_equations`] systems from text, [`libration_analysis`] what is derived from a
//! step, [`libration_batch`] what runs many trajectories at once, [`libration_linear_loops`] many loops, [`libration_bodies`] many
//! bodies, and [`libration_replay`] transitions for a learner. None of them does input or output, but for replay buffers in files; none reads a clock or
//! prints.

pub use libration_analysis as analysis;
pub use libration_batch::{Ensemble, Trajectory, TrajectoryProgram, checkpoint, ensemble, rl};
pub use libration_bodies as bodies;
pub use libration_core::{
    AnyMethod, AnySystem, CatalogError, Elementary, Float, Hamiltonian, ImplicitMethod, Integrator,
    Method, Model, Scalar, State, System, catalog, control, elementary, elimination, integrator,
    number, random, simulation, system, thermostat, with_method, with_system,
};
pub use libration_equations as equations;
pub use libration_linear as linear;
pub use libration_linear_loops as linear_loops;
pub use libration_live as live;
pub use libration_replay as replay;
