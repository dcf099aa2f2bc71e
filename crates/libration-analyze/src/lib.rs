//! Analyses and trajectories of a system that is chosen at run time: the results of the commands `analyze` and `simulate`.
//!
//! [`analyze`] derives stability, errors and costs of one step and of a control loop, and [`linear_analysis`] those of linear plants; [`bodies`] simulates gravity; [`comparison`] finds the cheapest integrator of a motion; [`trajectory`] and [`linear_trajectory`] simulate.

pub mod adaptive;
mod analysis;
pub mod bodies;
pub mod comparison;
mod digits;
mod energy_growth;
pub mod export;
pub mod linear_analysis;
pub mod linear_trajectory;
pub mod motion;
pub mod newton_residual;
mod oscillator;
mod recording;
pub mod reference_flow;
mod stable_steps;
mod step;
mod step_verdict;
pub mod system_summary;
pub mod temperature;
pub mod trajectory;

pub use analysis::{
    AboutEquilibrium, Analysis, MotionSteps, StateError, StepVerdicts, SteppedMotion, analyze,
    analyze_until,
};
pub use digits::{beside_one, change_per_step};
pub use motion::DEFAULT_STEPS;
pub use stable_steps::{is_at_limit, is_within};
pub use step::{
    AnalyzeError, Criteria, Drift, LargestDt, LatencyOption, LoopAnalysis, LoopCost, LoopGrowth,
    ModifiedHamiltonian, OrderOfWord, Request, StableLatencies, StepMatrix, Stepping, Timing,
    loop_growth, spectral_radius, step_order,
};
pub use system_summary::SystemSummary;
