//! From a recipe to environments: float type and task are chosen here, outside every loop.

use bytemuck::Pod;
use libration::control::ControlError;
use libration::control::clock::{Jittered, Skewed};
use libration::ensemble::{All, Execution};
use libration::rl::sensor::Noisy;
use libration::rl::start::UniformStart;
use libration::rl::task::{Regulate, Sine, SwingUp, Track};
use libration::rl::{Environment, EnvironmentError, Environments};
use libration::{Elementary, Float, State, rl};

use super::plant::Plant;
use super::{Batch, Recipe, Task};

/// What is to be done with environments, however many numbers they show.
pub trait Visit<T> {
    /// What comes of it.
    type Output;

    /// Does it.
    fn visit<const O: usize>(self, all: Box<dyn Batch<T, O>>) -> Self::Output;
}

/// Environments of one task.
type Made<T, const O: usize> = Result<Box<dyn Batch<T, O>>, EnvironmentError>;

/// The first of them and how many, their seed, and where they are stepped.
type Which<'a> = ([usize; 2], u64, &'a Execution);

/// A float type whose environments are compiled here, so that other crates need not compile all of their kernels again.
pub trait Compiled: Float + Elementary + Pod {
    /// Environments that are to rest at the origin.
    ///
    /// # Errors
    /// If what the recipe says cannot be; so below.
    fn regulated(recipe: &Recipe, task: Regulate, which: Which<'_>) -> Made<Self, 2>;

    /// Pendulums that are to stand on their heads.
    fn swung_up(recipe: &Recipe, task: SwingUp, which: Which<'_>) -> Made<Self, 3>;

    /// Environments that are to follow a sine.
    fn tracking(recipe: &Recipe, task: Track<Sine>, which: Which<'_>) -> Made<Self, 4>;
}

macro_rules! compiled {
    ($($float:ident)*) => {$(
        // None of it is generic, so that it is compiled where it stands.
        impl Compiled for $float {
            fn regulated(recipe: &Recipe, task: Regulate, which: Which<'_>) -> Made<Self, 2> {
                recipe.made(task, which)
            }

            fn swung_up(recipe: &Recipe, task: SwingUp, which: Which<'_>) -> Made<Self, 3> {
                recipe.made(task, which)
            }

            fn tracking(recipe: &Recipe, task: Track<Sine>, which: Which<'_>) -> Made<Self, 4> {
                recipe.made(task, which)
            }
        }
    )*};
}

compiled!(f32 f64);

impl Recipe {
    /// Makes `len` environments from number `first` on, at their start, and does something with them.
    ///
    /// # Errors
    /// If what the recipe says cannot be.
    pub fn with<T: Compiled, V: Visit<T>>(
        &self,
        [first, len]: [usize; 2],
        seed: u64,
        execution: &Execution,
        visit: V,
    ) -> Result<V::Output, EnvironmentError> {
        let which = ([first, len], seed, execution);
        Ok(match self.task {
            Task::Regulate(task) => visit.visit(T::regulated(self, task, which)?),
            Task::SwingUp(task) => visit.visit(T::swung_up(self, task, which)?),
            Task::Track(task) => visit.visit(T::tracking(self, task, which)?),
        })
    }

    fn made<T: Float + Elementary + Pod, K: rl::Task<T, 1, O> + 'static, const O: usize>(
        &self,
        task: K,
        ([first, len], seed, execution): Which<'_>,
    ) -> Made<T, O> {
        for (name, value) in self.system.any().parameters() {
            if !T::from_f64(value).is_finite() {
                let allowed = "small enough for the float type";
                return Err(ControlError { name, index: None, value, allowed }.into());
            }
        }
        let [q, v] = self.start;
        let start = UniformStart(State { q: [q[0]], v: [v[0]] }, State { q: [q[1]], v: [v[1]] });
        let plant = Plant::<T>::new(self.system);
        let mut world = Environment::new(All(plant), self.method, self.dt, task, start)
            .substeps(self.substeps)
            .autoreset(self.autoreset)
            .delays(self.delays)
            .saturation(self.saturation)
            .mass(self.actuation.mass());
        world.limit = self.limit;
        if self.noise.is_none() {
            return Ok(Box::new(Environments::shard(world, first, len, seed, execution.clone())?));
        }
        let clock = (Skewed(self.noise.skew), Jittered(self.noise.jitter));
        let world = world.clock(clock).sensor(Noisy([self.noise.observation; O]));
        Ok(Box::new(Environments::shard(world, first, len, seed, execution.clone())?))
    }
}
