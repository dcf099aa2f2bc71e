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

    /// `count` signals named `letter` and a number from 1.
    pub fn numbered(letter: &str, count: usize) -> Vec<Signal> {
        (1..=count).map(|i| Signal::new(&format!("{letter}{i}"), "")).collect()
    }
}
