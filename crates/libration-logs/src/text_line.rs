//! Lines of a text.

use std::io::BufRead;

use crate::error::LogError;
use crate::text_encoding::windows_1252;

/// Largest line in bytes.
const LONGEST_LINE: u64 = 1 << 20;

/// Reads a text line by line. A line ends with LF, CR LF or CR.
pub(crate) struct TextLines<R> {
    input: R,
    bytes: Vec<u8>,
    /// The number of the line, from 1.
    pub(crate) number: usize,
    /// Number of lines in Latin-1 or Windows-1252.
    pub(crate) latin_1: usize,
}

impl<R: BufRead> TextLines<R> {
    pub(crate) fn new(input: R) -> Self {
        TextLines { input, bytes: Vec::new(), number: 0, latin_1: 0 }
    }

    /// Reads a line without its end, of at most [`LONGEST_LINE`] bytes; false at the end of the text.
    pub(crate) fn read(&mut self, line: &mut String) -> Result<bool, LogError> {
        self.bytes.clear();
        let mut has_end = false;
        while !has_end {
            let buffer = self.input.fill_buf()?;
            if buffer.is_empty() {
                break;
            }
            let end = buffer.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
            let count = end.unwrap_or(buffer.len());
            let value = (self.bytes.len() + count) as u64;
            if value > LONGEST_LINE {
                let (what, limit) = ("length of a line in bytes", LONGEST_LINE);
                return Err(LogError::TooLarge { what, value, limit });
            }
            self.bytes.extend_from_slice(&buffer[..count]);
            let is_return = end.is_some_and(|end| buffer[end] == b'\r');
            self.input.consume(count + usize::from(end.is_some()));
            has_end = end.is_some();
            if is_return && self.input.fill_buf()?.first() == Some(&b'\n') {
                self.input.consume(1);
            }
        }
        line.clear();
        match std::str::from_utf8(&self.bytes) {
            Ok(text) => line.push_str(text),
            Err(_) => {
                self.latin_1 += 1;
                line.extend(self.bytes.iter().copied().map(windows_1252));
            }
        }
        self.number += 1;
        Ok(has_end || !self.bytes.is_empty())
    }
}
