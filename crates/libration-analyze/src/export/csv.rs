//! Comma-separated values.

use std::fmt::Write as _;
use std::io::Write;

use super::{ExportError, Number, Rows};

/// Writes rows as text: a line of names, then a line per row.
///
/// Floats are written in the shortest form that is read as the same bits.
#[derive(Debug)]
pub struct Csv<W> {
    out: W,
    line: String,
}

impl<W: Write> Csv<W> {
    /// Begins a file in `out` with the line of `names`.
    ///
    /// # Errors
    /// If `out` cannot be written.
    pub fn new<'n>(
        mut out: W,
        names: impl IntoIterator<Item = &'n str>,
    ) -> Result<Self, ExportError> {
        let names: Vec<_> = names.into_iter().collect();
        writeln!(out, "{}", names.join(","))?;
        Ok(Csv { out, line: String::new() })
    }
}

impl<W: Write, S: Number> Rows<S> for Csv<W> {
    fn row(&mut self, index: &[u64], t: f64, values: &[S]) -> Result<(), ExportError> {
        self.line.clear();
        for number in index {
            let _infallible = write!(self.line, "{number},");
        }
        let _infallible = write!(self.line, "{t:?}");
        for value in values {
            self.line.push(',');
            value.append_text(&mut self.line);
        }
        self.line.push('\n');
        Ok(self.out.write_all(self.line.as_bytes())?)
    }
}
