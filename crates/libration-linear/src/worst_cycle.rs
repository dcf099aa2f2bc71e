//! The cycle of a switched system that grows most.

use crate::node_coordinates::Steps;
use crate::{Matrix, SwitchedSystem, eigenvalues, is_schur_stable};

/// A cycle of a switched system.
pub(crate) struct WorstCycle {
    /// The growth per step.
    pub(crate) growth: f64,
    /// The numbers of its transitions.
    pub(crate) cycle: Vec<usize>,
}

/// A walk of the search.
struct Walk {
    size: f64,
    start: usize,
    node: usize,
    product: Matrix,
    transitions: Vec<usize>,
}

/// The walks of each length that are followed: the longest, in coordinates in which steps are short.
const MOST_WALKS: usize = 300;

/// Multiplications of numbers in products of walks at most, where matrices are large.
const MOST_WORK: f64 = 8e8;

/// The part by which a longer cycle must grow more than a shorter one: more than rounding. A cycle twice over is no other.
const BETTER: f64 = 1e-9;

impl SwitchedSystem {
    /// The cycle of up to `longest` steps that grows most, among those that the search follows.
    pub(crate) fn worst_cycle(&self, steps: &Steps, longest: usize) -> WorstCycle {
        let n = self.size();
        let start = |node| Walk {
            size: 1.0,
            start: node,
            node,
            product: Matrix::identity(n),
            transitions: Vec::new(),
        };
        let each = (2 * longest * n.pow(3)) as f64;
        let followed = ((MOST_WORK / each) as usize).clamp(20, MOST_WALKS);
        let mut walks: Vec<Walk> = (0..self.nodes()).map(start).collect();
        let mut best = WorstCycle { growth: -1.0, cycle: Vec::new() };
        for length in 1..=longest {
            let mut longer = Vec::new();
            for walk in &walks {
                for &transition in self.leaving(walk.node) {
                    let product = &steps.matrices[transition] * &walk.product;
                    let node = self.transitions()[transition].to;
                    let size = product.inner(&product).sqrt();
                    let transitions = walk.transitions.iter().copied().chain([transition]);
                    let transitions: Vec<usize> = transitions.collect();
                    // The spectral radius is at most the norm.
                    let root = |size: f64| size.powf(1.0 / length as f64);
                    if node == walk.start && root(size) > best.growth * (1.0 + BETTER) {
                        let growth = root(spectral_radius(&product));
                        if growth > best.growth * (1.0 + BETTER) || best.cycle.is_empty() {
                            best = WorstCycle { growth, cycle: transitions.clone() };
                        }
                    }
                    longer.push(Walk { size, start: walk.start, node, product, transitions });
                }
            }
            longer.sort_by(|a, b| b.size.total_cmp(&a.size));
            longer.truncate(followed);
            walks = longer;
        }
        self.confirm(&mut best);
        best
    }

    /// The growth from the matrices themselves; 0 if no cycle was found. Above 1 it must be certain.
    fn confirm(&self, best: &mut WorstCycle) {
        if best.cycle.is_empty() {
            best.growth = 0.0;
            return;
        }
        let product = self.product(&best.cycle);
        best.growth = spectral_radius(&product).powf(1.0 / best.cycle.len() as f64);
        if best.growth >= 1.0 && is_schur_stable(&product) {
            best.growth = 1.0 - f64::EPSILON;
        }
    }
}

/// The spectral radius; 0 if the iteration for the eigenvalues does not settle.
fn spectral_radius(matrix: &Matrix) -> f64 {
    let values = eigenvalues(matrix).unwrap_or_default();
    values.iter().map(|value| value.norm()).fold(0.0, f64::max)
}
