//! A value that is not allowed.

use std::fmt;

/// A value of a settings file that is not allowed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// Where it stands, as in `drift.dt`.
    pub key: &'static str,
    /// Which element of the array, counted from zero.
    pub index: Option<usize>,
    /// What is wrong, and what is allowed.
    pub message: String,
    /// What could be done about it.
    pub help: Option<String>,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)?;
        self.help.iter().try_for_each(|help| write!(f, "; {help}"))
    }
}

impl std::error::Error for Fault {}

impl Fault {
    /// The value of `key` is not allowed.
    pub fn new(key: &'static str, message: impl Into<String>) -> Self {
        Fault { key, index: None, message: message.into(), help: None }
    }

    /// Element `index` of the array `key` is not allowed.
    pub fn at(key: &'static str, index: usize, message: impl Into<String>) -> Self {
        Fault { key, index: Some(index), message: message.into(), help: None }
    }

    /// The same with what could be done about it.
    #[must_use]
    pub fn help(mut self, help: String) -> Self {
        self.help = Some(help);
        self
    }
}
