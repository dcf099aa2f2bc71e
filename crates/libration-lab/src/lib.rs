//! The laboratory: runs all studies and writes their report.

mod claim_changes;
mod claims_table;
pub mod claims_without_study;
mod compared_results;
mod comparison_verdict;
mod finding_pair;
mod live_page;
pub mod output;
mod report_check;
mod report_cover;
pub mod results;
mod results_comparison;
mod run_conditions;
mod run_manifest;
mod series;
pub mod session;
mod studies;
mod system_page;
mod system_studies;
mod unjudged_claims;

pub use claim_changes::ClaimChange;
pub use compared_results::ComparedResults;
pub use report_check::{CheckedStudy, ReportCheck};
pub use results_comparison::{Change, NOISE, ResultsComparison};
pub use run_conditions::Condition;
pub use studies::STUDIES;
pub use system_studies::{NotApplicable, SystemStudies};
