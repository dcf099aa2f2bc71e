//! A force as a command.

use super::Controller;
use crate::{Float, State, System};

/// The force of a system, as a command: with a latency it is the force itself that comes late. The plant then is
/// what is left without it, such as an oscillator with `ω² = 0`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Force<Sys>(
    /// Whose force it is.
    pub Sys,
);

impl<T, Sys, const D: usize> Controller<T, D> for Force<Sys>
where
    T: Float,
    Sys: System<T, D> + Copy + Send + Sync,
{
    type Memory = [T; 0];

    fn start(&self, _: &State<T, D>) -> [T; 0] {
        []
    }

    #[inline(always)]
    fn command(&self, _: &mut [T; 0], observed: &State<T, D>, _: T) -> [T; D] {
        self.0.acceleration(observed)
    }
}
