//! Environments for reinforcement learning, many at once, and the tensors that they yield.
//!
//! An [`Environment`] is a system with its integrator, a [`Task`] that sees, rewards and ends, a [`Start`] and a time
//! limit. [`Environments`] are many of them. A [`Rollout`] holds what they do under a [`Policy`] over a horizon.
//!
//! What environment `i` does follows from its number, the seed, the policy and the steps taken: not from the number of
//! environments or threads, the instruction set, the layout of the rollout or how many steps are taken at a time.

mod batch;
mod environment;
mod kernel;
pub mod policy;
mod rollout;
pub mod start;
pub mod task;

pub use batch::{Environments, Final};
pub use environment::Environment;
pub use policy::{Place, Policy};
pub use rollout::{Layout, Plan, Rollout, Writes};
pub use start::Start;
pub use task::Task;
