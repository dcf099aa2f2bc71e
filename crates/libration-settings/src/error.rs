//! Errors of settings files.

use std::fmt;
use std::ops::Range;
use std::str::Utf8Error;

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};

/// An error in a settings file.
///
/// Its `Display` shows file, line and column, and the line itself with a caret.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SettingsError {
    file: String,
    source: String,
    span: Range<usize>,
    message: String,
    help: Option<String>,
}

impl SettingsError {
    /// The error `message` about the part `span` of `source`.
    pub fn new(
        file: &str,
        source: &str,
        span: Range<usize>,
        message: impl Into<String>,
        help: Option<String>,
    ) -> Self {
        // A parser may report a span that splits a character.
        let start = source.floor_char_boundary(span.start);
        let end = source.ceil_char_boundary(span.end.max(start));
        SettingsError {
            file: file.into(),
            source: source.into(),
            span: start..end,
            message: message.into(),
            help,
        }
    }

    /// The error of a file whose bytes are not UTF-8.
    pub fn not_utf8(bytes: &[u8], error: Utf8Error, file: &str) -> Self {
        // Up to the bad byte, the shown text and the file are the same.
        let text = String::from_utf8_lossy(bytes);
        let start = error.valid_up_to();
        let skipped = if text.starts_with('\u{feff}') { '\u{feff}'.len_utf8() } else { 0 };
        let span = start - skipped..start - skipped + char::REPLACEMENT_CHARACTER.len_utf8();
        let byte = bytes.get(start).copied().unwrap_or_default();
        let message = format!("the file is not UTF-8: byte 0x{byte:02X} is invalid");
        let help = match bytes {
            [0xFF, 0xFE, ..] | [0xFE, 0xFF, ..] => "this looks like UTF-16; save the file as UTF-8",
            _ => "save the file as UTF-8",
        };
        SettingsError::new(file, &text[skipped..], span, message, Some(help.into()))
    }

    /// The error in words.
    pub fn message(&self) -> &str {
        &self.message
    }

    /// The error in a sentence with its line, for a message that names the file.
    pub fn sentence(&self) -> String {
        let line = self.source[..self.span.start].matches('\n').count() + 1;
        let help = self.help.as_ref().map_or_else(String::new, |help| format!("; help: {help}"));
        format!("line {line}: {}{help}", self.message)
    }

    /// A suggestion, if there is one.
    pub fn help(&self) -> Option<&str> {
        self.help.as_deref()
    }

    /// The text of the file, without a byte-order mark.
    pub fn source_text(&self) -> &str {
        &self.source
    }

    /// The bytes of [`source_text`](Self::source_text) with the error.
    pub fn span(&self) -> Range<usize> {
        self.span.clone()
    }

    /// The error as text for a terminal that shows colours.
    pub fn render_styled(&self) -> String {
        self.render(&Renderer::styled())
    }

    fn render(&self, renderer: &Renderer) -> String {
        let place = AnnotationKind::Primary.span(self.span.clone());
        let snippet = Snippet::source(&self.source).path(&self.file).annotation(place);
        let mut group = Level::ERROR.primary_title(&self.message).element(snippet);
        if let Some(help) = &self.help {
            group = group.element(Level::HELP.message(help));
        }
        renderer.render(&[group])
    }
}

impl fmt::Display for SettingsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.render(&Renderer::plain()))
    }
}

impl std::error::Error for SettingsError {}
