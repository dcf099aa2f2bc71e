//! Environments chosen at run time: [`EnvironmentSettings`], and the [`AnyEnvironments`] built from them.
//!
//! The few compiled kernels are compiled here once, for data sets and for Python; the block machine runs all others.

mod any_environments;
mod any_rollout;
mod any_settings;
mod catalogue_program;
mod construction;
mod equation_environment;
mod policy;
mod settings;
mod system;
mod task;

pub use any_environments::AnyEnvironments;
pub use any_rollout::AnyRollout;
pub use any_settings::AnyEnvironmentSettings;
pub use construction::{EnvironmentFloat, Selection};
pub use equation_environment::EquationEnvironment;
pub use policy::PolicySettings;
pub use settings::{EnvironmentSettings, Noise};
pub use system::SingleDofSystem;
pub use task::Task;
