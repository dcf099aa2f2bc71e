//! Lines of a text.

use std::io::{BufRead, Read};

use crate::error::LogError;

/// Largest line in bytes.
const LONGEST_LINE: u64 = 1 << 20;

/// Reads a line of at most [`LONGEST_LINE`] bytes; false at the end.
pub(crate) fn read_line(input: &mut impl BufRead, line: &mut String) -> Result<bool, LogError> {
    let mut bytes = std::mem::take(line).into_bytes();
    bytes.clear();
    input.by_ref().take(LONGEST_LINE + 1).read_until(b'\n', &mut bytes)?;
    if bytes.len() as u64 > LONGEST_LINE {
        let value = bytes.len() as u64;
        return Err(LogError::TooLarge {
            what: "length of a line in bytes",
            value,
            limit: LONGEST_LINE,
        });
    }
    *line = match String::from_utf8(bytes) {
        Ok(text) => text,
        Err(error) => String::from_utf8_lossy(error.as_bytes()).into_owned(),
    };
    Ok(!line.is_empty())
}
