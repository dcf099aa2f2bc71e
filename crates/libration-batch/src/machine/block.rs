//! Blocks: rows of lanes, and what runs programs on them.

use core::cell::Cell;
use core::ops::Deref;

use super::MachineFloat;
use super::block_program::BlockProgram;
use super::runs::Runs;
use crate::ensemble::InstructionSet;

/// Lanes that are loaded, computed and stored together.
pub(super) const LANES: usize = 16;

/// Bytes of a block, of the 32 KiB that the first cache of a core holds at least.
const BYTES: usize = 24 << 10;

/// The most lanes of a block. Beyond, the time between two instructions is below a hundredth.
const MOST_LANES: usize = 1024;

/// Neighbouring lanes of a row.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct Lanes<T>(pub(super) [T; LANES]);

/// The rows of a block, with the values that all lanes share, and a reference to their program.
#[derive(Debug)]
pub(crate) struct Block<P, T> {
    program: P,
    uniforms: Vec<T>,
    rows: Vec<Lanes<T>>,
    /// Groups of lanes in a row.
    width: usize,
}

impl<P: Deref<Target = BlockProgram>, T: MachineFloat> Block<P, T> {
    /// A block for at most `lanes` lanes; `inputs` are those of the program, of which only the uniform ones count.
    pub(crate) fn new(program: P, lanes: usize, inputs: &[T]) -> Self {
        let row = LANES * size_of::<T>();
        let most = (BYTES / row / program.rows().max(1)).clamp(1, MOST_LANES / LANES);
        let width = lanes.div_ceil(LANES).clamp(1, most);
        let uniforms = program.uniforms(inputs);
        let mut rows = vec![Lanes([T::zero(); LANES]); width * program.rows()];
        for &(row, uniform) in program.filled() {
            rows[row * width..][..width].fill(Lanes([uniforms[uniform]; LANES]));
        }
        Block { program, uniforms, rows, width }
    }

    /// The number of lanes.
    pub(crate) fn lanes(&self) -> usize {
        self.width * LANES
    }

    /// Sets a row; lanes beyond the last value repeat it.
    pub(crate) fn load(&mut self, row: usize, values: &[T]) {
        let groups = &mut self.rows[row * self.width..][..self.width];
        let (full, rest) = values.as_chunks::<LANES>();
        for (Lanes(lanes), values) in groups.iter_mut().zip(full) {
            *lanes = *values;
        }
        if full.len() < groups.len() {
            let last = values.last().copied().unwrap_or_else(T::zero);
            let beyond = &mut groups[full.len()..];
            beyond.fill(Lanes([last; LANES]));
            beyond[0].0[..rest.len()].copy_from_slice(rest);
        }
    }

    /// Copies a row into `values`, as many as there are.
    pub(crate) fn store(&self, row: usize, values: &mut [T]) {
        let groups = &self.rows[row * self.width..][..self.width];
        let (full, rest) = values.as_chunks_mut::<LANES>();
        let count = full.len();
        for (Lanes(lanes), values) in groups.iter().zip(full) {
            *values = *lanes;
        }
        if let Some(Lanes(lanes)) = groups.get(count) {
            rest.copy_from_slice(&lanes[..rest.len()]);
        }
    }

    /// Runs the program so many times on its own results.
    pub(crate) fn run(&mut self, times: u64, instructions: InstructionSet) {
        let Block { program, uniforms, rows, width } = self;
        let rows = Cell::from_mut(rows.as_mut_slice()).as_slice_of_cells();
        let (list, width) = (&program.instructions, *width);
        T::execute(Runs { instructions: list, uniforms, rows, width, times }, instructions);
    }
}
