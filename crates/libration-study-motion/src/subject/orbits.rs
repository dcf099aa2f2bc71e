//! The starts of the search for a stability limit.

/// The start of an orbit, with the criterion for its loss.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Orbits {
    /// From the configured start: lost if the energy has changed by as much as there was, or is no
    /// number.
    Configured,
    /// Close to the equilibrium: lost if it has grown a thousandfold.
    Small,
}
