//! Settings in files and flags.
//!
//! Each limit is defined once, for files and flags. An error names the position in the file.

pub mod bodies_file;
mod config_command;
mod document;
pub mod duration;
mod equation_examples;
pub mod equations;
mod error;
mod fault;
mod file;
mod instruction_set;
pub mod latency_presets;
pub mod limits;
pub mod linear_loop;
pub mod live_settings;
pub mod optional_path;
mod start_table;
pub mod suggestions;
mod system_tables;
pub mod units;
pub mod validation;
mod value;

pub use config_command::ConfigCommand;
pub use document::Document;
pub use equation_examples::EquationExample;
pub use error::SettingsError;
pub use fault::Fault;
pub use file::{read, read_text};
pub use instruction_set::instruction_set_name;
pub use start_table::{Coordinates, StartTable};
pub use system_tables::SystemTables;
pub use value::{Count, Number, numbers};
