//! Tasks: observation, reward and termination.

use libration_core::array::{each, map};
use libration_core::control::ControlError;
use libration_core::control::error::{ensure, ensure_finite};
use libration_core::{Elementary, Float, State};

/// A task on a system with `D` degrees of freedom and `O` observed numbers. Its functions do not branch on data and are
/// `#[inline(always)]`; otherwise the loops over environments are not vectorised.
///
/// `time` is that since the episode began, in seconds, as an ideal clock counts it.
pub trait Task<T: Float, const D: usize, const O: usize>: Copy + Send + Sync {
    /// Whether the task depends on time. If not, `time` is 0.
    const TIMED: bool = false;

    /// Checks the parameters.
    ///
    /// # Errors
    /// The first invalid parameter.
    fn check(&self) -> Result<(), ControlError> {
        Ok(())
    }

    /// The observation of a state.
    fn observe(&self, time: T, state: &State<T, D>) -> [T; O];

    /// The reward of a step from `before` to `after` under `action`.
    fn reward(&self, time: T, before: &State<T, D>, action: &[T; D], after: &State<T, D>) -> T;

    /// Whether the episode terminates in this state. A state that is not finite terminates it in any case.
    fn terminated(&self, time: T, after: &State<T, D>) -> bool;
}

/// Regulation to the origin: the reward is `−(p·q² + r·v² + e·u²)`; the episode terminates beyond a distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Regulate {
    /// `p`, the weight of `q²`.
    pub position: f64,
    /// `r`, the weight of `v²`.
    pub velocity: f64,
    /// `e`, the weight of `u²`.
    pub effort: f64,
    /// The distance from the origin, in each degree of freedom, beyond which the episode terminates; infinite for none.
    pub bound: f64,
}

/// The sum of `D` terms, at least one.
#[inline(always)]
fn sum<T: Float, const D: usize>(term: impl Fn(usize) -> T) -> T {
    let mut all = term(0);
    for i in 1..D {
        all = all + term(i);
    }
    all
}

macro_rules! regulate {
    ($d:literal, $o:literal) => {
        impl<T: Float> Task<T, $d, $o> for Regulate {
            fn check(&self) -> Result<(), ControlError> {
                ensure_finite::<T>("price of a distance", self.position)?;
                ensure_finite::<T>("price of a velocity", self.velocity)?;
                ensure_finite::<T>("price of an effort", self.effort)?;
                ensure("bound", self.bound, "above 0", |bound| T::from_f64(bound) > T::zero())
            }

            #[inline(always)]
            fn observe(&self, _: T, state: &State<T, $d>) -> [T; $o] {
                each(|i| if i < $d { state.q[i] } else { state.v[i - $d] })
            }

            #[inline(always)]
            fn reward(&self, _: T, _: &State<T, $d>, action: &[T; $d], after: &State<T, $d>) -> T {
                let [position, velocity, effort] =
                    map([self.position, self.velocity, self.effort], T::from_f64);
                let cost = |i: usize| {
                    let (q, v, u) = (after.q[i], after.v[i], action[i]);
                    position * (q * q) + velocity * (v * v) + effort * (u * u)
                };
                -sum::<T, $d>(cost)
            }

            #[inline(always)]
            fn terminated(&self, _: T, after: &State<T, $d>) -> bool {
                let bound = T::from_f64(self.bound);
                let mut beyond = false;
                for i in 0..$d {
                    beyond |= (after.q[i] > bound) | (after.q[i] < -bound);
                }
                beyond
            }
        }
    };
}

regulate!(1, 2);
regulate!(2, 4);

/// Swing-up of a pendulum that hangs at `q = 0`. The observation is the cosine and the sine of its angle and its velocity; the
/// reward is `cos q − 1 − r·v² − e·u²` with the angle from the top and the velocity before the step, as in Gymnasium's `Pendulum`.
/// Episodes do not terminate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SwingUp {
    /// `r`, the weight of `v²`.
    pub velocity: f64,
    /// `e`, the weight of `u²`.
    pub effort: f64,
}

impl<T: Float + Elementary> Task<T, 1, 3> for SwingUp {
    fn check(&self) -> Result<(), ControlError> {
        ensure_finite::<T>("price of a velocity", self.velocity)?;
        ensure_finite::<T>("price of an effort", self.effort)
    }

    #[inline(always)]
    fn observe(&self, _: T, &State { q: [q], v: [v] }: &State<T, 1>) -> [T; 3] {
        [-Elementary::cos(q), -Elementary::sin(q), v]
    }

    #[inline(always)]
    fn reward(&self, _: T, before: &State<T, 1>, &[u]: &[T; 1], _: &State<T, 1>) -> T {
        let (velocity, effort) = (T::from_f64(self.velocity), T::from_f64(self.effort));
        let v = before.v[0];
        -Elementary::cos(before.q[0]) - T::one() - velocity * (v * v) - effort * (u * u)
    }

    #[inline(always)]
    fn terminated(&self, _: T, _: &State<T, 1>) -> bool {
        false
    }
}

/// A reference trajectory.
pub trait Reference<T: Float>: Copy + Send + Sync {
    /// Checks the parameters.
    ///
    /// # Errors
    /// The first invalid parameter.
    fn check(&self) -> Result<(), ControlError> {
        Ok(())
    }

    /// The position and the velocity at `time`.
    fn at(&self, time: T) -> [T; 2];
}

/// `A·sin(ω·t + φ)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sine {
    /// `A`.
    pub amplitude: f64,
    /// `ω`, in radians a second.
    pub angular_frequency: f64,
    /// `φ`, in radians.
    pub phase: f64,
}

impl<T: Float + Elementary> Reference<T> for Sine {
    fn check(&self) -> Result<(), ControlError> {
        ensure_finite::<T>("amplitude of the reference", self.amplitude)?;
        ensure_finite::<T>("angular frequency of the reference", self.angular_frequency)?;
        ensure_finite::<T>("phase of the reference", self.phase)
    }

    #[inline(always)]
    fn at(&self, time: T) -> [T; 2] {
        let Sine { amplitude, angular_frequency, phase } = *self;
        let speed = amplitude * angular_frequency;
        let [amplitude, omega, phase, speed] =
            map([amplitude, angular_frequency, phase, speed], T::from_f64);
        let angle = omega * time + phase;
        [amplitude * Elementary::sin(angle), speed * Elementary::cos(angle)]
    }
}

/// Tracking of a reference: the observation is position and velocity, and those of the reference; the reward is
/// `−(p·(q − q₀)² + r·(v − v₀)² + e·u²)`, and the episode terminates beyond a distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Track<R> {
    /// The reference, observed without delay; a [`Sensor`](super::Sensor) measures it like all observations.
    pub reference: R,
    /// The weights of the deviations, and the distance beyond which the episode terminates.
    pub regulate: Regulate,
}

impl<R> Track<R> {
    /// The state relative to the reference.
    #[inline(always)]
    fn relative_state<T: Float>(&self, time: T, state: &State<T, 1>) -> State<T, 1>
    where
        R: Reference<T>,
    {
        let [q, v] = self.reference.at(time);
        State { q: [state.q[0] - q], v: [state.v[0] - v] }
    }
}

impl<T: Float, R: Reference<T>> Task<T, 1, 4> for Track<R> {
    const TIMED: bool = true;

    fn check(&self) -> Result<(), ControlError> {
        self.reference.check()?;
        Task::<T, 1, 2>::check(&self.regulate)
    }

    #[inline(always)]
    fn observe(&self, time: T, state: &State<T, 1>) -> [T; 4] {
        let [q, v] = self.reference.at(time);
        [state.q[0], state.v[0], q, v]
    }

    #[inline(always)]
    fn reward(&self, time: T, before: &State<T, 1>, action: &[T; 1], after: &State<T, 1>) -> T {
        // Only where it came to is paid for.
        self.regulate.reward(time, before, action, &self.relative_state(time, after))
    }

    #[inline(always)]
    fn terminated(&self, time: T, after: &State<T, 1>) -> bool {
        self.regulate.terminated(time, &self.relative_state(time, after))
    }
}
