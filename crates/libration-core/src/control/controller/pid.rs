//! PID control.

use super::{Controller, within};
use crate::array::{each, map};
use crate::control::ControlError;
use crate::control::error::{ensure, ensure_finite, ensure_not_negative};
use crate::{Float, State};

/// A discrete PID controller of the position, which is all that it observes: with a filter for its derivative, a
/// limit, and an integral that does not wind up at it.
///
/// K. J. Åström, R. M. Murray, *Feedback Systems*, 2nd ed., sections 11.4 and 11.5: the derivative acts on the position
/// alone and is filtered by a first-order lag (backward differences), the integral is corrected by what the limit takes
/// (back-calculation).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pid<const D: usize> {
    gains: PidGains<D>,
}

/// The parameters of a [`Pid`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PidGains<const D: usize> {
    /// `K_p`, in s⁻².
    pub proportional: f64,
    /// `K_i`, in s⁻³.
    pub integral: f64,
    /// `K_d`, in s⁻¹.
    pub derivative: f64,
    /// The time of the filter of the derivative, in seconds; 0 for none.
    pub filter: f64,
    /// The largest command in each degree of freedom; infinite for none.
    pub most: f64,
    /// In how many seconds the integral follows what the limit takes.
    pub tracking: f64,
    /// The target position.
    pub target: [f64; D],
}

impl<const D: usize> PidGains<D> {
    /// Whether `T` holds them.
    fn check<T: Float>(&self) -> Result<(), ControlError> {
        ensure_finite::<T>("the proportional gain", self.proportional)?;
        ensure_finite::<T>("the integral gain", self.integral)?;
        ensure_finite::<T>("the derivative gain", self.derivative)?;
        self.target.into_iter().try_for_each(|x| ensure_finite::<T>("the target", x))?;
        ensure_not_negative::<T>("the time of the filter", self.filter)
    }
}

impl<const D: usize> Pid<D> {
    /// A controller with these gains.
    ///
    /// # Errors
    /// [`ControlError`] if a gain or the target is not finite, the filter is negative, or limit or tracking time are not above
    /// zero.
    pub fn new(gains: PidGains<D>) -> Result<Self, ControlError> {
        gains.check::<f64>()?;
        let positive = |x: f64| x > 0.0;
        ensure("the largest command", gains.most, "above 0", positive)?;
        ensure("the tracking time", gains.tracking, "above 0", positive)?;
        Ok(Pid { gains })
    }

    /// Its gains.
    pub fn gains(&self) -> &PidGains<D> {
        &self.gains
    }
}

impl<T: Float, const D: usize> Controller<T, D> for Pid<D> {
    /// The integral term, the last position, the filtered derivative term.
    type Memory = ([T; D], ([T; D], [T; D]));

    /// At the limit what it takes away decays by `1 − h/tracking` a sample: below half a sample that grows.
    fn check(&self, period: f64) -> Result<(), ControlError> {
        let gains = self.gains;
        gains.check::<T>()?;
        let follows = |tracking: f64| T::from_f64(1.0 / tracking).is_finite();
        let allowed = "long enough for the float type";
        ensure("the tracking time", gains.tracking, allowed, follows)?;
        let decays = |tracking: f64| gains.most.is_infinite() || 2.0 * tracking > period;
        let allowed = "more than half the sample time";
        ensure("the tracking time", gains.tracking, allowed, decays)
    }

    fn start(&self, state: &State<T, D>) -> Self::Memory {
        ([T::zero(); D], (state.q, [T::zero(); D]))
    }

    #[inline(always)]
    fn command(
        &self,
        (sum, (last, slope)): &mut Self::Memory,
        observed: &State<T, D>,
        period: T,
    ) -> [T; D] {
        let PidGains { proportional, integral, derivative, filter, most, tracking, target } =
            self.gains;
        let [kp, ki, kd, filter] = map([proportional, integral, derivative, filter], T::from_f64);
        let whole = (filter + period).recip();
        let follows = period * T::from_f64(1.0 / tracking);
        let wanted: [T; D] = each(|i| {
            let error = T::from_f64(target[i]) - observed.q[i];
            // (filter·D + K_d·(y' − y))/(filter + h), with the sign of a derivative of the position.
            slope[i] = (filter * slope[i] - kd * (observed.q[i] - last[i])) * whole;
            last[i] = observed.q[i];
            kp * error + sum[i] + slope[i]
        });
        each(|i| {
            let error = T::from_f64(target[i]) - observed.q[i];
            let command = within(wanted[i], T::from_f64(most));
            sum[i] = sum[i] + ki * period * error + follows * (command - wanted[i]);
            command
        })
    }
}
