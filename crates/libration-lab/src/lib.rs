//! The laboratory: studies → records → report.
//!
//! A [`Study`] asks a question; its run leaves a [`Record`] of numbers, each a prediction beside
//! a measurement; the page is rendered from the record and from nothing else.

pub mod advise;
pub mod analyze;
pub mod bench;
pub mod config;
pub mod dataset;
mod effort;
pub mod environments;
pub mod export;
pub mod figure;
mod lab;
mod machine;
mod notation;
pub mod output;
pub mod page;
pub mod record;
pub mod report;
pub mod results;
pub mod session;
pub mod setting;
pub mod studies;
pub mod study;
mod text;
pub mod trajectory;
pub mod tried;
pub mod units;
pub mod untried;
pub mod wakeups;
mod written;

pub use config::Config;
pub use effort::Effort;
pub use lab::{Lab, Progress, Silent};
pub use machine::Machine;
pub use record::Record;
pub use study::Study;
