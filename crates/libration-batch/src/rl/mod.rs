//! Batches of environments for reinforcement learning, and their rollouts.
//!
//! An [`Environment`] is a system with its integrator, a [`Task`], a [`Start`], a time limit and imperfections: a
//! [`Clock`](libration_core::control::Clock), [`Delays`], a [`Sensor`], a [`Variation`] and an [`ErrorScale`].
//! [`Environments`] is a batch of them. A [`Rollout`] holds their transitions under a [`Policy`] over a horizon.
//!
//! The transitions of environment `i` depend on its number, the seed, the policy and the steps taken. They do not depend on the
//! number of environments or threads, the instruction set, the layout of the rollout or the number of steps per call.
//!
//! All numbers have the float type of the rollout. An `f16` shows the effect of that type on an environment: increments below its
//! spacing are lost, and advantages are rounded as well.

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
#[cfg(not(test))]
mod episode_number;
mod episode_reset;
mod episode_streams;
mod error;
mod error_scale;
mod estimates;
mod fused_step;
mod history;
mod horizon;
mod lanes;
mod observation;
mod plan;
pub mod policy;
// As the machine that runs them.
#[cfg(not(test))]
mod program;
mod rollout;
mod rollout_row;
mod rollout_run;
mod rollout_slice;
mod rollout_tensors;
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
#[cfg(not(test))]
pub use episode_number::EpisodeNumber;
pub use error::EnvironmentError;
pub use error_scale::ErrorScale;
pub use estimates::{Discounts, Estimates};
pub use plan::{Layout, Plan, TransitionWork, Writes};
pub use policy::{ActionSample, Policy, StepIndex};
#[cfg(not(test))]
pub use program::{
    AnswerTimes, EpisodeEnds, ProgramEnvironment, ProgramEnvironments, ProgramPolicy,
    ProgramRollout,
};
pub use rollout::Rollout;
pub use rollout_run::StepBuffers;
pub use rollout_tensors::RolloutTensors;
pub use sensor::Sensor;
pub use start::{Episode, Start};
pub use task::Task;
pub use variation::Variation;
