//! Output: results on stdout, messages on stderr.

use std::io::{self, ErrorKind, Write};

use anstream::ColorChoice;
use anstyle::{AnsiColor, Style};

/// The heading of an error.
const ERROR: Style = AnsiColor::Red.on_default().bold();
/// The heading of a warning.
const WARNING: Style = AnsiColor::Yellow.on_default().bold();

/// Sets the colour of both streams. `Auto` depends on the stream and on `NO_COLOR`.
pub(crate) fn set_color(choice: clap::ColorChoice) {
    match choice {
        clap::ColorChoice::Auto => ColorChoice::Auto,
        clap::ColorChoice::Always => ColorChoice::Always,
        clap::ColorChoice::Never => ColorChoice::Never,
    }
    .write_global();
}

/// Writes results to stdout. A closed pipe is not an error.
pub(crate) fn print(text: &str) -> io::Result<()> {
    let mut stdout = anstream::stdout().lock();
    let written = stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush());
    match written {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        written => written,
    }
}

/// Writes a line to stderr, and ignores a failure.
pub(crate) fn say(text: &str) {
    let _ = writeln!(anstream::stderr().lock(), "{}", text.trim_end());
}

/// Writes a warning to stderr.
pub(crate) fn warn(message: &str) {
    say(&format!("{WARNING}warning{WARNING:#}: {message}"));
}

/// Writes an error to stderr.
pub(crate) fn error(message: &str) {
    say(&format!("{ERROR}error{ERROR:#}: {message}"));
}
