//! Many bodies under their gravity and other forces between pairs.
//!
//! Forces are direct sums over all pairs, in vectors and on all cores, with the same bits on every machine. Each integrator of
//! `libration-core` moves them; the splitting of Wisdom and Holman is for orbits around one heavy body.

mod audit;
mod bodies;
mod body_integrator;
mod body_vectors;
mod closest_pair;
mod conserved;
mod democratic_heliocentric;
mod direct_sum;
mod error;
mod forces;
mod initial_conditions;
mod kepler_flow;
mod meetings;
mod pair_potential;
mod rounding;
mod simulation;
mod step_density;
mod step_plan;

pub use bodies::{Bodies, Body, MOST_BODIES};
pub use body_integrator::{BodyIntegrator, OrbitsAndKicks};
pub use conserved::Conserved;
pub use error::BodiesError;
pub use initial_conditions::{InitialConditions, KOZAI_TILT};
pub use kepler_flow::kepler_flow;
pub use pair_potential::PairPotential;
pub use rounding::RoundingVariance;
pub use simulation::BodySimulation;
