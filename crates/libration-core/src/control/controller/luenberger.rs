//! Feedback of an estimated state.

use super::Controller;
use crate::array::{each, map};
use crate::control::error::ensure_finite;
use crate::control::{ControlError, Feedback, StateObserver};
use crate::{Float, State};

/// `u = −K_p·(q̂ − r) − K_d·v̂`, where a Luenberger observer estimates the state from the measured position; the same in each
/// degree of freedom.
///
/// It is the current observer of G. F. Franklin, J. D. Powell, M. L. Workman, *Digital Control of Dynamic Systems*, 3rd ed., section
/// 8.2.4: the measurement corrects the prediction before the command is computed, and the step of the model predicts the next state.
/// It does not model latencies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Luenberger<const D: usize> {
    /// The gains of the feedback.
    pub gains: Feedback,
    /// The model and its correction gains.
    pub observer: StateObserver,
    /// `r`, the target position, about which the model is linearised.
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
