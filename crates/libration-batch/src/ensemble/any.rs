//! Ensembles of built-in systems, for callers that choose them at run time.

use core::fmt::Debug;

use bytemuck::Pod;
use libration_core::system::Oscillator;
use libration_core::{AnySystem, Float, Hamiltonian, Method, Model, State, System, with_method};

use super::{All, Ensemble, EnsembleError, Execution, InsufficientMemory};

/// An ensemble of a built-in system in some number of dimensions.
///
/// All kernels of the catalogue are compiled behind this trait, once: callers that go through it
/// compile none of their own.
pub trait AnyEnsemble<T>: Debug + Send {
    /// Number of trajectories.
    fn len(&self) -> usize;

    /// Whether there are none.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Degrees of freedom.
    fn dimension(&self) -> usize;

    /// Number of steps taken.
    fn step(&self) -> u64;

    /// Takes `steps` steps of `dt` seconds with every trajectory.
    fn advance(&mut self, method: Method, dt: T, steps: u64);

    /// Goes on elsewhere, which changes no result.
    fn execute(&mut self, execution: Execution);

    /// Position `i` of every trajectory, if there is one.
    fn q(&self, i: usize) -> Option<&[T]>;

    /// Velocity `i` of every trajectory, if there is one.
    fn v(&self, i: usize) -> Option<&[T]>;

    /// The energy of trajectory `n` per unit mass, in J/kg, if there is one.
    fn energy(&self, n: usize) -> Option<T>;

    /// The trajectories with a coordinate that is infinite or not a number, in order.
    fn not_finite(&self) -> Vec<usize>;
}

/// A float type whose ensembles are compiled here: `f32` and `f64`.
pub trait BatchFloat: Float + Pod {
    /// Bytes that `len` trajectories in `dimension` degrees of freedom take.
    fn ensemble_bytes(dimension: usize, len: usize) -> u128 {
        dimension as u128 * Ensemble::<Self, 1>::bytes(len)
    }

    /// `len` trajectories of `system`; the start of trajectory `n` is what `start(n, i)` says of its
    /// coordinates `q₀ … q_{D−1}, v₀ … v_{D−1}`.
    ///
    /// # Errors
    /// [`EnsembleError::System`] if the system does not exist in that dimension;
    /// [`EnsembleError::Memory`].
    fn ensemble(
        system: AnySystem,
        dimension: usize,
        len: usize,
        execution: Execution,
        start: &(dyn Fn(usize, usize) -> Self + Sync),
    ) -> Result<Box<dyn AnyEnsemble<Self>>, EnsembleError>;
}

/// The trajectories of a system that is known when this is compiled.
#[derive(Debug)]
struct Typed<T, Sys, const D: usize> {
    system: Sys,
    trajectories: Ensemble<T, D>,
}

/// An isotropic oscillator in several dimensions, integrated as independent one-dimensional
/// oscillators. Coordinate `i` of trajectory `n` of `N` is number `iN + n`.
#[derive(Debug)]
struct Isotropic<T> {
    system: Oscillator<T>,
    dimension: usize,
    coordinates: Ensemble<T, 1>,
}

macro_rules! batch_float {
    ($float:ident) => {
        impl BatchFloat for $float {
            fn ensemble(
                system: AnySystem,
                dimension: usize,
                len: usize,
                execution: Execution,
                start: &(dyn Fn(usize, usize) -> Self + Sync),
            ) -> Result<Box<dyn AnyEnsemble<Self>>, EnsembleError> {
                if !system.entry().dimensions.contains(&dimension) {
                    return Err(EnsembleError::System(system.entry().wrong_dimension(dimension)));
                }
                Ok(match system {
                    AnySystem::Oscillator(model) => {
                        let coordinate = |number: usize| {
                            let (i, n) = (number / len, number % len);
                            State { q: [start(n, i)], v: [start(n, dimension + i)] }
                        };
                        let needed = Self::ensemble_bytes(dimension, len);
                        let all = len.checked_mul(dimension);
                        let all = all.ok_or(InsufficientMemory { needed, available: None })?;
                        let coordinates = Ensemble::from_fn(all, execution, coordinate)?;
                        let system = Model::<1>::on::<$float>(&model);
                        Box::new(Isotropic { system, dimension, coordinates })
                    }
                    AnySystem::DampedOscillator(m) => {
                        typed::<$float, _, 1>(m, len, execution, start)?
                    }
                    AnySystem::DrivenOscillator(m) => {
                        typed::<$float, _, 2>(m, len, execution, start)?
                    }
                    AnySystem::Pendulum(m) => typed::<$float, _, 1>(m, len, execution, start)?,
                    AnySystem::Duffing(m) => typed::<$float, _, 1>(m, len, execution, start)?,
                    AnySystem::Kepler(m) => typed::<$float, _, 2>(m, len, execution, start)?,
                    AnySystem::HenonHeiles(m) => typed::<$float, _, 2>(m, len, execution, start)?,
                })
            }
        }
    };
}

batch_float!(f32);
batch_float!(f64);

/// An ensemble of `model` behind its trait.
fn typed<T: Float + Pod + Debug, M: Model<D>, const D: usize>(
    model: M,
    len: usize,
    execution: Execution,
    start: &(dyn Fn(usize, usize) -> T + Sync),
) -> Result<Box<dyn AnyEnsemble<T>>, EnsembleError>
where
    M::On<T>: Send + Sync + Debug + 'static,
{
    let state = |n| State {
        q: core::array::from_fn(|i| start(n, i)),
        v: core::array::from_fn(|i| start(n, D + i)),
    };
    let trajectories = Ensemble::from_fn(len, execution, state)?;
    Ok(Box::new(Typed { system: model.on::<T>(), trajectories }))
}

impl<T: Float + Pod, Sys, const D: usize> AnyEnsemble<T> for Typed<T, Sys, D>
where
    Sys: Hamiltonian<T, D> + Copy + Send + Sync + Debug,
{
    fn len(&self) -> usize {
        self.trajectories.len()
    }

    fn dimension(&self) -> usize {
        D
    }

    fn step(&self) -> u64 {
        self.trajectories.step()
    }

    fn advance(&mut self, method: Method, dt: T, steps: u64) {
        advance(&mut self.trajectories, self.system, method, dt, steps);
    }

    fn execute(&mut self, execution: Execution) {
        self.trajectories.execute(execution);
    }

    fn q(&self, i: usize) -> Option<&[T]> {
        (i < D).then(|| self.trajectories.q(i))
    }

    fn v(&self, i: usize) -> Option<&[T]> {
        (i < D).then(|| self.trajectories.v(i))
    }

    fn energy(&self, n: usize) -> Option<T> {
        Some(self.system.energy(&self.trajectories.state(n)?))
    }

    fn not_finite(&self) -> Vec<usize> {
        self.trajectories.not_finite().collect()
    }
}

impl<T: Float + Pod> AnyEnsemble<T> for Isotropic<T> {
    fn len(&self) -> usize {
        self.coordinates.len() / self.dimension
    }

    fn dimension(&self) -> usize {
        self.dimension
    }

    fn step(&self) -> u64 {
        self.coordinates.step()
    }

    fn advance(&mut self, method: Method, dt: T, steps: u64) {
        advance(&mut self.coordinates, self.system, method, dt, steps);
    }

    fn execute(&mut self, execution: Execution) {
        self.coordinates.execute(execution);
    }

    fn q(&self, i: usize) -> Option<&[T]> {
        self.coordinates.q(0).get(i * self.len()..(i + 1) * self.len())
    }

    fn v(&self, i: usize) -> Option<&[T]> {
        self.coordinates.v(0).get(i * self.len()..(i + 1) * self.len())
    }

    fn energy(&self, n: usize) -> Option<T> {
        let of = |plane: Option<&[T]>| plane?.get(n).copied();
        let q: Option<Vec<T>> = (0..self.dimension).map(|i| of(self.q(i))).collect();
        let v: Option<Vec<T>> = (0..self.dimension).map(|i| of(self.v(i))).collect();
        Some(self.system.energy_of(&q?, &v?))
    }

    fn not_finite(&self) -> Vec<usize> {
        let mut lost: Vec<usize> =
            self.coordinates.not_finite().map(|number| number % self.len()).collect();
        lost.sort_unstable();
        lost.dedup();
        lost
    }
}

/// The one place where the kernels of the catalogue are made.
fn advance<T: Float + Pod, Sys, const D: usize>(
    trajectories: &mut Ensemble<T, D>,
    system: Sys,
    method: Method,
    dt: T,
    steps: u64,
) where
    Sys: System<T, D> + Copy + Send + Sync,
{
    let outcome = with_method!(method, |m| trajectories.advance(m, All(system), All(dt), steps));
    // One value for all is never too few or too many.
    debug_assert_eq!(outcome, Ok(()));
}
