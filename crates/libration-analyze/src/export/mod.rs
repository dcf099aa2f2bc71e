//! Tables of numbers as files: Parquet, NumPy, CSV and JSON.
//!
//! Parquet and NumPy files are written from a complete [`Table`]; CSV and JSON stream a trajectory row by
//! row through [`Rows`].

mod csv;
mod error;
mod json;
mod number;

pub use csv::Csv;
pub use error::ExportError;
pub use json::Json;
pub use libration_data::{Column, Table, Values, parquet_bytes, write_npy, write_parquet};
pub use number::Number;

/// Receives the rows of a trajectory in order.
pub trait Rows<S> {
    /// Receives the row at time `t` seconds. `index` has the integer columns before `t`, the last of which is
    /// the step; `values` has the columns after `t`.
    ///
    /// # Errors
    /// If the row cannot be written or kept.
    fn row(&mut self, index: &[u64], t: f64, values: &[S]) -> Result<(), ExportError>;
}
