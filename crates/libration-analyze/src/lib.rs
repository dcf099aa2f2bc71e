//! Analyses and trajectories of a system that is chosen at run time: the results of the commands `analyze` and `simulate`.
//!
//! [`analyze`] derives stability, errors and costs of one step and of a control loop, and [`linear_analysis`] those of linear plants; [`bodies`] simulates gravity; [`comparison`] finds the cheapest integrator of a motion; [`trajectory`] and [`linear_trajectory`] simulate.

pub mod adaptive;
pub mod bodies;
pub mod comparison;
pub mod equation_analysis;
pub mod equation_trajectory;
pub mod export;
pub mod linear_analysis;
pub mod linear_trajectory;
pub mod newton_residual;
mod program_simulation;
pub mod program_stepper;
mod recording;
pub mod reference_flow;
mod step;
pub mod temperature;
pub mod trajectory;

pub use step::{
    Analysis, AnalyzeError, Criteria, Drift, LargestDt, LatencyOption, LoopAnalysis, LoopCost,
    LoopGrowth, ModifiedHamiltonian, OrderOfWord, Request, RequestSummary, StableLatencies,
    Stepping, Timing, analyze, analyze_until, loop_growth,
};
