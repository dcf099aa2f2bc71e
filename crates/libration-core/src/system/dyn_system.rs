//! Dynamic dispatch of a system.

use super::System;
use crate::{Scalar, State};

/// A system behind a function pointer: code that takes any system is compiled once and calls it for every acceleration. Its
/// loops are not vectorised.
#[derive(Clone, Copy)]
pub struct DynSystem<'a, S, const D: usize>(
    /// The acceleration.
    pub &'a (dyn Fn(&State<S, D>) -> [S; D] + Send + Sync),
);

impl<S: Scalar, const D: usize> System<S, D> for DynSystem<'_, S, D> {
    const BASELINE_ONLY: bool = true;

    #[inline]
    fn acceleration(&self, state: &State<S, D>) -> [S; D] {
        (self.0)(state)
    }
}
