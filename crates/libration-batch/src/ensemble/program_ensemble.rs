//! Ensembles of systems that are known when the program runs.

use std::sync::Arc;

use libration_core::AnyMethod;
use libration_equations::{Dynamics, Program};

use super::planes::Planes;
use super::{BatchFloat, EnsembleError, Execution, GRAIN, MOVED};
use crate::machine::{Block, BlockProgram, MachineStep};

/// Trajectories of a system by its program, as structure of arrays.
///
/// The block machine steps them. A trajectory has the bits of the program of a step, run alone, and those of a compiled system with
/// the same operations.
#[derive(Debug)]
pub(super) struct ProgramEnsemble<T> {
    dynamics: Dynamics,
    planes: Planes<T>,
    step: u64,
    execution: Execution,
    /// The steps that were used last, with and without [a carried acceleration](MachineStep::first).
    steps: [Option<(AnyMethod, Arc<MachineStep>)>; 2],
}

impl<T: BatchFloat> ProgramEnsemble<T> {
    /// `len` trajectories whose inputs are zero; the start of trajectory `n` is what `start(n, i)` says of its coordinates
    /// `q₀ … q_{D−1}, v₀ … v_{D−1}`.
    ///
    /// # Errors
    /// [`EnsembleError::Memory`].
    pub(super) fn new(
        dynamics: Dynamics,
        len: usize,
        execution: Execution,
        start: impl Fn(usize, usize) -> T + Sync,
    ) -> Result<Self, EnsembleError> {
        let mut planes = Planes::new(2 * dynamics.degrees(), len)?;
        for (i, plane) in planes.planes_mut().enumerate() {
            plane.iter_mut().enumerate().for_each(|(n, x)| *x = start(n, i));
        }
        Ok(ProgramEnsemble { dynamics, planes, step: 0, execution, steps: [None, None] })
    }

    /// Bytes that `len` trajectories with so many degrees of freedom take.
    pub(super) fn bytes(degrees: usize, len: usize) -> u128 {
        Planes::<T>::bytes(2 * degrees, len)
    }

    /// Number of trajectories.
    pub(super) fn len(&self) -> usize {
        self.planes.len()
    }

    /// Whether there are none.
    pub(super) fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Degrees of freedom.
    pub(super) fn degrees(&self) -> usize {
        self.dynamics.degrees()
    }

    /// Number of steps taken.
    pub(super) fn step(&self) -> u64 {
        self.step
    }

    /// Sets the execution. Results do not depend on it.
    pub(super) fn execute(&mut self, execution: Execution) {
        self.execution = execution;
    }

    /// Coordinate `i` of `q₀ … q_{D−1}, v₀ … v_{D−1}` of every trajectory, if there is one.
    pub(super) fn coordinate(&self, i: usize) -> Option<&[T]> {
        (i < 2 * self.degrees()).then(|| self.planes.plane_of(i))
    }

    /// Takes `steps` steps of `dt` seconds with every trajectory.
    pub(super) fn advance(&mut self, method: AnyMethod, dt: T, steps: u64) {
        if steps > 0 && !self.is_empty() {
            let step = self.step_of(method, steps > 1);
            self.run(&step, dt, steps);
        }
        self.step = self.step.saturating_add(steps);
    }

    /// The energy of every trajectory; none if the system has none.
    pub(super) fn energies(&self) -> Option<Vec<T>> {
        Some(self.map(self.dynamics.energy()?))
    }

    /// The trajectories with a coordinate that is infinite or not a number, in order.
    pub(super) fn not_finite(&self) -> impl Iterator<Item = usize> + '_ {
        let is_lost =
            |n: &usize| (0..2 * self.degrees()).any(|i| !self.planes.plane_of(i)[*n].is_finite());
        (0..self.len()).filter(is_lost)
    }

    /// The first output of a program from positions, velocities and inputs, for every trajectory.
    fn map(&self, program: &Program) -> Vec<T> {
        let rows = 2 * self.degrees();
        let program = BlockProgram::new(program, |i| (i < rows).then_some(i), &[rows], rows + 1);
        let mut values = vec![T::zero(); self.len()];
        let mut block = Block::new(&program, self.len(), &[]);
        let lanes = block.lanes();
        for (first, values) in (0..self.len()).step_by(lanes).zip(values.chunks_mut(lanes)) {
            for i in 0..rows {
                block.load(i, &self.planes.plane_of(i)[first..][..values.len()]);
            }
            block.run(1, self.execution.instruction_set());
            block.store(rows, values);
        }
        values
    }

    /// The step of a method. It is kept, since to make it takes as long as some thousand steps.
    fn step_of(&mut self, method: AnyMethod, carries: bool) -> Arc<MachineStep> {
        let known = &mut self.steps[usize::from(carries)];
        match known {
            Some((own, step)) if *own == method => step.clone(),
            _ => {
                let step = Arc::new(MachineStep::new(method, &self.dynamics, carries));
                *known = Some((method, step.clone()));
                step
            }
        }
    }

    fn run(&mut self, step: &MachineStep, dt: T, steps: u64) {
        let degrees = self.degrees();
        // The time step is the last input.
        let mut inputs = vec![T::zero(); step.inputs(&self.dynamics)];
        inputs.push(dt);
        let instructions = self.execution.instruction_set();
        let each = step.step.shortest_steps().saturating_mul(steps);
        let each = each.saturating_add(MOVED * degrees as u64);
        let threads = self.execution.threads_for((self.len() as u64).saturating_mul(each));
        let size = self.len().div_ceil(threads).next_multiple_of(GRAIN);
        let mut shares: Vec<Vec<&mut [T]>> = Vec::new();
        for plane in self.planes.planes_mut() {
            for (i, part) in plane.chunks_mut(size).enumerate() {
                match shares.get_mut(i) {
                    Some(share) => share.push(part),
                    None => shares.push(vec![part]),
                }
            }
        }
        self.execution.each(shares, |mut share| {
            let len = share.first().map_or(0, |part| part.len());
            let mut block = Block::new(&step.step, len, &inputs);
            let lanes = block.lanes();
            let mut first = step.first.as_ref().map(|first| Block::new(first, lanes, &inputs));
            let mut passed = vec![T::zero(); lanes];
            for start in (0..len).step_by(lanes) {
                let range = start..(start + lanes).min(len);
                for (row, part) in share.iter().enumerate() {
                    block.load(row, &part[range.clone()]);
                }
                if let Some(first) = &mut first {
                    for (row, part) in share.iter().enumerate() {
                        first.load(row, &part[range.clone()]);
                    }
                    first.run(1, instructions);
                    for row in 2 * degrees..3 * degrees {
                        first.store(row, &mut passed);
                        block.load(row, &passed);
                    }
                }
                block.run(steps, instructions);
                for (row, part) in share.iter_mut().enumerate() {
                    block.store(row, &mut part[range.clone()]);
                }
            }
        });
    }
}
