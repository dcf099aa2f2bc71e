//! Advice for loops around linear plants of any size.

mod advice;
mod advisor;
mod analysis_request;
mod clock;
mod deadlines;
mod deadlines_page;
mod latency_chain;
mod live_setting;
mod loop_of_request;
mod margins;
mod mode;
mod page;
mod redesign;
mod redesign_limits;
mod redesign_page;
mod redesign_toml;
mod request;
mod request_file;
mod simulated_cost;
mod stated_deadlines;
mod stiffness;
mod summary;
mod timing_fault;

pub use advice::{ControllerMatrices, Deviation, LinearAdvice, SignalName};
pub use advisor::advise;
pub use analysis_request::AnalysisFile;
pub use deadlines::{DeadlineMisses, MissRow, RandomMisses, WorstCase};
pub use latency_chain::ChainLink;
pub use margins::InputMargins;
pub use mode::Mode;
pub use page::{NO_MARGINS, page};
pub use redesign::Redesign;
pub use redesign_limits::{RedesignLimit, StableRange};
pub use request::{LinearRequest, is_linear, parse, parse_changed};
pub use request_file::RequestFile;
