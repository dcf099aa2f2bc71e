//! Series: the named columns of numbers behind a figure.

use super::RecordError;

/// Columns of equal length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// Name, unique in the study; the file is `data/<study>-<name>.parquet`.
    pub name: String,
    /// The columns.
    pub columns: Vec<Column>,
}

/// One column of a series.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Column {
    /// Name, unique in the series.
    pub name: String,
    /// Unit of the values; `1` if there is none.
    pub unit: String,
    /// The values; NaN where there is none.
    pub values: Vec<f64>,
}

impl Series {
    /// A series without columns.
    pub fn new(name: impl Into<String>) -> Self {
        Series { name: name.into(), columns: Vec::new() }
    }

    /// The series with one more column.
    #[must_use]
    pub fn with(mut self, name: impl Into<String>, unit: &str, values: Vec<f64>) -> Self {
        debug_assert!(self.columns.first().is_none_or(|c| c.values.len() == values.len()));
        self.columns.push(Column { name: name.into(), unit: unit.into(), values });
        self
    }

    /// The values of the column `name`.
    ///
    /// # Errors
    /// If there is no such column.
    pub fn column(&self, name: &str) -> Result<&[f64], RecordError> {
        self.columns
            .iter()
            .find(|c| c.name == name)
            .map(|c| c.values.as_slice())
            .ok_or_else(|| RecordError::NoColumn { series: self.name.clone(), column: name.into() })
    }
}
