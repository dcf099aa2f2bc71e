//! What a study is: a question, its settings, and the record that its run leaves.
//!
//! A [`Study`] asks a question; its run leaves a [`Record`](libration_report::Record) of numbers, each a prediction beside
//! a measurement; its chapter is rendered from the record and from nothing else.

mod config;
mod effort;
mod file;
mod fit;
mod lab;
mod machine;
mod registry;
mod sampled;
pub mod schema;
mod settings;
pub mod source;
mod spring;
mod study;
mod table;
mod tried;

pub use config::Config;
pub use effort::Effort;
pub use fit::Fit;
pub use lab::Lab;
pub use libration_work::{Interrupted, Progress, Silent, Work};
pub use machine::{Cache, Machine};
pub use registry::Registry;
pub use sampled::sampled_steps;
pub use settings::{AllSettings, Section, Settings};
pub use spring::{Spring, Start};
pub use study::{Study, StudyError};
pub use tried::{Tried, Unjudged, order};
