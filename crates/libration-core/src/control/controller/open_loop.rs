//! The open loop: no controller.

use super::Controller;
use crate::{Float, State};

/// No controller: all commands are zero.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OpenLoop;

impl<T: Float, const D: usize> Controller<T, D> for OpenLoop {
    const ACTS: bool = false;
    type Memory = [T; 0];

    fn start(&self, _: &State<T, D>) -> [T; 0] {
        []
    }

    #[inline(always)]
    fn command(&self, _: &mut [T; 0], _: &State<T, D>, _: T) -> [T; D] {
        [T::zero(); D]
    }
}
