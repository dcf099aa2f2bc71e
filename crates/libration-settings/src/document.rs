//! TOML documents that locate errors in their text.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue, Error};

use super::{ConfigCommand, Fault, SettingsError, suggestions};

/// A parsed TOML file with the position of each value.
pub struct Document<'a> {
    file: &'a str,
    text: &'a str,
    table: Spanned<DeTable<'a>>,
}

impl<'a> Document<'a> {
    /// Parses `text`; `file` is the name in messages.
    pub fn parse(text: &'a str, file: &'a str) -> Result<Self, SettingsError> {
        match DeTable::parse(text) {
            Ok(table) => Ok(Document { file, text, table }),
            Err(error) => {
                let span = error.span().unwrap_or_default();
                Err(SettingsError::new(file, text, span, error.message(), None))
            }
        }
    }

    /// Checks that each key at the root is one of `own`, or one that another command reads.
    ///
    /// # Errors
    /// The first unknown key.
    pub fn check_keys(&self, own: &[&str]) -> Result<(), SettingsError> {
        let known = |key: &str| own.contains(&key) || ConfigCommand::reader_of(key).is_some();
        let unknown = |key: &&Spanned<_>| !known(AsRef::<str>::as_ref(key.get_ref()));
        match self.table.get_ref().keys().filter(unknown).min_by_key(|key| key.span().start) {
            None => Ok(()),
            Some(key) => {
                let name: &str = key.get_ref();
                let help = unknown_key_help(name, own);
                let message = format!("unknown key `{name}`");
                Err(SettingsError::new(self.file, self.text, key.span(), message, Some(help)))
            }
        }
    }

    /// Whether there is a key of this name at the root.
    pub fn has_key(&self, name: &str) -> bool {
        self.table.get_ref().keys().any(|key| AsRef::<str>::as_ref(key.get_ref()) == name)
    }

    /// The error of a value that is not allowed.
    pub fn locate(&self, fault: Fault) -> SettingsError {
        let span = self.find(&fault.key, fault.index);
        SettingsError::new(self.file, self.text, span, fault.message, fault.help)
    }

    /// The error of a key that does not exist or a value of the wrong type.
    pub fn explain(&self, error: &Error) -> SettingsError {
        let span = error.span().unwrap_or_default();
        let message = error.message();
        let (message, help) = match unknown_key(message) {
            Some((key, known)) => {
                let known = known.iter().copied();
                (format!("unknown key `{key}`"), Some(suggestions::suggest("keys", key, known)))
            }
            None => {
                let message = one_of_many(message).unwrap_or(message);
                match key_around(self.table.get_ref(), &span) {
                    Some(key) => (format!("`{key}`: {message}"), None),
                    None => (message.to_owned(), None),
                }
            }
        };
        SettingsError::new(self.file, self.text, span, message, help)
    }

    /// The position of the value of `key`. For a default it is the position of the first value of its
    /// table, or of the table.
    fn find(&self, key: &str, index: Option<usize>) -> Range<usize> {
        let mut table = self.table.get_ref();
        let mut span = 0..0;
        for part in key.split('.') {
            let Some((name, value)) = table.iter().find(|(name, _)| name.get_ref() == part) else {
                return table.values().next().map_or(span, Spanned::span);
            };
            match value.get_ref() {
                DeValue::Table(inner) => {
                    span = name.span();
                    table = inner;
                }
                DeValue::Array(items) => {
                    let item = index.and_then(|i| items.get(i));
                    return item.map_or(value.span(), Spanned::span);
                }
                _ => return value.span(),
            }
        }
        span
    }
}

/// Help for an unknown key at the root: the most similar key of any command, and a list of those of this one.
fn unknown_key_help(name: &str, own: &[&str]) -> String {
    if name == "oscillator" {
        return "the table of the oscillator is [system.oscillator]".to_owned();
    }
    if suggestions::key_meant(name).is_some_and(|meant| own.contains(&meant)) {
        return suggestions::suggest("keys", name, own.iter().copied());
    }
    let of_own = suggestions::nearest(name, own.iter().copied());
    let of_all = suggestions::nearest(name, ConfigCommand::all_keys());
    let near = suggestions::nearest(name, [of_own, of_all].into_iter().flatten());
    let foreign = near.filter(|near| !own.contains(near));
    match foreign.and_then(|near| Some((near, ConfigCommand::reader_of(near)?.name))) {
        Some((near, reader)) => {
            let own = own.iter().map(|key| format!("`{key}`")).collect::<Vec<_>>().join(", ");
            format!("did you mean `{near}`, which `{reader}` reads? the keys are {own}")
        }
        None => suggestions::suggest("keys", name, own.iter().copied()),
    }
}

/// The unknown key and the known keys in an error message of serde.
fn unknown_key(message: &str) -> Option<(&str, Vec<&str>)> {
    let words = message.strip_prefix("unknown field `")?;
    let (key, rest) = words.split_once("`, expected ")?;
    // Every second piece is between backquotes.
    Some((key, rest.split('`').skip(1).step_by(2).collect()))
}

/// Why one of several tables, of which a file needs one, cannot be read, in words.
fn one_of_many(message: &str) -> Option<&'static str> {
    let found = message.strip_prefix("wanted exactly 1 element, ")?;
    Some(if found.starts_with("more") {
        "more than one is given; expected exactly one table"
    } else {
        "none is given; expected exactly one table"
    })
}

/// The dotted key of the innermost value around `span`.
fn key_around(table: &DeTable<'_>, span: &Range<usize>) -> Option<String> {
    let around = |value: &Spanned<DeValue<'_>>| {
        value.span().start <= span.start && span.end <= value.span().end
    };
    table.iter().find_map(|(key, value)| {
        let inner = match value.get_ref() {
            DeValue::Table(inner) => key_around(inner, span),
            _ => None,
        };
        match inner {
            Some(inner) => Some(format!("{}.{inner}", key.get_ref())),
            None => around(value).then(|| key.get_ref().to_string()),
        }
    })
}
