//! All forces between bodies: gravity, and those of a pair potential.

use libration_batch::ColumnProgram;
use libration_batch::ensemble::Execution;

use super::direct_sum::{Attraction, axes, axes_mut};
use super::pair_potential::{Pair, PairPotential};

/// What acts between bodies.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Forces<'a> {
    pub(crate) gravity: Attraction<'a>,
    pub(crate) pairs: Option<PairForces<'a>>,
}

/// Forces of a potential between all pairs of bodies.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PairForces<'a> {
    pub(crate) potential: &'a PairPotential,
    pub(crate) masses: &'a [f64],
    pub(crate) charges: &'a [f64],
}

impl Forces<'_> {
    /// The accelerations at `positions`, in three planes as they.
    pub(crate) fn accelerations(&self, positions: &[f64], out: &mut [f64], on: &Execution) {
        self.gravity.accelerations(positions, out, on);
        if let Some(pairs) = &self.pairs {
            pairs.accelerate(positions, out, on);
        }
    }

    /// The energy of each body in the pair potentials of all others: their sum has each pair twice.
    pub(crate) fn pair_energies(&self, positions: &[f64], on: &Execution) -> Vec<f64> {
        match &self.pairs {
            Some(pairs) => pairs.energies(positions, on),
            None => vec![0.0; positions.len() / 3],
        }
    }
}

impl PairForces<'_> {
    /// Adds the accelerations. Each is a sum over the bodies in their order.
    fn accelerate(&self, positions: &[f64], out: &mut [f64], on: &Execution) {
        let program = self.potential.force_columns();
        let count = self.masses.len();
        let sums = self.sums(program, positions, on);
        for (axis, plane) in axes_mut(out).into_iter().enumerate() {
            for i in 0..count {
                plane[i] += sums[i][axis] / self.masses[i];
            }
        }
    }

    fn energies(&self, positions: &[f64], on: &Execution) -> Vec<f64> {
        let sums = self.sums(self.potential.energy_columns(), positions, on);
        sums.into_iter().map(|[energy, ..]| energy).collect()
    }

    /// The sums of the outputs of a program, up to three, over all pairs of each body.
    fn sums(&self, program: &ColumnProgram, positions: &[f64], on: &Execution) -> Vec<[f64; 3]> {
        let count = self.masses.len();
        let mut sums = vec![[0.0; 3]; count];
        let pairs = (count as u64).saturating_mul(count as u64);
        let threads = on.threads_for(pairs.saturating_mul(program.shortest_steps()));
        let part = count.div_ceil(threads);
        let work: Vec<_> = (0..).step_by(part).zip(sums.chunks_mut(part)).collect();
        on.each(work, |(first, sums)| self.sum(program, positions, first, sums, on));
        sums
    }

    /// The sums of the bodies from `first` on.
    fn sum(
        &self,
        program: &ColumnProgram,
        positions: &[f64],
        first: usize,
        sums: &mut [[f64; 3]],
        on: &Execution,
    ) {
        let (others, at) = (self.masses.len() - 1, axes(positions));
        let mut columns = program.columns(others);
        let mut inputs: [Vec<f64>; 7] = core::array::from_fn(|_| vec![0.0; others]);
        let mut outputs: [Vec<f64>; 3] = core::array::from_fn(|_| vec![0.0; others]);
        for (i, sum) in (first..).zip(sums) {
            for (axis, column) in inputs[..3].iter_mut().enumerate() {
                let own = at[axis][i];
                without(i, at[axis], column, |other| other - own);
            }
            // Body 1 is the first of both: the other before `i`, the own after it.
            for (k, values) in [(3, self.masses), (5, self.charges)] {
                let own = values[i];
                inputs[k][..i].copy_from_slice(&values[..i]);
                inputs[k][i..].fill(own);
                inputs[k + 1][..i].fill(own);
                inputs[k + 1][i..].copy_from_slice(&values[i + 1..]);
            }
            let mut out = outputs.each_mut().map(Vec::as_mut_slice);
            columns.run(|input| &inputs[input], &mut out, on.instruction_set());
            let [x, y, z] = &outputs;
            for ((x, y), z) in x.iter().zip(y).zip(z) {
                *sum = [sum[0] + x, sum[1] + y, sum[2] + z];
            }
        }
    }

    /// Bodies `i` and `j` as inputs of the programs.
    pub(crate) fn pair(&self, positions: &[f64], i: usize, j: usize) -> Pair {
        let [x, y, z] = axes(positions).map(|plane| plane[j] - plane[i]);
        let (a, b) = (i.min(j), i.max(j));
        let (masses, charges) = (self.masses, self.charges);
        [x, y, z, masses[a], masses[b], charges[a], charges[b]]
    }
}

/// Writes a function of all values but number `i`.
fn without(i: usize, values: &[f64], out: &mut [f64], f: impl Fn(f64) -> f64) {
    let (before, after) = out.split_at_mut(i);
    before.iter_mut().zip(&values[..i]).for_each(|(out, value)| *out = f(*value));
    after.iter_mut().zip(&values[i + 1..]).for_each(|(out, value)| *out = f(*value));
}
