//! Several substeps as one step.

use super::Integrator;
use crate::{Scalar, State, System};

/// A step that consists of `count` equal steps of a method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Substeps<I> {
    /// The method.
    pub method: I,
    /// The number of substeps.
    pub count: i32,
}

impl<I: Integrator> Integrator for Substeps<I> {
    const REGISTERS: usize = I::REGISTERS;

    fn evaluations(&self) -> usize {
        self.method.evaluations() * usize::try_from(self.count).unwrap_or(0)
    }

    #[inline(always)]
    fn step<S: Scalar, const D: usize>(
        self,
        system: &impl System<S, D>,
        state: State<S, D>,
        dt: S,
    ) -> State<S, D> {
        let part = dt.ratio(1, self.count);
        (0..self.count).fold(state, |state, _| self.method.step(system, state, part))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrator::Rk4;
    use crate::system::Oscillator;

    #[test]
    fn it_is_its_steps_one_after_the_other() {
        let (system, start) = (Oscillator { omega2: 10.0 }, State { q: [1.0], v: [0.5] });
        let found = Substeps { method: Rk4, count: 4 }.step(&system, start, 0.5);
        let wanted = (0..4).fold(start, |state, _| Rk4.step(&system, state, 0.125));
        assert_eq!(found, wanted);
    }
}
