//! The laboratory: all studies, run in turn, and their report.

mod ledger;
pub mod output;
pub mod results;
mod series;
pub mod session;
mod studies;
mod unjudged;
pub mod untried;
mod written;

pub use studies::STUDIES;
