//! Analyses and trajectories of a system that is chosen at run time: the results of the commands `analyze` and `simulate`.
//!
//! [`analyze`] derives stability, errors and costs of one step and of a control loop, and [`linear_analysis`] those of linear plants; [`trajectory`] and [`linear_trajectory`] simulate.

pub mod equation_analysis;
pub mod equation_trajectory;
pub mod export;
pub mod linear_analysis;
pub mod linear_trajectory;
mod program_simulation;
mod recording;
mod step;
pub mod trajectory;

pub use step::{
    Analysis, AnalyzeError, Criteria, Drift, LargestDt, LatencyOption, LoopAnalysis, LoopCost,
    LoopGrowth, ModifiedHamiltonian, OrderOfWord, Request, RequestSummary, StableLatencies,
    Stepping, Timing, analyze, analyze_until, loop_growth,
};
