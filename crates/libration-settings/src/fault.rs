//! Invalid values.

use std::borrow::Cow;
use std::fmt;

/// An invalid value of a settings file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// The dotted key, as in `drift.dt`.
    pub key: Cow<'static, str>,
    /// The index of the element, if the value is an array.
    pub index: Option<usize>,
    /// The error and the allowed values.
    pub message: String,
    /// A suggestion.
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
    /// The fault `message` of the value of `key`.
    pub fn new(key: impl Into<Cow<'static, str>>, message: impl Into<String>) -> Self {
        Fault { key: key.into(), index: None, message: message.into(), help: None }
    }

    /// The fault `message` of element `index` of the array `key`.
    pub fn at(key: impl Into<Cow<'static, str>>, index: usize, message: impl Into<String>) -> Self {
        Fault { key: key.into(), index: Some(index), message: message.into(), help: None }
    }

    /// The same fault with a suggestion.
    #[must_use]
    pub fn help(mut self, help: String) -> Self {
        self.help = Some(help);
        self
    }
}
