//! A table of the report.

use serde::{Deserialize, Serialize};

use super::Cell;

/// Rows under named columns.
#[derive(Clone, Debug, Deserialize, Serialize, PartialEq)]
pub struct Table {
    /// Name, unique in the study.
    pub name: String,
    /// Heads of the columns, each with its unit where it has one.
    pub columns: Vec<String>,
    /// The rows, each as long as `columns`.
    pub rows: Vec<Vec<Cell>>,
}

impl Table {
    /// An empty table.
    pub fn new(name: &str, columns: &[&str]) -> Self {
        let columns = columns.iter().map(|&c| c.into()).collect();
        Table { name: name.into(), columns, rows: Vec::new() }
    }

    /// Adds a row.
    pub fn push(&mut self, row: impl IntoIterator<Item = Cell>) {
        let row: Vec<Cell> = row.into_iter().collect();
        debug_assert_eq!(row.len(), self.columns.len());
        self.rows.push(row);
    }
}
