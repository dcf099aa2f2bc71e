//! Weights, and the sums by which one is found in proportion to its weight.

use core::ops::Range;

/// Children of a node: a line of the cache.
const WIDTH: usize = 8;

/// Weights in a tree of sums.
///
/// Every sum is formed anew from its eight parts, in the same order, whenever one of them changes: the total is that of the weights
/// that are there, whatever was there before, to the last bit.
///
/// ```
/// use libration::replay::SumTree;
///
/// let mut tree = SumTree::new(100);
/// tree.set(&[(3, 1.0), (70, 3.0)]);
/// assert_eq!(tree.total(), 4.0);
/// assert_eq!([tree.find(0.5), tree.find(1.0), tree.find(3.9)], [Some(3), Some(70), Some(70)]);
/// ```
#[derive(Clone, Debug)]
pub struct SumTree {
    weights: Vec<f64>,
    sums: Sums,
}

impl SumTree {
    /// A tree of `len` weights, all of them zero.
    pub fn new(len: usize) -> Self {
        SumTree { weights: vec![0.0; len], sums: Sums::zero(len) }
    }

    /// The weights.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// Their sum.
    pub fn total(&self) -> f64 {
        self.sums.total()
    }

    /// Changes weights: which, and what they are from now on.
    ///
    /// # Panics
    /// If an index is out of range, or a weight is negative or not finite.
    pub fn set(&mut self, changes: &[(usize, f64)]) {
        for &(at, weight) in changes {
            assert!(weight >= 0.0 && weight.is_finite(), "weight {at} is {weight}");
            self.weights[at] = weight;
        }
        self.sums.renew(&self.weights, changes.iter().map(|&(at, _)| at));
    }

    /// The weight that lies at `target` when all are laid end to end, from 0 on: never one that is zero; none if all are.
    pub fn find(&self, target: f64) -> Option<usize> {
        let mut found = [0];
        self.sums.find(&self.weights, &mut [target.max(0.0)], &mut found);
        (self.total() > 0.0).then_some(found[0])
    }
}

/// The sums above weights that lie elsewhere.
#[derive(Clone, Debug)]
pub(super) struct Sums {
    /// From those of eight weights to that of all; each level but the last is as long as whole nodes.
    levels: Vec<Vec<f64>>,
}

impl Sums {
    /// The sums of `len` zeros.
    pub(super) fn zero(len: usize) -> Self {
        let mut levels = Vec::new();
        let mut len = len;
        while len > 1 || levels.is_empty() {
            len = len.div_ceil(WIDTH).max(1);
            let padded = if len == 1 { 1 } else { len.next_multiple_of(WIDTH) };
            levels.push(vec![0.0; padded]);
        }
        Sums { levels }
    }

    /// The sums of these weights.
    pub(super) fn over(weights: &[f64]) -> Self {
        let mut sums = Sums::zero(weights.len());
        sums.renew_all(weights, 0..weights.len());
        sums
    }

    /// The sum of all weights.
    pub(super) fn total(&self) -> f64 {
        self.levels.last().map_or(0.0, |top| top[0])
    }

    /// The weights in this range have changed.
    pub(super) fn renew_all(&mut self, weights: &[f64], range: Range<usize>) {
        if range.is_empty() {
            return;
        }
        let (mut first, mut last) = (range.start, range.end - 1);
        for level in 0..self.levels.len() {
            (first, last) = (first / WIDTH, last / WIDTH);
            for node in first..=last {
                self.renew_one(weights, level, node);
            }
        }
    }

    /// Updates the sums of changed weights.
    pub(super) fn renew(&mut self, weights: &[f64], changed: impl Iterator<Item = usize> + Clone) {
        let mut width = 1;
        for level in 0..self.levels.len() {
            width *= WIDTH;
            let mut before = usize::MAX;
            for at in changed.clone() {
                let node = at / width;
                // What one sum was formed for need not be formed again for its neighbour.
                if node != before {
                    self.renew_one(weights, level, node);
                }
                before = node;
            }
        }
    }

    #[inline(always)]
    fn renew_one(&mut self, weights: &[f64], level: usize, node: usize) {
        let sum = match level.checked_sub(1) {
            None => sum(&parts_of(weights, node)),
            Some(below) => sum(&parts_of(&self.levels[below], node)),
        };
        self.levels[level][node] = sum;
    }

    /// Which weights lie at some targets, where one is above zero; of the targets stays how far into them they are.
    ///
    /// All go down a level together: none waits for the memory of another.
    pub(super) fn find(&self, weights: &[f64], targets: &mut [f64], found: &mut [usize]) {
        found.fill(0);
        for level in (0..self.levels.len()).rev() {
            let all = level.checked_sub(1).map_or(weights, |below| &self.levels[below]);
            let (mut before, mut parts) = (usize::MAX, Parts::default());
            for (node, target) in found.iter_mut().zip(&mut *targets) {
                // Of targets in order many neighbours meet in the upper nodes.
                if *node != before {
                    (before, parts) = (*node, Parts::of(&parts_of(all, *node)));
                }
                let (part, left) = parts.choose(*target);
                (*node, *target) = (*node * WIDTH + part, left);
            }
        }
    }
}

/// The parts of a node; beyond the last there is nothing.
#[inline(always)]
fn parts_of(all: &[f64], node: usize) -> [f64; WIDTH] {
    let from = &all[(node * WIDTH).min(all.len())..];
    from.first_chunk().copied().unwrap_or_else(|| {
        let mut parts = [0.0; WIDTH];
        parts.iter_mut().zip(from).for_each(|(to, part)| *to = *part);
        parts
    })
}

/// Always in this order.
#[inline(always)]
fn sum([a, b, c, d, e, f, g, h]: &[f64; WIDTH]) -> f64 {
    ((a + b) + (c + d)) + ((e + f) + (g + h))
}

/// The parts of a node laid end to end.
#[derive(Clone, Copy, Default)]
struct Parts {
    begins: [f64; WIDTH],
    /// A bit for each that is above zero.
    there: u32,
}

impl Parts {
    #[inline(always)]
    fn of(parts: &[f64; WIDTH]) -> Self {
        let (mut begins, mut there) = ([0.0; WIDTH], u32::from(parts[0] > 0.0));
        for i in 1..WIDTH {
            begins[i] = begins[i - 1] + parts[i - 1];
            there |= u32::from(parts[i] > 0.0) << i;
        }
        Parts { begins, there }
    }

    /// The last part that is above zero and does not begin beyond `target`, and how far into it that is: without branches, which
    /// would be guessed wrong.
    #[inline(always)]
    fn choose(&self, target: f64) -> (usize, f64) {
        let begun = self.begins.iter().enumerate();
        let begun = begun.fold(0, |mask, (i, &begin)| mask | u32::from(begin <= target) << i);
        let chosen = (begun & self.there | 1).ilog2() as usize % WIDTH;
        // Rounding may leave a little more than the part is long.
        (chosen, target - self.begins[chosen])
    }
}
