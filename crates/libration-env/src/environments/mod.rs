//! Environments chosen at run time: [`EnvironmentSettings`], and the [`AnyEnvironments`] built from them.
//!
//! The few compiled kernels are compiled here once, for data sets and for Python; the block machine runs all others.

mod any_environments;
mod any_rollout;
mod catalogue_task;
mod construction;
mod policy;
mod settings;
mod task;

pub use any_environments::AnyEnvironments;
pub use any_rollout::AnyRollout;
pub use catalogue_task::{CatalogueTask, task_expressions};
pub use construction::{EnvironmentFloat, Selection};
pub use policy::PolicySettings;
pub use settings::{EnvironmentSettings, EnvironmentSubject, EquationSubject, Noise};
pub use task::Task;
