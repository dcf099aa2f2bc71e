//! Saturation of commands.

use super::{Controller, within};
use crate::array::map;
use crate::control::ControlError;
use crate::control::error::ensure;
use crate::{Float, State};

/// A controller whose command goes no further than `±most` in each degree of freedom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Saturated<C> {
    /// The controller.
    pub controller: C,
    /// The largest command, in units of the acceleration.
    pub most: f64,
}

impl<T: Float, C: Controller<T, D>, const D: usize> Controller<T, D> for Saturated<C> {
    type Memory = C::Memory;

    fn check(&self, period: f64) -> Result<(), ControlError> {
        ensure("the largest command", self.most, "at least 0", |most| most >= 0.0)?;
        self.controller.check(period)
    }

    fn start(&self, state: &State<T, D>) -> C::Memory {
        self.controller.start(state)
    }

    #[inline(always)]
    fn command(&self, memory: &mut C::Memory, observed: &State<T, D>, period: T) -> [T; D] {
        let most = T::from_f64(self.most);
        map(self.controller.command(memory, observed, period), |u| within(u, most))
    }
}
