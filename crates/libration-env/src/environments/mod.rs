//! Environments chosen at run time: [`EnvironmentSettings`], and the [`AnyEnvironments`] built from them.
//!
//! Their kernels are compiled here once, for data sets and for Python.

mod any_environments;
mod construction;
mod policy;
mod settings;
mod system;
mod task;

pub use any_environments::AnyEnvironments;
pub use construction::{EnvironmentFloat, EnvironmentsVisitor};
pub use policy::{AnyPolicy, PolicySettings};
pub use settings::{EnvironmentSettings, Noise};
pub use system::SingleDofSystem;
pub use task::Task;
