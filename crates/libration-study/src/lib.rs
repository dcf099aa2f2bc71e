//! The interface of a study: question, settings and record.
//!
//! A [`Study`] has a question. Its run returns a [`Record`](libration_report::Record) of predictions and measurements, and its
//! chapter is rendered from the record alone.

mod config;
mod effort;
mod file;
mod fit;
mod lab;
mod log_spacing;
mod machine;
mod registry;
pub mod schema;
mod settings;
mod source_claim;
pub mod source_report;
mod spring;
mod study;
mod table;

pub use config::Config;
pub use effort::Effort;
pub use fit::Fit;
pub use lab::Lab;
pub use libration_work::{Interrupted, Progress, Silent, Work};
pub use log_spacing::log_spaced_steps;
pub use machine::{Cache, Machine};
pub use registry::Registry;
pub use settings::{AllSettings, Section, Settings};
pub use source_claim::{SourceClaim, UnjudgedClaim, order};
pub use spring::{Spring, Start};
pub use study::{Study, StudyError};
