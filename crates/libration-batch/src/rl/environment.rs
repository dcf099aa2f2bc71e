//! The definition of an environment.

use core::marker::PhantomData;

use libration_core::control::Clock;
use libration_core::control::clock::Fixed;
use libration_core::{Float, Integrator, System};

use super::sensor::Exact;
use super::variation::NoVariation;
use super::{Delays, ErrorScale, Sensor, Start, Task, Variation};
use crate::ensemble::Assign;

/// An environment: a system, an integrator, a task, a start, a time limit and imperfections.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Environment<Sys, A, M, K, S, C = Fixed, N = Exact, V = NoVariation> {
    /// The system of every environment: [`All`](crate::ensemble::All) or [`PerTrajectory`](crate::ensemble::PerTrajectory).
    pub systems: A,
    /// The integrator.
    pub method: M,
    /// Its step, in seconds.
    pub dt: f64,
    /// Steps of the integrator for which an action is held; at least 1.
    pub substeps: u32,
    /// Observation, reward and termination.
    pub task: K,
    /// The distribution of initial states.
    pub start: S,
    /// The time limit: the number of actions after which an episode is truncated.
    pub limit: Option<u32>,
    /// The reset after the end of an episode.
    pub autoreset: Autoreset,
    /// The clock: lengths of the steps of the integrator.
    pub clock: C,
    /// The latencies of observations and actions.
    pub delays: Delays,
    /// The largest command in each degree of freedom, of either sign; the reward uses the saturated command. Infinite for no
    /// limit.
    pub saturation: f64,
    /// The mass in kg if actions are forces: the acceleration is `command/mass`. 1 if actions are accelerations.
    pub mass: f64,
    /// The sensor.
    pub sensor: N,
    /// The domain randomisation: parameters drawn for every episode.
    pub variation: V,
    /// The error scales of the clock and of the sensor, drawn for every episode.
    pub error_scale: ErrorScale,
    pub(super) system: PhantomData<Sys>,
}

/// The reset after the end of an episode.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Autoreset {
    /// The next episode begins in the same step: the next observation is that of its start.
    #[default]
    SameStep,
    /// The next step ignores its action, repeats the final observation, has reward 0 and leads to the start of the next
    /// episode.
    NextStep,
    /// No reset: the environment stands still with reward 0 and the flags of its end until a
    /// [reset](super::Environments::reset). Delayed observations still arrive.
    Disabled,
}

impl<Sys, A, M, K, S> Environment<Sys, A, M, K, S> {
    /// An ideal environment without a time limit, whose actions are held for one step of `dt` seconds.
    pub fn new(systems: A, method: M, dt: f64, task: K, start: S) -> Self
    where
        A: Assign<Sys>,
    {
        Environment {
            systems,
            method,
            dt,
            substeps: 1,
            task,
            start,
            limit: None,
            autoreset: Autoreset::SameStep,
            clock: Fixed,
            delays: Delays::default(),
            saturation: f64::INFINITY,
            mass: 1.0,
            sensor: Exact,
            variation: NoVariation,
            error_scale: ErrorScale::default(),
            system: PhantomData,
        }
    }
}

impl<Sys, A, M, K, S, C, N, V> Environment<Sys, A, M, K, S, C, N, V> {
    /// Sets the number of integrator steps per action.
    pub fn substeps(self, substeps: u32) -> Self {
        Environment { substeps, ..self }
    }

    /// Sets the time limit in actions.
    pub fn limit(self, limit: u32) -> Self {
        Environment { limit: Some(limit), ..self }
    }

    /// Sets the autoreset mode.
    pub fn autoreset(self, autoreset: Autoreset) -> Self {
        Environment { autoreset, ..self }
    }

    /// Sets the latencies.
    pub fn delays(self, delays: Delays) -> Self {
        Environment { delays, ..self }
    }

    /// Sets the largest command.
    pub fn saturation(self, saturation: f64) -> Self {
        Environment { saturation, ..self }
    }

    /// Sets the mass in kg, so that actions are forces. Tasks and the saturation refer to the force.
    pub fn mass(self, mass: f64) -> Self {
        Environment { mass, ..self }
    }

    /// Sets the error scales of the clock and of the sensor.
    pub fn error_scale(self, error_scale: ErrorScale) -> Self {
        Environment { error_scale, ..self }
    }

    /// Sets the clock.
    pub fn clock<Other>(self, clock: Other) -> Environment<Sys, A, M, K, S, Other, N, V> {
        self.with(|_, sensor, variation| (clock, sensor, variation))
    }

    /// Sets the sensor.
    pub fn sensor<Other>(self, sensor: Other) -> Environment<Sys, A, M, K, S, C, Other, V> {
        self.with(|clock, _, variation| (clock, sensor, variation))
    }

    /// Sets the domain randomisation.
    pub fn variation<Other>(self, variation: Other) -> Environment<Sys, A, M, K, S, C, N, Other> {
        self.with(|clock, sensor, _| (clock, sensor, variation))
    }

    /// Replaces clock, sensor and variation by values of other types.
    fn with<C2, N2, V2>(
        self,
        change: impl FnOnce(C, N, V) -> (C2, N2, V2),
    ) -> Environment<Sys, A, M, K, S, C2, N2, V2> {
        let Environment { systems, method, dt, substeps, task, start, limit, .. } = self;
        let Environment {
            autoreset, clock, delays, sensor, variation, error_scale, system, ..
        } = self;
        let (saturation, mass) = (self.saturation, self.mass);
        let (clock, sensor, variation) = change(clock, sensor, variation);
        Environment {
            systems,
            method,
            dt,
            substeps,
            task,
            start,
            limit,
            autoreset,
            clock,
            delays,
            saturation,
            mass,
            sensor,
            variation,
            error_scale,
            system,
        }
    }
}

/// An [`Environment`] of compatible types, with `O` observed numbers and `D` degrees of freedom: a short name for all its
/// types.
pub trait World<T: Float, const O: usize, const D: usize>: Copy + Send + Sync {
    /// The system.
    type System: System<T, D> + Copy + Send + Sync;
    /// The systems of all environments.
    type Systems: Assign<Self::System>;
    /// The integrator.
    type Method: Integrator;
    /// The task.
    type Task: Task<T, D, O>;
    /// The start.
    type Start: Start<T, D>;
    /// The clock.
    type Clock: Clock<T>;
    /// The sensor.
    type Sensor: Sensor<T, O>;
    /// The variation.
    type Variation: Variation<T, Self::System, Self::Task>;

    /// The environment.
    fn parts(&self) -> &Parts<T, Self, O, D>;
}

/// The environment of a [`World`].
pub type Parts<T, E, const O: usize, const D: usize> = Environment<
    <E as World<T, O, D>>::System,
    <E as World<T, O, D>>::Systems,
    <E as World<T, O, D>>::Method,
    <E as World<T, O, D>>::Task,
    <E as World<T, O, D>>::Start,
    <E as World<T, O, D>>::Clock,
    <E as World<T, O, D>>::Sensor,
    <E as World<T, O, D>>::Variation,
>;

impl<T, Sys, A, M, K, S, C, N, V, const O: usize, const D: usize> World<T, O, D>
    for Environment<Sys, A, M, K, S, C, N, V>
where
    T: Float,
    Sys: System<T, D> + Copy + Send + Sync,
    A: Assign<Sys>,
    M: Integrator,
    K: Task<T, D, O>,
    S: Start<T, D>,
    C: Clock<T>,
    N: Sensor<T, O>,
    V: Variation<T, Sys, K>,
{
    type System = Sys;
    type Systems = A;
    type Method = M;
    type Task = K;
    type Start = S;
    type Clock = C;
    type Sensor = N;
    type Variation = V;

    fn parts(&self) -> &Self {
        self
    }
}
