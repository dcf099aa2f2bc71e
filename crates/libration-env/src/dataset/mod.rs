//! Data sets of rollouts: what `libration rollout` writes.
//!
//! A data set is divided into groups of neighbouring environments, and what each group does into chunks of steps. All of it follows
//! from its settings, so that whoever was stopped computes again where it was, and whoever doubts computes it again.

mod again;
mod chunk;
mod episodes;
mod error;
mod format;
mod minari;
mod reading;
mod repair;
mod room;
mod settings;
mod stream;
mod tables;
mod told;
mod watch;
mod world;

pub use again::{Check, check};
pub use error::DatasetError;
pub use format::DataFormat;
pub use libration_data::{DataError, Flaw};
pub use settings::{DEFAULT, Dataset, parse};
pub use stream::{Job, write};
pub use watch::Watch;
