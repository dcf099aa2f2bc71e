//! Ensembles of oscillators by compiled kernels.

use bytemuck::Pod;
use libration_core::system::Oscillator;
use libration_core::{ImplicitMethod, Method, Model, State, with_method};

use super::any_ensemble::AnyEnsemble;
use super::planes::Planes;
use super::{All, Ensemble, EnsembleError, Execution, InsufficientMemory};
use crate::machine::MachineFloat;

/// An isotropic oscillator in several dimensions, integrated as independent one-dimensional
/// oscillators. Coordinate `i` of trajectory `n` of `N` is number `iN + n`.
#[derive(Debug)]
pub(super) struct Isotropic<T> {
    system: Oscillator<T>,
    dimension: usize,
    coordinates: Ensemble<T, 1>,
}

impl<T: MachineFloat + Pod> Isotropic<T> {
    pub(super) fn new(
        model: Oscillator<f64>,
        dimension: usize,
        len: usize,
        execution: Execution,
        start: &(dyn Fn(usize, usize) -> T + Sync),
    ) -> Result<Self, EnsembleError> {
        let coordinate = |number: usize| {
            let (i, n) = (number / len, number % len);
            State { q: [start(n, i)], v: [start(n, dimension + i)] }
        };
        let needed = Planes::<T>::bytes(2 * dimension, len);
        let all = len.checked_mul(dimension);
        let all = all.ok_or(InsufficientMemory { needed, available: None })?;
        let coordinates = Ensemble::from_fn(all, execution, coordinate)?;
        Ok(Isotropic { system: Model::<1>::on::<T>(&model), dimension, coordinates })
    }
}

impl<T: MachineFloat + Pod> AnyEnsemble<T> for Isotropic<T> {
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
        let Isotropic { system, coordinates, .. } = self;
        // The one place where kernels of an ensemble are made for all methods.
        let outcome =
            with_method!(method, |m| coordinates.advance(m, All(*system), All(dt), steps));
        // One value for all is never too few or too many.
        debug_assert_eq!(outcome, Ok(()));
    }

    fn advance_implicit(
        &mut self,
        method: ImplicitMethod,
        _: T,
        _: u64,
    ) -> Result<(), EnsembleError> {
        Err(EnsembleError::Implicit { method: method.name() })
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

    fn energies(&self) -> Option<Vec<T>> {
        let q: Vec<&[T]> = (0..self.dimension).filter_map(|i| self.q(i)).collect();
        let v: Vec<&[T]> = (0..self.dimension).filter_map(|i| self.v(i)).collect();
        let at =
            |planes: &[&[T]], n: usize| planes.iter().map(|plane| plane[n]).collect::<Vec<T>>();
        Some((0..self.len()).map(|n| self.system.energy_of(&at(&q, n), &at(&v, n))).collect())
    }

    fn not_finite(&self) -> Vec<usize> {
        let mut lost: Vec<usize> =
            self.coordinates.not_finite().map(|number| number % self.len()).collect();
        lost.sort_unstable();
        lost.dedup();
        lost
    }
}
