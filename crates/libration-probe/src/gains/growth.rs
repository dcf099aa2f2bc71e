//! Whether motions grow under steps.

/// Whether a motion grows under a step that does not grow in the system itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Growth {
    /// No motion grows.
    None,
    /// A motion grows.
    Some,
    /// Rounding may hide growth.
    Unknown,
}

impl Growth {
    /// That of several parts together.
    pub(super) fn of_parts(parts: impl Iterator<Item = Growth>) -> Self {
        parts.fold(Growth::None, |sum, part| match (sum, part) {
            (Growth::Some, _) | (_, Growth::Some) => Growth::Some,
            (Growth::Unknown, _) | (_, Growth::Unknown) => Growth::Unknown,
            _ => Growth::None,
        })
    }
}
