//! What an environment is made of.

use core::marker::PhantomData;

use libration_core::control::Clock;
use libration_core::control::clock::Fixed;
use libration_core::{Float, Integrator, System};

use super::sensor::Exact;
use super::variation::NoVariation;
use super::{Delays, ErrorScale, Sensor, Start, Task, Variation};
use crate::ensemble::Assign;

/// A system with its integrator, a task, a start and a time limit, and what is not ideal about it.
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
    /// What is seen, paid, and over.
    pub task: K,
    /// Where episodes begin.
    pub start: S,
    /// Actions after which an episode is cut off, if it is.
    pub limit: Option<u32>,
    /// What follows the end of an episode.
    pub autoreset: Autoreset,
    /// How long steps of the integrator are.
    pub clock: C,
    /// How late observations and actions are.
    pub delays: Delays,
    /// The largest command in each degree of freedom, of either sign: whoever asks for more gets, and pays for, that much. Infinite for
    /// none.
    pub saturation: f64,
    /// What a command moves, in kg: actions are forces, and the system gets `command/mass`. 1 where actions are accelerations.
    pub mass: f64,
    /// How observations are measured.
    pub sensor: N,
    /// What is different in every episode.
    pub variation: V,
    /// And how bad the clock and the sensor are in it.
    pub error_scale: ErrorScale,
    pub(super) system: PhantomData<Sys>,
}

/// What follows the end of an episode.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Autoreset {
    /// The next episode begins in the same step: what is seen next is its start.
    #[default]
    SameStep,
    /// What is seen next is what was seen last, and the action upon it is ignored: that step pays nothing, ends nothing, and
    /// leads to the start of the next episode.
    NextStep,
    /// Nothing: the environment stands still (what is seen late still arrives), pays nothing and tells how it ended, until it is
    /// [reset](super::Environments::reset).
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
    /// This, with actions that are held for so many steps of the integrator.
    pub fn substeps(self, substeps: u32) -> Self {
        Environment { substeps, ..self }
    }

    /// This, with episodes that are cut off after so many actions.
    pub fn limit(self, limit: u32) -> Self {
        Environment { limit: Some(limit), ..self }
    }

    /// This, with another way to go on after an episode.
    pub fn autoreset(self, autoreset: Autoreset) -> Self {
        Environment { autoreset, ..self }
    }

    /// This, with delays.
    pub fn delays(self, delays: Delays) -> Self {
        Environment { delays, ..self }
    }

    /// This, with commands of at most so much.
    pub fn saturation(self, saturation: f64) -> Self {
        Environment { saturation, ..self }
    }

    /// This, with actions that are forces on `mass`, in kg. Tasks see, and limits hold for, the force.
    pub fn mass(self, mass: f64) -> Self {
        Environment { mass, ..self }
    }

    /// This, with clocks and sensors that are more or less wrong from episode to episode.
    pub fn error_scale(self, error_scale: ErrorScale) -> Self {
        Environment { error_scale, ..self }
    }

    /// This, with steps of another clock.
    pub fn clock<Other>(self, clock: Other) -> Environment<Sys, A, M, K, S, Other, N, V> {
        self.with(|_, sensor, variation| (clock, sensor, variation))
    }

    /// This, with observations that are measured so.
    pub fn sensor<Other>(self, sensor: Other) -> Environment<Sys, A, M, K, S, C, Other, V> {
        self.with(|clock, _, variation| (clock, sensor, variation))
    }

    /// This, with episodes that differ in more than their start.
    pub fn variation<Other>(self, variation: Other) -> Environment<Sys, A, M, K, S, C, N, Other> {
        self.with(|clock, sensor, _| (clock, sensor, variation))
    }

    /// This, with other parts of other types.
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

/// An [`Environment`] whose parts fit each other, with `O` numbers to be seen and `D` degrees of freedom: a name for all its
/// types.
pub trait World<T: Float, const O: usize, const D: usize>: Copy + Send + Sync {
    /// Of the system.
    type System: System<T, D> + Copy + Send + Sync;
    /// Of the systems of all environments.
    type Systems: Assign<Self::System>;
    /// Of the integrator.
    type Method: Integrator;
    /// Of the task.
    type Task: Task<T, D, O>;
    /// Of the start.
    type Start: Start<T, D>;
    /// Of the clock.
    type Clock: Clock<T>;
    /// Of the sensor.
    type Sensor: Sensor<T, O>;
    /// Of the variation.
    type Variation: Variation<T, Self::System, Self::Task>;

    /// The environment.
    fn parts(&self) -> &Parts<T, Self, O, D>;
}

/// The environment that a world is.
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
