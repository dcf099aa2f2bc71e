//! The numbers of a step of Langevin dynamics.

use crate::{Elementary, Scalar};

/// The numbers that a step of Langevin dynamics takes besides the state and its noise.
///
/// They are arguments because a step has no exponential function and no division on all number types.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LangevinStep<S> {
    /// Time step `h` in s.
    pub dt: S,
    /// `exp(−γh/n)`: the part of a velocity that each of the `n` letters O of a word leaves.
    pub decay: S,
    /// `γh`.
    pub damping: S,
    /// `1/(1 + γh/2)`, of methods that treat friction implicitly.
    pub implicit_factor: S,
}

impl<S: Elementary> LangevinStep<S> {
    /// The numbers for a time step in s, a friction in 1/s, and the number of letters O.
    pub fn new(dt: S, friction: S, letters: usize) -> Self {
        let damping = friction * dt;
        let decay = (-damping).ratio(1, letters.max(1) as i32).exp();
        LangevinStep { decay, ..LangevinStep::of_decay(dt, damping, decay) }
    }

    /// The numbers for a time step and given values of `γh` and of the decay of each letter O.
    pub fn of_decay(dt: S, damping: S, decay: S) -> Self {
        let implicit_factor = (S::one() + damping.ratio(1, 2)).recip();
        LangevinStep { dt, decay, damping, implicit_factor }
    }
}

impl<S: Scalar> LangevinStep<S> {
    /// The variance of a velocity that a letter O adds, over `kT/m`: `1 − exp(−2γh/n)`.
    #[inline(always)]
    pub fn letter_variance(&self) -> S {
        S::one() - self.decay * self.decay
    }
}
