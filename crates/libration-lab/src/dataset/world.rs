//! From settings to environments: float type and task are chosen here, outside every loop.

use bytemuck::Pod;
use libration::control::clock::{Gaussian, Jittered, Skewed};
use libration::ensemble::{All, Execution};
use libration::rl::sensor::Noisy;
use libration::rl::start::Between;
use libration::rl::{self, Environment, EnvironmentError, Environments, World};
use libration::{Float, Method, State};
use libration_data::Values;

use super::actor::Actor;
use super::plant::Plant;
use super::settings::{Dataset, Task};
use crate::trajectory::FloatType;

/// A float type of data sets.
pub(super) trait Number: Float + Pod {
    /// Its name in NumPy.
    const NUMPY: &str;

    /// A column of them.
    fn column(values: Vec<Self>) -> Values<'static>;

    /// A column of what lies elsewhere.
    fn view(values: &[Self]) -> Values<'_>;
}

impl Number for f32 {
    const NUMPY: &str = "<f4";

    fn column(values: Vec<f32>) -> Values<'static> {
        Values::F32(values.into())
    }

    fn view(values: &[f32]) -> Values<'_> {
        Values::F32(values.into())
    }
}

impl Number for f64 {
    const NUMPY: &str = "<f8";

    fn column(values: Vec<f64>) -> Values<'static> {
        Values::F64(values.into())
    }

    fn view(values: &[f64]) -> Values<'_> {
        Values::F64(values.into())
    }
}

/// What is to be done with the environments of a group.
pub(super) trait Visit {
    /// What comes of it.
    type Output;

    /// Does it.
    fn visit<T: Number, E: World<T, O, 1>, const O: usize>(
        self,
        all: Environments<T, E, O, 1>,
        actor: Actor<O>,
    ) -> Self::Output;
}

/// Neighbouring environments of a data set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Group {
    /// Which one.
    pub(super) number: usize,
    /// The number of its first environment.
    pub(super) first: usize,
    /// How many they are.
    pub(super) len: usize,
}

impl Dataset {
    /// A group of environments.
    pub(super) fn group(&self, number: usize) -> Group {
        let first = number * self.chunk.environments;
        Group { number, first, len: (self.environments - first).min(self.chunk.environments) }
    }

    /// Makes a group's environments, at their start, and does something with them.
    ///
    /// # Errors
    /// If the settings cannot be.
    pub(super) fn with<V: Visit>(
        &self,
        group: Group,
        execution: &Execution,
        visit: V,
    ) -> Result<V::Output, EnvironmentError> {
        match self.float {
            FloatType::F64 => self.on::<f64, V>(group, execution, visit),
            _ => self.on::<f32, V>(group, execution, visit),
        }
    }

    fn on<T: Number, V: Visit>(
        &self,
        group: Group,
        execution: &Execution,
        visit: V,
    ) -> Result<V::Output, EnvironmentError> {
        match self.task {
            Task::Regulate(task) => self.made::<T, _, V, 2>(task, group, execution, visit),
            Task::SwingUp(task) => self.made::<T, _, V, 3>(task, group, execution, visit),
            Task::Track(task) => self.made::<T, _, V, 4>(task, group, execution, visit),
        }
    }

    fn made<T: Number, K: rl::Task<T, 1, O>, V: Visit, const O: usize>(
        &self,
        task: K,
        group: Group,
        execution: &Execution,
        visit: V,
    ) -> Result<V::Output, EnvironmentError> {
        let [q, v] = self.start;
        let start = Between(State { q: [q[0]], v: [v[0]] }, State { q: [q[1]], v: [v[1]] });
        let Some(plant) = Plant::<T>::new(self.system) else {
            unreachable!("a system of several degrees of freedom is refused with the settings");
        };
        let method: Method = self.method;
        let mut world = Environment::new(All(plant), method, self.dt, task, start)
            .substeps(self.substeps)
            .delays(self.delays);
        world.limit = self.limit;
        let actor = Actor::new(&self.policy);
        let Group { first, len, .. } = group;
        if self.noise.is_none() {
            let all = Environments::shard(world, first, len, self.seed, execution.clone())?;
            return Ok(visit.visit(all, actor));
        }
        let clock = (Skewed(self.noise.skewed()), Jittered(Gaussian(self.noise.jitter)));
        let noisy = Noisy([Gaussian(self.noise.observation); O]);
        let world = world.clock(clock).sensor(noisy);
        let all = Environments::shard(world, first, len, self.seed, execution.clone())?;
        Ok(visit.visit(all, actor))
    }
}
