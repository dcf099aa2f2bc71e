//! Output and messages of a program, with limits of their lengths.

use std::io::{self, BufRead, BufReader, Read, Write};
use std::process::{ChildStderr, ChildStdout};

use libration_report::printable::printable_lines;

/// Bytes of a reply: 100 numbers need 2.5 kB, a description of a large model with its matrices some hundred.
const MOST_BYTES: u64 = 4 << 20;
/// Bytes of its standard error that are shown.
const MOST_MESSAGES: u64 = 64 << 10;

/// Shows the first messages of a program, and reads the others, so that it does not wait for a reader.
pub(crate) fn show_messages(errors: ChildStderr) {
    let mut errors = BufReader::new(errors);
    let mut shown = errors.by_ref().take(MOST_MESSAGES);
    let mut line = Vec::new();
    while shown.read_until(b'\n', &mut line).is_ok_and(|count| count > 0) {
        // A program quotes text of files, which must not act on the terminal.
        let text = String::from_utf8_lossy(&line).replace("\r\n", "\n");
        let _ = io::stderr().write_all(printable_lines(&text).as_bytes());
        line.clear();
    }
    let rest = io::copy(&mut errors, &mut io::sink());
    if rest.is_ok_and(|bytes| bytes > 0) {
        let _ = writeln!(io::stderr(), "\n(more messages of the program are left out)");
    }
}

/// The next line; an error in words at its end.
pub(crate) fn read_line(output: &mut BufReader<ChildStdout>) -> Result<String, String> {
    let mut bytes = Vec::new();
    let read = output.by_ref().take(MOST_BYTES).read_until(b'\n', &mut bytes);
    match read {
        Err(error) => Err(format!("cannot read its output: {error}")),
        Ok(0) => Err(String::new()),
        Ok(_) if bytes.last() != Some(&b'\n') && bytes.len() as u64 >= MOST_BYTES => {
            Err(format!("a line of its output is longer than {MOST_BYTES} bytes"))
        }
        Ok(_) => String::from_utf8(bytes).map_err(|_| "its output is not UTF-8 text".into()),
    }
}
