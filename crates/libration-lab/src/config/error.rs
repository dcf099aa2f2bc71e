//! What is wrong with a configuration file, and where.

use std::fmt;
use std::ops::Range;

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};

/// An error in a configuration file.
///
/// Its `Display` shows file, line and column, and the line itself with a caret.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ConfigError {
    file: String,
    source: String,
    span: Range<usize>,
    message: String,
    help: Option<String>,
}

impl ConfigError {
    /// The error `message` about the part `span` of `source`.
    pub(super) fn new(
        file: &str,
        source: &str,
        span: Range<usize>,
        message: impl Into<String>,
        help: Option<String>,
    ) -> Self {
        // Whatever a parser says, the span must be one that can be shown.
        let start = source.floor_char_boundary(span.start);
        let end = source.ceil_char_boundary(span.end.max(start));
        ConfigError {
            file: file.into(),
            source: source.into(),
            span: start..end,
            message: message.into(),
            help,
        }
    }

    /// What is wrong.
    pub fn message(&self) -> &str {
        &self.message
    }

    /// What could be done about it.
    pub fn help(&self) -> Option<&str> {
        self.help.as_deref()
    }

    /// The text of the file, without a byte-order mark.
    pub fn source_text(&self) -> &str {
        &self.source
    }

    /// Where in [`source_text`](Self::source_text) the error is, in bytes.
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

impl fmt::Display for ConfigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.render(&Renderer::plain()))
    }
}

impl std::error::Error for ConfigError {}
