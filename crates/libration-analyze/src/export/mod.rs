//! Tables of numbers as files: Parquet, NumPy, CSV and JSON.
//!
//! Parquet and NumPy files are written from a whole [`Table`]; CSV and JSON take a trajectory
//! row by row as it comes, through [`Rows`].

mod csv;
mod error;
mod json;
mod number;

pub use csv::Csv;
pub use error::ExportError;
pub use json::Json;
pub use libration_data::{Column, Table, Values, parquet_bytes, write_npy, write_parquet};
pub use number::Number;

/// Takes the rows of a trajectory in turn.
pub trait Rows<S> {
    /// Takes the row at time `t` seconds: `index` holds the columns of whole numbers before it, the
    /// last of which is the step, `values` the columns after it.
    ///
    /// # Errors
    /// If the row cannot be written or kept.
    fn row(&mut self, index: &[u64], t: f64, values: &[S]) -> Result<(), ExportError>;
}
