//! Checkpoints of ensembles and loops.

use bytemuck::Pod;
use libration_core::control::{Clock, Controller, Delay, Disturbance};
use libration_core::{Float, Integrator, System};

use super::{Assign, Ensemble, GRAIN, Loops};
use crate::checkpoint::{Checkpoint, CheckpointError, Reader, Trait};

impl<T: Float + Pod, const D: usize> Ensemble<T, D> {
    /// Bytes of the step and of all coordinates.
    fn state_len(&self) -> usize {
        size_of::<u64>() + 2 * D * self.len() * size_of::<T>()
    }

    fn load(&mut self, from: &mut Reader<'_>) {
        self.step = from.next();
        self.planes.planes_mut().for_each(|plane| from.fill(plane));
    }
}

impl<T: Float + Pod, const D: usize> Checkpoint for Ensemble<T, D> {
    fn traits(&self) -> Vec<Trait> {
        vec![
            ("kind", "ensemble".to_owned()),
            ("float type", T::NAME.to_owned()),
            ("number of dimensions", D.to_string()),
            ("number of trajectories", self.len().to_string()),
        ]
    }

    fn save<E>(&self, mut sink: impl FnMut(&[u8]) -> Result<(), E>) -> Result<(), E> {
        sink(bytemuck::bytes_of(&self.step))?;
        (0..2 * D).try_for_each(|i| sink(bytemuck::cast_slice(self.planes.plane_of(i))))
    }

    fn restore(&mut self, state: &[u8]) -> Result<(), CheckpointError> {
        let mut from = Reader::new(state, self.state_len())?;
        self.load(&mut from);
        Ok(())
    }
}

impl<T, Sys, A, M, K, C, L, N, const D: usize> Checkpoint for Loops<T, Sys, A, M, K, C, L, D, N>
where
    T: Float + Pod,
    A: Assign<Sys>,
    M: Integrator,
    K: Controller<T, D>,
    C: Clock<T>,
    L: Delay<T>,
    N: Disturbance,
    Sys: System<T, D> + Copy + Send + Sync,
{
    fn traits(&self) -> Vec<Trait> {
        vec![
            ("kind", "loops".to_owned()),
            ("float type", T::NAME.to_owned()),
            ("number of dimensions", D.to_string()),
            ("number of trajectories", self.len().to_string()),
            ("seed", self.seed().to_string()),
            ("time step", format!("{:?}", self.dt().to_f64())),
            ("number of what loops remember", self.memories().len().to_string()),
        ]
    }

    fn save<E>(&self, mut sink: impl FnMut(&[u8]) -> Result<(), E>) -> Result<(), E> {
        self.trajectories().save(&mut sink)?;
        // Of what lies beyond the last trajectory nobody knows what it is.
        let all = self.memories();
        let whole = self.len() / GRAIN * (all.len() / self.len().div_ceil(GRAIN).max(1));
        let (whole, part) = all.split_at(whole);
        sink(bytemuck::cast_slice(whole))?;
        let mut part = part.to_vec();
        for row in part.chunks_mut(GRAIN) {
            row[self.len() % GRAIN..].fill(T::zero());
        }
        sink(bytemuck::cast_slice(&part))
    }

    fn restore(&mut self, state: &[u8]) -> Result<(), CheckpointError> {
        let wanted = self.trajectories().state_len() + size_of_val(self.memories());
        let mut from = Reader::new(state, wanted)?;
        let (trajectories, memories) = self.state_mut();
        trajectories.load(&mut from);
        from.fill(memories);
        Ok(())
    }
}
