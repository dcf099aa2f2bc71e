//! A step of an integrator from the start of a system, and the control loop around it.

mod checks;
mod cost;
mod criteria;
mod drift;
mod error;
mod growth;
mod limits;
mod loop_analysis;
mod modes;
mod modified_hamiltonian;
mod order;
mod request;
mod start_step;
mod step_matrix;
mod timing;

pub(crate) use checks::{
    check_criteria, check_exact, check_implicit, check_sizes, check_start, check_turn,
};
pub use cost::LoopCost;
pub use criteria::Criteria;
pub use drift::Drift;
pub use error::AnalyzeError;
pub use growth::LoopGrowth;
pub(crate) use limits::largest_dt;
pub use limits::{LargestDt, OrderOfWord};
pub(crate) use loop_analysis::answer as loop_answer;
pub use loop_analysis::{LoopAnalysis, StableLatencies, loop_growth};
pub(crate) use modes::Modes;
pub use modified_hamiltonian::ModifiedHamiltonian;
pub(crate) use order::lost_order;
pub use order::{spectral_radius, step_order};
pub use request::{Request, Stepping};
pub(crate) use start_step::StartStep;
pub use step_matrix::StepMatrix;
pub use timing::{LatencyOption, Timing};
