//! Data sets of rollouts, the output of `libration rollout`.
//!
//! A data set is divided into groups of neighbouring environments, and the rollout of a group into chunks of steps. Its numbers
//! follow from the settings, so that an interrupted data set can be resumed, and each data set can be verified by recomputation.

mod chunk_files;
mod chunk_order;
mod delay_steps;
mod episodes;
mod equation_tables;
mod error;
mod format;
mod group;
mod group_rollout;
mod join;
mod manifest_settings;
mod memory_check;
mod minari;
mod monitor;
mod repair;
mod resume_state;
mod settings;
mod stated_contents;
mod system_tables;
mod table_conversion;
mod tables;
mod verification;
mod writer;

pub use error::DatasetError;
pub use format::DataFormat;
pub use join::{JoinJob, join};
pub use libration_data::{DataError, Flaw, Transfer};
pub use monitor::Monitor;
pub use settings::{DEFAULT, Dataset, parse, parse_of};
pub use system_tables::EquationSource;
pub use verification::{Verification, VerifyOptions, verify};
pub use writer::{WriteJob, write};
