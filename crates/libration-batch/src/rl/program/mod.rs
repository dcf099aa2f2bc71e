//! Environments of systems and tasks that are known when the program runs.
//!
//! A [`ProgramEnvironment`] has a system, a task and an integrator as programs, and any number of states, inputs and observations.
//! The block machine runs them. Episodes, delays, clocks and random numbers are those of [`Environments`](super::Environments), and
//! an environment has the bits of a compiled one with the same operations.

mod answer_times;
mod batch;
mod batch_episodes;
mod block_state;
mod block_step;
mod block_substep;
mod checkpoint;
mod command_limits;
mod environment;
mod environment_check;
mod episodes;
mod horizon;
mod policy;
mod rollout;
mod row_program;
mod settlement;
mod state;
mod transitions;

pub use answer_times::AnswerTimes;
pub use batch::ProgramEnvironments;
pub use environment::ProgramEnvironment;
pub use policy::ProgramPolicy;
pub use rollout::{EpisodeEnds, ProgramRollout};
