//! Records of findings, figures, pages and the HTML report, without any physics.

pub mod figure;
pub mod live;
pub mod notation;
pub mod page;
pub mod printable;
pub mod record;
pub mod report;
pub mod text;
pub mod verdict;

pub use record::Record;
pub use verdict::{Outcome, Verdict};
