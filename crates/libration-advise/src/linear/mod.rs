//! Advice for loops around linear plants of any size.

mod advice;
mod advisor;
mod clock;
mod latency_chain;
mod page;
mod redesign;
mod request;
mod simulated_cost;
mod summary;

pub use advice::{ControllerMatrices, Deviation, InputMargins, LinearAdvice, SignalName};
pub use advisor::advise;
pub use latency_chain::ChainLink;
pub use page::{NO_MARGINS, page};
pub use redesign::Redesign;
pub use request::{LinearRequest, RequestFile, is_linear, parse, parse_changed};
