//! Names of signals.

/// The name and the unit of a state, an input or an output.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Signal {
    /// The name.
    pub name: String,
    /// The unit; empty if it is unknown.
    pub unit: String,
}

impl Signal {
    /// A signal of this name and unit.
    pub fn new(name: &str, unit: &str) -> Self {
        Signal { name: name.to_owned(), unit: unit.to_owned() }
    }

    /// The signal of a name with its unit in parentheses, such as `angle (rad)`.
    pub fn parse(text: &str) -> Self {
        match text.trim().strip_suffix(')').and_then(|rest| rest.rsplit_once('(')) {
            Some((name, unit)) => Signal::new(name.trim(), unit.trim()),
            None => Signal::new(text.trim(), ""),
        }
    }

    /// `count` signals named `letter` and a number from 1.
    pub fn numbered(letter: &str, count: usize) -> Vec<Signal> {
        (1..=count).map(|i| Signal::new(&format!("{letter}{i}"), "")).collect()
    }
}
