//! Ensembles of systems that are chosen at run time.

use core::ops::Range;
use std::sync::Arc;

use libration_core::system::Oscillator;
use libration_core::{AnyMethod, AnySystem, Model, with_system};
use libration_equations::{Dynamics, Program};

use super::planes::Planes;
use super::{BatchFloat, EnsembleError, Execution, GRAIN, MOVED, compiled_oscillator};
use crate::machine::{Block, BlockProgram, MachineStep};

/// Trajectories of a system by its program, as structure of arrays.
///
/// The block machine steps them. A trajectory has the bits of the program of a step, run alone, and those of a compiled system with
/// the same operations. Explicit steps of oscillators have compiled kernels.
#[derive(Debug)]
pub struct AnyEnsemble<T> {
    dynamics: Dynamics,
    /// The oscillator in one dimension that the coordinates are, if the system is one.
    oscillator: Option<Oscillator<T>>,
    planes: Planes<T>,
    step: u64,
    execution: Execution,
    /// The steps that were used last, with and without [a carried acceleration](MachineStep::first).
    steps: [Option<(AnyMethod, Arc<MachineStep>)>; 2],
}

/// The programs of a system of the catalogue; none if it does not exist in that dimension.
pub fn dynamics_of(system: AnySystem, dimension: usize) -> Option<Dynamics> {
    with_system!(system, dimension, |model, D| Some(Dynamics::of::<D>(&model, None)), None)
}

impl<T: BatchFloat> AnyEnsemble<T> {
    /// `len` trajectories whose inputs are zero; the start of trajectory `n` is what `start(n, i)` says of its coordinates
    /// `q₀ … q_{D−1}, v₀ … v_{D−1}`. `twin` is the system of the catalogue whose program this is, if it is one.
    ///
    /// # Errors
    /// [`EnsembleError::Memory`].
    pub fn new(
        dynamics: &Dynamics,
        twin: Option<AnySystem>,
        len: usize,
        execution: Execution,
        start: impl Fn(usize, usize) -> T + Sync,
    ) -> Result<Self, EnsembleError> {
        let dynamics = dynamics.clone();
        let oscillator = match twin {
            Some(AnySystem::Oscillator(model)) => Some(Model::<1>::on::<T>(&model)),
            _ => None,
        };
        let mut planes = Planes::new(2 * dynamics.degrees(), len)?;
        // The threads write the memory that they will work on.
        let coordinates = (len as u64).saturating_mul(2 * dynamics.degrees() as u64);
        let size = len.div_ceil(execution.threads_for(coordinates)).next_multiple_of(GRAIN).max(1);
        let parts = planes.planes_mut().enumerate().flat_map(|(i, plane)| {
            let parts = plane.chunks_mut(size).enumerate();
            parts.map(move |(part, values)| (i, part * size, values))
        });
        execution.each(parts.collect(), |(i, first, values): (usize, usize, &mut [T])| {
            values.iter_mut().enumerate().for_each(|(n, x)| *x = start(first + n, i));
        });
        Ok(AnyEnsemble { dynamics, oscillator, planes, step: 0, execution, steps: [None, None] })
    }

    /// The same of a system of the catalogue.
    ///
    /// # Errors
    /// [`EnsembleError::System`] if the system does not exist in that dimension; [`EnsembleError::Memory`].
    pub fn of_system(
        system: AnySystem,
        dimension: usize,
        len: usize,
        execution: Execution,
        start: impl Fn(usize, usize) -> T + Sync,
    ) -> Result<Self, EnsembleError> {
        let wrong = || EnsembleError::System(system.entry().wrong_dimension(dimension));
        let dynamics = dynamics_of(system, dimension).ok_or_else(wrong)?;
        AnyEnsemble::new(&dynamics, Some(system), len, execution, start)
    }

    /// Bytes that `len` trajectories with so many degrees of freedom take.
    pub fn bytes(degrees: usize, len: usize) -> u128 {
        Planes::<T>::bytes(2 * degrees, len)
    }

    /// Number of trajectories.
    pub fn len(&self) -> usize {
        self.planes.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Degrees of freedom.
    pub fn dimension(&self) -> usize {
        self.dynamics.degrees()
    }

    /// Number of steps taken.
    pub fn step(&self) -> u64 {
        self.step
    }

    /// Runs the next steps on other threads or with other instructions, which changes no result.
    pub fn execute(&mut self, execution: Execution) {
        self.execution = execution;
    }

    /// Position `i` of every trajectory, if there is one.
    pub fn q(&self, i: usize) -> Option<&[T]> {
        (i < self.dimension()).then(|| self.planes.plane_of(i))
    }

    /// Velocity `i` of every trajectory, if there is one.
    pub fn v(&self, i: usize) -> Option<&[T]> {
        (i < self.dimension()).then(|| self.planes.plane_of(self.dimension() + i))
    }

    /// Takes `steps` steps of `dt` seconds with every trajectory. The program of a method is made when it is used first.
    pub fn advance(&mut self, method: impl Into<AnyMethod>, dt: T, steps: u64) {
        T::advance(self, method.into(), dt, steps);
    }

    /// The energy of every trajectory, of a system of the catalogue per unit mass, in J/kg; none if the system has none.
    pub fn energies(&self) -> Option<Vec<T>> {
        T::energies(self)
    }

    /// The trajectories with a coordinate that is infinite or not a number, in order.
    pub fn not_finite(&self) -> Vec<usize> {
        let is_lost =
            |n: &usize| (0..2 * self.dimension()).any(|i| !self.planes.plane_of(i)[*n].is_finite());
        (0..self.len()).filter(is_lost).collect()
    }

    pub(super) fn take_steps(&mut self, method: AnyMethod, dt: T, steps: u64) {
        let range = self.step..self.step.saturating_add(steps);
        if steps > 0 && !self.is_empty() && !self.advance_by_kernels(method, dt, &range) {
            let step = self.step_of(method, steps > 1);
            self.run(&step, dt, steps);
        }
        self.step = range.end;
    }

    /// Returns whether there are kernels for it.
    fn advance_by_kernels(&mut self, method: AnyMethod, dt: T, steps: &Range<u64>) -> bool {
        match (self.oscillator, method) {
            (Some(oscillator), AnyMethod::Explicit(method)) => {
                let planes = (&mut self.planes, self.dynamics.degrees());
                let execution = &self.execution;
                compiled_oscillator::advance(planes, oscillator, method, dt, steps, execution)
            }
            _ => false,
        }
    }

    pub(super) fn evaluate_energies(&self) -> Option<Vec<T>> {
        Some(self.map(self.dynamics.energy()?))
    }

    /// The first output of a program from positions, velocities and inputs, for every trajectory.
    fn map(&self, program: &Program) -> Vec<T> {
        let rows = 2 * self.dimension();
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
        let degrees = self.dimension();
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
