//! Environments chosen at run time: [`EnvironmentSettings`], and the [`Batch`] built from them.
//!
//! Their kernels are compiled here once, for data sets and for Python.

mod batch;
mod construction;
mod policy;
mod settings;
mod system;
mod task;

pub use batch::Batch;
pub use construction::{BatchVisitor, EnvironmentFloat};
pub use policy::{AnyPolicy, PolicySettings};
pub use settings::{EnvironmentSettings, Noise};
pub use system::SingleDofSystem;
pub use task::Task;
