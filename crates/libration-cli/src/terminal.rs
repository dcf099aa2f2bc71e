//! Output: results on stdout, messages on stderr.

use std::io::{self, ErrorKind, Write};

use anstream::ColorChoice;
use anstyle::{AnsiColor, Style};
use libration_report::printable::{printable_lines, printable_styled};

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

/// Writes results to stdout, in which text of files cannot act on a terminal. A closed pipe is not an error.
pub(crate) fn print(text: &str) -> io::Result<()> {
    let text = printable_lines(text);
    let mut stdout = anstream::stdout().lock();
    let written = stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush());
    match written {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        written => written,
    }
}

/// Writes lines to stderr, in which text of files cannot act on a terminal, and ignores a failure.
pub(crate) fn say(text: &str) {
    styled("", Style::new(), text);
}

/// Writes text to stderr that has its own styles, and ignores a failure.
pub(crate) fn show(text: &str) {
    let _ = writeln!(anstream::stderr().lock(), "{}", printable_styled(text.trim_end()));
}

/// Writes lines behind a heading to stderr. Only the first line begins at the edge, so that no text of a file looks like another message.
fn styled(heading: &str, style: Style, text: &str) {
    let text = printable_lines(text.trim_end());
    let text = if heading.is_empty() { text } else { text.replace('\n', "\n  ").into() };
    let mut stderr = anstream::stderr().lock();
    let _ = match heading {
        "" => writeln!(stderr, "{text}"),
        _ => writeln!(stderr, "{style}{heading}{style:#}: {text}"),
    };
}

/// Writes a warning to stderr.
pub(crate) fn warn(message: &str) {
    styled("warning", WARNING, message);
}

/// Writes an error to stderr.
pub(crate) fn error(message: &str) {
    styled("error", ERROR, message);
}
