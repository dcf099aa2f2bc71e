//! Accelerations and potentials by direct sums over all pairs.

use libration_batch::ensemble::{Execution, InstructionSet, Loop};

/// Targets that a loop holds in registers. Each is a lane, whatever the width of the vectors.
const LANES: usize = 8;

/// Pairs are this many of the shortest steps of an [`Execution`].
const STEPS_PER_PAIR: usize = 4;

/// The bodies that attract: `G·m` and positions, and the square of the softening length.
///
/// The potential of a body is `−Gm/√(r² + ε²)` (H. C. Plummer, MNRAS 71, 1911).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Attraction<'a> {
    /// `G·m` of each body.
    pub(crate) strengths: &'a [f64],
    /// The number of bodies up to the last that has a mass.
    pub(crate) sources: usize,
    /// `ε²`.
    pub(crate) softening: f64,
}

/// Three planes of the same length: one for each axis.
pub(crate) fn axes(vectors: &[f64]) -> [&[f64]; 3] {
    let count = vectors.len() / 3;
    let (x, rest) = vectors.split_at(count);
    let (y, z) = rest.split_at(count);
    [x, y, z]
}

/// The same, to be written.
pub(crate) fn axes_mut(vectors: &mut [f64]) -> [&mut [f64]; 3] {
    let count = vectors.len() / 3;
    let (x, rest) = vectors.split_at_mut(count);
    let (y, z) = rest.split_at_mut(count);
    [x, y, z]
}

impl Attraction<'_> {
    /// The accelerations at `positions` (three planes). Each is a sum over the bodies in their order, so that its bits depend on no
    /// thread and no width. Infinite or NaN where two bodies are at the same place.
    pub(crate) fn accelerations(&self, positions: &[f64], out: &mut [f64], on: &Execution) {
        let [x, y, z] = axes_mut(out);
        let parts = self.parts(x.len(), on);
        let planes = x.chunks_mut(parts).zip(y.chunks_mut(parts)).zip(z.chunks_mut(parts));
        let work: Vec<_> = (0..).step_by(parts).zip(planes).collect();
        let set = on.instruction_set();
        let at = axes(positions);
        if let [_] = work[..] {
            work.into_iter().for_each(|(first, ((x, y), z))| self.part(set, at, first, [x, y, z]));
        } else {
            on.each(work, |(first, ((x, y), z))| self.part(set, at, first, [x, y, z]));
        }
    }

    fn part(&self, set: InstructionSet, at: [&[f64]; 3], first: usize, out: [&mut [f64]; 3]) {
        set.vectorize(AccelerationLoop { attraction: *self, at, first, out });
    }

    /// The potential of the others at each body.
    pub(crate) fn potentials(&self, positions: &[f64], on: &Execution) -> Vec<f64> {
        let at = axes(positions);
        let mut out = vec![0.0; at[0].len()];
        let parts = self.parts(out.len(), on);
        let work: Vec<_> = (0..).step_by(parts).zip(out.chunks_mut(parts)).collect();
        let set = on.instruction_set();
        on.each(work, |(first, out)| {
            set.vectorize(PotentialLoop { attraction: *self, at, first, out });
        });
        out
    }

    /// Targets for each thread: a multiple of the lanes.
    fn parts(&self, targets: usize, on: &Execution) -> usize {
        let pairs = targets.saturating_mul(self.sources).saturating_mul(STEPS_PER_PAIR);
        let threads = on.threads_for(pairs as u64);
        targets.div_ceil(threads).next_multiple_of(LANES)
    }
}

/// Targets in the lanes of a loop, and the sources.
struct Tile<'a> {
    targets: [[f64; LANES]; 3],
    /// The first target.
    first: usize,
    strengths: &'a [f64],
    /// As long as the strengths, so that no index is checked in the loop.
    sources: [&'a [f64]; 3],
    softening: f64,
}

impl<'a> Tile<'a> {
    /// The targets from `first` on; where there are fewer, the last lanes repeat one of them.
    #[inline(always)]
    fn load(attraction: Attraction<'a>, at: [&'a [f64]; 3], first: usize) -> Self {
        let last = at[0].len() - 1;
        Tile {
            targets: at.map(|plane| core::array::from_fn(|l| plane[(first + l).min(last)])),
            first,
            strengths: &attraction.strengths[..attraction.sources],
            sources: at.map(|plane| &plane[..attraction.sources]),
            softening: attraction.softening,
        }
    }

    /// The vector from lane `l` to source `j`, and the square of their distance.
    #[inline(always)]
    fn offset(&self, l: usize, j: usize) -> ([f64; 3], f64) {
        let [x, y, z]: [f64; 3] =
            core::array::from_fn(|axis| self.sources[axis][j] - self.targets[axis][l]);
        ([x, y, z], x * x + y * y + z * z + self.softening)
    }

    /// `weight`, or zero for a body and itself, if it may be among the lanes.
    #[inline(always)]
    fn of_others<const AMONG: bool>(&self, l: usize, j: usize, weight: f64) -> f64 {
        if AMONG && self.first + l == j { 0.0 } else { weight }
    }

    #[inline(always)]
    fn accelerate<const AMONG: bool>(
        &self,
        mut sums: [[f64; LANES]; 3],
        j: usize,
    ) -> [[f64; LANES]; 3] {
        for l in 0..LANES {
            let (offset, square) = self.offset(l, j);
            let weight = self.strengths[j] / (square * square.sqrt());
            let weight = self.of_others::<AMONG>(l, j, weight);
            for (sum, offset) in sums.iter_mut().zip(offset) {
                sum[l] += weight * offset;
            }
        }
        sums
    }

    #[inline(always)]
    fn potential<const AMONG: bool>(&self, mut sums: [f64; LANES], j: usize) -> [f64; LANES] {
        for (l, sum) in sums.iter_mut().enumerate() {
            let (_, square) = self.offset(l, j);
            *sum -= self.of_others::<AMONG>(l, j, self.strengths[j] / square.sqrt());
        }
        sums
    }

    /// Adds up the sources in their order: `among` takes those among the lanes, `others` the rest.
    #[inline(always)]
    fn sum<T>(
        &self,
        mut sums: T,
        others: impl Fn(T, usize) -> T,
        among: impl Fn(T, usize) -> T,
    ) -> T {
        let count = self.strengths.len();
        let (from, to) = (self.first.min(count), (self.first + LANES).min(count));
        for j in 0..from {
            sums = others(sums, j);
        }
        for j in from..to {
            sums = among(sums, j);
        }
        for j in to..count {
            sums = others(sums, j);
        }
        sums
    }
}

struct AccelerationLoop<'a> {
    attraction: Attraction<'a>,
    at: [&'a [f64]; 3],
    /// The first target.
    first: usize,
    out: [&'a mut [f64]; 3],
}

impl Loop for AccelerationLoop<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let [x, y, z] = self.out;
        let tiles = x.chunks_mut(LANES).zip(y.chunks_mut(LANES)).zip(z.chunks_mut(LANES));
        for (number, ((x, y), z)) in tiles.enumerate() {
            let tile = Tile::load(self.attraction, self.at, self.first + number * LANES);
            let sums = tile.sum(
                [[0.0; LANES]; 3],
                #[inline(always)]
                |sums, j| tile.accelerate::<false>(sums, j),
                #[inline(always)]
                |sums, j| tile.accelerate::<true>(sums, j),
            );
            for (out, sums) in [x, y, z].into_iter().zip(sums) {
                out.copy_from_slice(&sums[..out.len()]);
            }
        }
    }
}

struct PotentialLoop<'a> {
    attraction: Attraction<'a>,
    at: [&'a [f64]; 3],
    /// The first target.
    first: usize,
    out: &'a mut [f64],
}

impl Loop for PotentialLoop<'_> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        for (number, out) in self.out.chunks_mut(LANES).enumerate() {
            let tile = Tile::load(self.attraction, self.at, self.first + number * LANES);
            let sums = tile.sum(
                [0.0; LANES],
                #[inline(always)]
                |sums, j| tile.potential::<false>(sums, j),
                #[inline(always)]
                |sums, j| tile.potential::<true>(sums, j),
            );
            out.copy_from_slice(&sums[..out.len()]);
        }
    }
}
