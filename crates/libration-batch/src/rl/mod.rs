//! Environments for reinforcement learning, many at once, and the tensors that they yield.
//!
//! An [`Environment`] is a system with its integrator, a [`Task`] that sees, rewards and ends, a [`Start`] and a time
//! limit, and what is not ideal about it: a [`Clock`](libration_core::control::Clock), [`Delays`], a [`Sensor`], a [`Variation`] and a
//! [`Severity`] from episode to episode. [`Environments`] are many of them. A [`Rollout`] holds what they do under a [`Policy`] over a horizon.
//!
//! What environment `i` does follows from its number, the seed, the policy and the steps taken: not from the number of
//! environments or threads, the instruction set, the layout of the rollout or how many steps are taken at a time.

//!
//! All is computed in the float type of the rollout. An `f16` is for looking at what that does to an environment: of increments
//! that are smaller than its spacing nothing is left, and advantages round like all else.

mod batch;
mod block;
mod block_size;
mod brief;
mod checkpoint;
mod delays;
mod deviation;
mod draws;
mod ends;
mod environment;
mod episode_end;
mod error;
mod estimates;
mod history;
mod kernel;
mod lanes;
mod look;
mod plan;
pub mod policy;
mod rollout;
mod row;
mod run;
pub mod sensor;
mod severity;
mod spread;
mod stage;
pub mod start;
mod strip;
pub mod task;
pub mod variation;
mod wrong;
mod yields;

pub use batch::Environments;
pub use delays::Delays;
pub use environment::{Autoreset, Environment, Parts, World};
pub use episode_end::Final;
pub use error::EnvironmentError;
pub use estimates::{Discounts, Estimates};
pub use plan::{Layout, Plan, Writes};
pub use policy::{Act, Place, Policy};
pub use rollout::Rollout;
pub use run::Outcome;
pub use sensor::Sensor;
pub use severity::Severity;
pub use spread::Spread;
pub use start::{Episode, Start};
pub(crate) use strip::first_of;
pub use task::Task;
pub use variation::Variation;
