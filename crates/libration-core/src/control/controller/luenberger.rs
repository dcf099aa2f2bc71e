//! Feedback of an estimated state.

use super::Controller;
use crate::array::{each, map};
use crate::control::error::ensure_finite;
use crate::control::{ControlError, Feedback, StateObserver};
use crate::{Float, State};

/// `u = −K_p·(q̂ − r) − K_d·v̂`, of a state that a Luenberger observer estimates from the position, which is all that is seen: the
/// same in each degree of freedom.
///
/// It is the current observer of G. F. Franklin, J. D. Powell, M. L. Workman, *Digital Control of Dynamic Systems*, 3rd ed., section
/// 8.2.4: what was foretold is corrected by what is seen before the command is computed, and what the command will do is foretold
/// with the model's own step. It does not know of latencies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Luenberger<const D: usize> {
    /// The gains of the feedback.
    pub gains: Feedback,
    /// The model and how it is corrected.
    pub observer: StateObserver,
    /// `r`, where it is to be, and where the model is linear about.
    pub target: [f64; D],
}

impl<const D: usize> Luenberger<D> {
    /// A controller with the target 0.
    pub fn to_origin(gains: Feedback, observer: StateObserver) -> Self {
        Luenberger { gains, observer, target: [0.0; D] }
    }
}

impl<T: Float, const D: usize> Controller<T, D> for Luenberger<D> {
    /// The predicted distance from the target and velocity.
    type Memory = ([T; D], [T; D]);

    fn check(&self, _: f64) -> Result<(), ControlError> {
        ensure_finite::<T>("the gain of the position", self.gains.position)?;
        ensure_finite::<T>("the gain of the velocity", self.gains.velocity)?;
        let StateObserver { phi, gamma, correction } = self.observer;
        let model = phi.into_iter().flatten().chain(gamma);
        model.into_iter().try_for_each(|x| ensure_finite::<T>("the observer's model", x))?;
        correction
            .into_iter()
            .try_for_each(|x| ensure_finite::<T>("the observer's correction", x))?;
        self.target.into_iter().try_for_each(|x| ensure_finite::<T>("the target", x))
    }

    /// The controller measures the position only.
    fn start(&self, state: &State<T, D>) -> Self::Memory {
        let target = self.target.map(T::from_f64);
        (core::array::from_fn(|i| state.q[i] - target[i]), [T::zero(); D])
    }

    #[inline(always)]
    fn command(&self, (far, speed): &mut Self::Memory, observed: &State<T, D>, _: T) -> [T; D] {
        let [kp, kd] = map([self.gains.position, self.gains.velocity], T::from_f64);
        let StateObserver { phi, gamma, correction } = self.observer;
        let phi = [map(phi[0], T::from_f64), map(phi[1], T::from_f64)];
        let (gamma, correction) = (map(gamma, T::from_f64), map(correction, T::from_f64));
        each(|i| {
            let off = observed.q[i] - T::from_f64(self.target[i]) - far[i];
            let (q, v) = (far[i] + correction[0] * off, speed[i] + correction[1] * off);
            let command = -(kp * q) - kd * v;
            far[i] = phi[0][0] * q + phi[0][1] * v + gamma[0] * command;
            speed[i] = phi[1][0] * q + phi[1][1] * v + gamma[1] * command;
            command
        })
    }
}
