//! From a recipe to environments: float type and task are chosen here, outside every loop.

use bytemuck::Pod;
use libration::control::clock::{Jittered, Skewed};
use libration::ensemble::{All, Execution};
use libration::rl::sensor::Noisy;
use libration::rl::start::Between;
use libration::rl::{self, Environment, EnvironmentError, Environments};
use libration::{Elementary, Float, State};

use super::plant::Plant;
use super::{Batch, Recipe, Task};

/// What is to be done with environments, however many numbers they show.
pub trait Visit<T> {
    /// What comes of it.
    type Output;

    /// Does it.
    fn visit<const O: usize>(self, all: Box<dyn Batch<T, O>>) -> Self::Output;
}

impl Recipe {
    /// Makes `len` environments from number `first` on, at their start, and does something with them.
    ///
    /// # Errors
    /// If what the recipe says cannot be.
    pub fn with<T: Float + Elementary + Pod, V: Visit<T>>(
        &self,
        [first, len]: [usize; 2],
        seed: u64,
        execution: &Execution,
        visit: V,
    ) -> Result<V::Output, EnvironmentError> {
        let which = ([first, len], seed, execution);
        Ok(match self.task {
            Task::Regulate(task) => visit.visit(self.made::<T, _, 2>(task, which)?),
            Task::SwingUp(task) => visit.visit(self.made::<T, _, 3>(task, which)?),
            Task::Track(task) => visit.visit(self.made::<T, _, 4>(task, which)?),
        })
    }

    fn made<T: Float + Elementary + Pod, K: rl::Task<T, 1, O> + 'static, const O: usize>(
        &self,
        task: K,
        ([first, len], seed, execution): ([usize; 2], u64, &Execution),
    ) -> Result<Box<dyn Batch<T, O>>, EnvironmentError> {
        let [q, v] = self.start;
        let start = Between(State { q: [q[0]], v: [v[0]] }, State { q: [q[1]], v: [v[1]] });
        let plant = Plant::<T>::new(self.system);
        let mut world = Environment::new(All(plant), self.method, self.dt, task, start)
            .substeps(self.substeps)
            .autoreset(self.autoreset)
            .delays(self.delays)
            .saturation(self.saturation);
        world.limit = self.limit;
        if self.noise.is_none() {
            return Ok(Box::new(Environments::shard(world, first, len, seed, execution.clone())?));
        }
        let clock = (Skewed(self.noise.skew), Jittered(self.noise.jitter));
        let world = world.clock(clock).sensor(Noisy([self.noise.observation; O]));
        Ok(Box::new(Environments::shard(world, first, len, seed, execution.clone())?))
    }
}
