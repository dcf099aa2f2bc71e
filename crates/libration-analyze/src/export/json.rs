//! JSON: one object with the request and the rows.

use std::fmt::Write as _;
use std::io;
use std::io::Write;

use serde::Serialize;
use serde_json::Value;

use super::{ExportError, Number, Rows};

/// Writes rows as the array `rows` of an object, one row to a line.
///
/// Numbers that are not finite become `null`.
#[derive(Debug)]
pub struct Json<W> {
    out: W,
    line: String,
    first: bool,
}

impl<W: Write> Json<W> {
    /// Begins an object in `out` with the entries `head`.
    ///
    /// # Errors
    /// If `out` cannot be written.
    pub fn new(mut out: W, head: &[(&str, Value)]) -> Result<Self, ExportError> {
        out.write_all(b"{\n")?;
        for (key, value) in head {
            entry(&mut out, key, value)?;
            out.write_all(b",\n")?;
        }
        out.write_all(b"  \"rows\": [")?;
        Ok(Json { out, line: String::new(), first: true })
    }

    /// Ends the object with more entries.
    ///
    /// # Errors
    /// If `out` cannot be written.
    pub fn finish(mut self, tail: &[(&str, Value)]) -> Result<(), ExportError> {
        self.out.write_all(b"\n  ]")?;
        for (key, value) in tail {
            self.out.write_all(b",\n")?;
            entry(&mut self.out, key, value)?;
        }
        Ok(self.out.write_all(b"\n}\n")?)
    }
}

fn entry(out: &mut impl Write, key: &str, value: &impl Serialize) -> Result<(), ExportError> {
    let text = serde_json::to_string(value).map_err(io::Error::from)?;
    Ok(write!(out, "  \"{key}\": {text}")?)
}

impl<W: Write, S: Number> Rows<S> for Json<W> {
    fn row(&mut self, index: &[u64], t: f64, values: &[S]) -> Result<(), ExportError> {
        self.line.clear();
        self.line.push_str(if self.first { "\n    [" } else { ",\n    [" });
        self.first = false;
        for whole in index {
            let _infallible = write!(self.line, "{whole}, ");
        }
        number(&mut self.line, t);
        for &value in values {
            self.line.push_str(", ");
            number(&mut self.line, value);
        }
        self.line.push(']');
        Ok(self.out.write_all(self.line.as_bytes())?)
    }
}

fn number<S: Number>(line: &mut String, value: S) {
    if value.is_finite() {
        value.append_text(line);
    } else {
        line.push_str("null");
    }
}
