//! State feedback.

use super::Controller;
use crate::array::{each, map};
use crate::control::error::ensure_finite;
use crate::control::{ControlError, Feedback};
use crate::{Float, State};

/// `u = −K_p·(q − r) − K_d·v`, the same gains in each degree of freedom: PD control, or what
/// `Plant::lqr` yields.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StateFeedback<const D: usize> {
    /// The gains.
    pub gains: Feedback,
    /// `r`, where it is to be.
    pub target: [f64; D],
}

impl<const D: usize> StateFeedback<D> {
    /// A controller with the target 0.
    pub fn to_origin(gains: Feedback) -> Self {
        StateFeedback { gains, target: [0.0; D] }
    }
}

impl<T: Float, const D: usize> Controller<T, D> for StateFeedback<D> {
    type Memory = [T; 0];

    fn check(&self, _: f64) -> Result<(), ControlError> {
        ensure_finite::<T>("the gain of the position", self.gains.position)?;
        ensure_finite::<T>("the gain of the velocity", self.gains.velocity)?;
        self.target.into_iter().try_for_each(|x| ensure_finite::<T>("the target", x))
    }

    fn start(&self, _: &State<T, D>) -> [T; 0] {
        []
    }

    #[inline(always)]
    fn command(&self, _: &mut [T; 0], &State { q, v }: &State<T, D>, _: T) -> [T; D] {
        // The sign belongs to the gain: one operation less, and the same bits.
        let [kp, kd] = map([-self.gains.position, self.gains.velocity], T::from_f64);
        each(|i| kp * (q[i] - T::from_f64(self.target[i])) - kd * v[i])
    }
}
