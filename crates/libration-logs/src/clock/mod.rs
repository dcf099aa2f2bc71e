//! Statistics of recorded clocks: intervals and their law, order, drift between two clocks, and latencies between two topics.

mod drift;
mod latency;
mod law;
mod law_fit;
mod pairs;
mod phase;
mod spectrum;
mod statistics;
mod time_dependence;
mod topic_clock;
mod two_values;

pub use drift::Drift;
pub use latency::{Doubt, Latency, Matching};
pub use law::{Law, LawKind};
pub use law_fit::{Fit, LawFit, LawVerdict};
pub use phase::{PhaseLag, phase_lags, rate_of_phase};
pub use spectrum::{Band, Spectrum};
pub use statistics::{Lateness, Quantile, Statistics};
pub use time_dependence::{Dependence, TimeDependence};
pub use topic_clock::TopicClock;
