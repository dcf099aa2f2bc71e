//! Environments for reinforcement learning, many at once, and the tensors that they yield.
//!
//! An [`Environment`] is a system with its integrator, a [`Task`] that sees, rewards and ends, a [`Start`] and a time
//! limit, and what is not ideal about it: a [`Clock`](libration_core::control::Clock), [`Delays`], a [`Sensor`], a [`Variation`] and a
//! [`ErrorScale`] from episode to episode. [`Environments`] are many of them. A [`Rollout`] holds what they do under a [`Policy`] over a horizon.
//!
//! What environment `i` does follows from its number, the seed, the policy and the steps taken: not from the number of
//! environments or threads, the instruction set, the layout of the rollout or how many steps are taken at a time.

//!
//! All is computed in the float type of the rollout. An `f16` is for looking at what that does to an environment: of increments
//! that are smaller than its spacing nothing is left, and advantages round like all else.

mod actuation;
mod batch;
mod block;
mod block_output;
mod block_size;
mod checkpoint;
mod delays;
mod deviation;
mod distribution;
mod environment;
mod episode_end;
mod episode_reset;
mod episode_streams;
mod error;
mod error_scale;
mod estimates;
mod fused_step;
mod history;
mod kernel;
mod lanes;
mod observation;
mod plan;
pub mod policy;
mod rollout;
mod rollout_row;
mod rollout_run;
mod rollout_slice;
pub mod sensor;
pub mod start;
mod step_length;
mod stepper;
pub mod task;
pub mod variation;

pub use batch::Environments;
pub use delays::Delays;
pub use distribution::Distribution;
pub use environment::{Autoreset, Environment, Parts, World};
pub use episode_end::EpisodeEnd;
pub use error::EnvironmentError;
pub use error_scale::ErrorScale;
pub use estimates::{Discounts, Estimates};
pub use plan::{Layout, Plan, Writes};
pub use policy::{ActionSample, Policy, StepIndex};
pub use rollout::Rollout;
pub use rollout_run::StepBuffers;
pub(crate) use rollout_slice::first_of;
pub use sensor::Sensor;
pub use start::{Episode, Start};
pub use task::Task;
pub use variation::Variation;
