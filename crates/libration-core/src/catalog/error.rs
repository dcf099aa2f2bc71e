//! Errors of a system built by name.

use core::ops::RangeInclusive;

use super::{Allowed, ENTRIES, Parameter};

/// Error of building a system.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CatalogError {
    /// No system has that name.
    #[error("unknown system `{name}`; the systems are {}", list(ENTRIES.iter().map(|e| e.name)))]
    UnknownSystem {
        /// The name that was given.
        name: String,
    },
    /// The system has no parameter of that name.
    #[error(
        "{system}: unknown parameter `{name}`; its parameters are {}",
        list(known.iter().map(|p| p.name))
    )]
    UnknownParameter {
        /// The system.
        system: &'static str,
        /// The name that was given.
        name: String,
        /// The parameters that it has.
        known: &'static [Parameter],
    },
    /// A parameter was given more than once.
    #[error("{system}: parameter `{name}` is given twice")]
    Repeated {
        /// The system.
        system: &'static str,
        /// The parameter.
        name: &'static str,
    },
    /// The value of a parameter is not allowed.
    #[error("{system}: `{name}` is {value:?}, but it must be {allowed}")]
    Value {
        /// The system.
        system: &'static str,
        /// The parameter.
        name: &'static str,
        /// The value that was given.
        value: f64,
        /// The values that it may take.
        allowed: Allowed,
    },
    /// Two parameters say the same thing.
    #[error("{system}: `{name}` cannot be given together with `omega2`, since omega2 = k/m")]
    Conflict {
        /// The system.
        system: &'static str,
        /// The parameter that was given together with `omega2`.
        name: &'static str,
    },
    /// A mass is given, and no stiffness.
    #[error(
        "{system}: `m` is given without `k`; expected `k` too, in N/m (0 for a free mass), or `omega2` alone"
    )]
    NoStiffness {
        /// The system.
        system: &'static str,
    },
    /// Mass and stiffness are allowed, but their quotient is not.
    #[error(
        "{system}: omega2 = k/m = {k:?}/{m:?} is {omega2:?}, but it must be {}",
        Allowed::Positive
    )]
    Quotient {
        /// The system.
        system: &'static str,
        /// The mass, in kg.
        m: f64,
        /// The stiffness, in N/m.
        k: f64,
        /// Their quotient in `f64`, in s⁻²: zero or infinite.
        omega2: f64,
    },
    /// The system does not exist in that dimension.
    #[error("{system}: the dimension is {dimension}, but it must be {}", range(allowed))]
    Dimension {
        /// The system.
        system: &'static str,
        /// The requested dimension.
        dimension: usize,
        /// The dimensions in which it exists.
        allowed: RangeInclusive<usize>,
    },
}

/// The names in backquotes, separated by commas.
fn list<'a>(names: impl Iterator<Item = &'a str>) -> String {
    names.map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
}

/// A range of dimensions in words.
fn range(allowed: &RangeInclusive<usize>) -> String {
    match (allowed.start(), allowed.end()) {
        (low, high) if low == high => low.to_string(),
        (low, high) => format!("{low} to {high}"),
    }
}
