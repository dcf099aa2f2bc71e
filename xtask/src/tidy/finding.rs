//! A finding of a rule.

use std::fmt;

/// A place in the sources, and what to change there.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Finding {
    path: String,
    line: usize,
    advice: String,
}

impl Finding {
    /// A finding in `path`, at `line` counted from one.
    pub(super) fn new(path: &str, line: usize, advice: impl Into<String>) -> Self {
        Finding { path: path.to_owned(), line, advice: advice.into() }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}: {}", self.path, self.line, self.advice)
    }
}

#[cfg(test)]
impl Finding {
    /// The place alone, for tests.
    pub(super) fn place(&self) -> (&str, usize) {
        (&self.path, self.line)
    }
}
