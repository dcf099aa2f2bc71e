//! Settings in files and flags.
//!
//! Each limit is defined once, for files and flags alike, and an error points at the characters of the file that are wrong.

pub mod check;
mod document;
mod error;
mod fault;
mod file;
pub mod limits;
pub mod names;
pub mod path;
pub mod setting;
pub mod units;
mod value;

pub use document::Document;
pub use error::SettingsError;
pub use fault::Fault;
pub use file::{read, read_text};
pub use value::{Count, Number, numbers};
