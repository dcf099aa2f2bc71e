//! Bounds of the growth of a switched system: of its constrained joint spectral radius.

use crate::node_coordinates::{NodeCoordinates, Steps};
use crate::spectral_norm::is_norm_below;
use crate::worst_cycle::WorstCycle;
use crate::{Matrix, SwitchedSystem};

/// Bounds of the growth per step of a switched system in the worst allowed sequence: of its constrained joint spectral radius.
#[derive(Clone, Debug, PartialEq)]
pub struct GrowthBounds {
    /// At least this: the growth per step of `cycle` over and over.
    pub lower: f64,
    /// At most this.
    pub upper: f64,
    /// The worst cycle that was found: the numbers of its transitions.
    pub cycle: Vec<usize>,
}

/// Where the search for bounds ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SearchEnd {
    /// The relative width of the bounds.
    pub width: f64,
    /// Whether the search also ends once both bounds are on the same side of 1.
    pub once_decided: bool,
    /// The steps of the longest cycle that is tried.
    pub longest_cycle: usize,
}

/// Whether a motion decays in all allowed sequences.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// All motions decay in every sequence.
    Stable,
    /// Some motion does not decay in some sequence.
    Unstable,
    /// The bounds do not tell.
    Undecided,
}

impl GrowthBounds {
    /// Whether all motions decay in every allowed sequence.
    pub fn verdict(&self) -> Verdict {
        if self.upper < 1.0 {
            Verdict::Stable
        } else if self.lower >= 1.0 {
            Verdict::Unstable
        } else {
            Verdict::Undecided
        }
    }

    fn ends(&self, end: &SearchEnd) -> bool {
        let decided = self.verdict() != Verdict::Undecided;
        end.once_decided && decided || self.upper <= self.lower * (1.0 + end.width)
    }
}

/// The descents to better coordinates: doublings of the power, and iterations.
const DESCENTS: [(u32, usize); 6] = [(0, 30), (1, 30), (2, 30), (3, 40), (4, 60), (5, 80)];

/// The last descents, which are repeated in a graph with more nodes.
const LAST_DESCENTS: [(u32, usize); 2] = [(5, 80), (7, 80)];

/// Multiplications of numbers in the descents at most; they take some seconds.
const MOST_WORK: f64 = 2.5e9;

/// Most refinements of the graph.
const REFINEMENTS: usize = 4;

/// The multiplications of numbers in one search by products at most, and its products.
const MOST_PRODUCT_WORK: f64 = 5e8;
const MOST_PRODUCTS: usize = 200_000;

/// The search for an upper bound in coordinates of the nodes of a graph.
struct Descent {
    system: SwitchedSystem,
    coordinates: NodeCoordinates,
    /// The steps in the best coordinates.
    steps: Steps,
    /// Multiplications that are left.
    left: f64,
}

impl Descent {
    fn new(system: &SwitchedSystem) -> Self {
        let coordinates = NodeCoordinates::balanced(system);
        let steps = coordinates.steps(system);
        Descent { system: system.clone(), coordinates, steps, left: MOST_WORK }
    }

    fn descend(&mut self, doublings: u32, iterations: usize) {
        let products = f64::from(2 * doublings + 8) * self.system.transitions().len() as f64;
        let cost = products * self.system.size().pow(3) as f64;
        let iterations = iterations.min((self.left / cost) as usize);
        self.left -= cost * iterations as f64;
        self.coordinates.descend(&self.system, doublings, iterations);
        let steps = self.coordinates.steps(&self.system);
        if steps.longest < self.steps.longest {
            self.steps = steps;
        }
    }

    /// Goes over to a graph with a node for each transition: more norms, the more of the walk each of them knows, close in on the growth
    /// (Philippe and others, *path-dependent* norms). Returns whether there is work left for it.
    fn refine(&mut self) -> bool {
        let refined = self.system.refined();
        let cost = (20 * refined.transitions().len() * self.system.size().pow(3)) as f64;
        if 20.0 * cost > self.left {
            return false;
        }
        self.coordinates = self.coordinates.refined(&self.system);
        self.system = refined;
        self.steps = self.coordinates.steps(&self.system);
        true
    }

    fn bound(&self) -> f64 {
        self.steps.longest + self.steps.rounding
    }
}

impl SwitchedSystem {
    /// Bounds on the growth per step in the worst allowed sequence.
    ///
    /// From below the largest spectral radius of a cycle, to the power of one over its length. From above the longest step in coordinates
    /// of the nodes, or products of steps that all become shorter than a bound (G. Gripenberg, *Computing the joint spectral
    /// radius*, Linear Algebra and its Applications 234, 1996). Both are in floats; the upper one includes a bound of their rounding.
    pub fn growth_bounds(&self, end: &SearchEnd) -> GrowthBounds {
        let mut bounds = GrowthBounds { lower: 0.0, upper: f64::INFINITY, cycle: Vec::new() };
        let mut descent = Descent::new(self);
        for (round, (doublings, iterations)) in DESCENTS.into_iter().enumerate() {
            descent.descend(doublings, iterations);
            bounds.upper = bounds.upper.min(descent.bound());
            let last = round + 1 == DESCENTS.len();
            if last || round == 2 {
                let WorstCycle { growth, cycle } =
                    self.worst_cycle(&descent.steps, end.longest_cycle);
                if bounds.cycle.is_empty() || growth > bounds.lower {
                    (bounds.lower, bounds.cycle) = (growth, cycle);
                }
            }
            if round >= 2 && bounds.ends(end) {
                return bounds;
            }
        }
        for refinement in 0..=REFINEMENTS {
            if refinement > 0 && !descent.refine() {
                break;
            }
            for (doublings, iterations) in LAST_DESCENTS {
                descent.descend(doublings, iterations);
                bounds.upper = bounds.upper.min(descent.bound());
                if bounds.ends(end) {
                    return bounds;
                }
            }
        }
        descent.system.bound_by_products(&descent.steps, &mut bounds, end);
        bounds
    }

    /// Lowers the upper bound by products of steps: first below 1, where that decides, then by bisection.
    fn bound_by_products(&self, steps: &Steps, bounds: &mut GrowthBounds, end: &SearchEnd) {
        const BISECTIONS: usize = 8;
        // Shown as below 1.
        let edge = 1.0 - 1e-5;
        let decides = bounds.lower < edge && edge < bounds.upper;
        if decides && self.products_fall_below(steps, edge) {
            bounds.upper = edge;
        }
        if end.once_decided {
            return;
        }
        let mut failed = bounds.lower;
        let mut bound = bounds.lower * (1.0 + end.width);
        for _ in 0..BISECTIONS {
            if bound >= bounds.upper || bounds.ends(end) {
                return;
            }
            match self.products_fall_below(steps, bound) {
                true => bounds.upper = bound,
                false => failed = bound,
            }
            bound = (failed * bounds.upper).sqrt();
        }
    }

    /// Whether all walks begin with a product of norm below `bound` to the power of its length, so that the growth is below `bound`.
    fn products_fall_below(&self, steps: &Steps, bound: f64) -> bool {
        const DEEPEST: usize = 400;
        let longest = steps.longest / bound;
        let rounding = steps.rounding / bound;
        let relative: Vec<_> = steps.matrices.iter().map(|m| m.scaled(bound.recip())).collect();
        let n = self.size();
        let mut left = MOST_PRODUCTS.min((MOST_PRODUCT_WORK / (3 * n.pow(3)) as f64) as usize);
        // Walks that are not yet short enough, with their products.
        let mut open: Vec<(usize, usize, Matrix)> = Vec::new();
        for node in 0..self.nodes() {
            open.push((node, 0, Matrix::identity(n)));
            while let Some((node, length, product)) = open.pop() {
                for &transition in self.leaving(node) {
                    if left == 0 || length == DEEPEST {
                        return false;
                    }
                    left -= 1;
                    let longer = &relative[transition] * &product;
                    let steps = (length + 1) as f64;
                    // Each factor may be off by its rounding, and each product rounds its entries again.
                    let lost = rounding + n as f64 * f64::EPSILON * longest * n as f64;
                    let slack = steps * lost * longest.max(1.0).powf(steps);
                    if slack >= 0.5 || !is_norm_below(&longer, 1.0 - slack) {
                        open.push((self.transitions()[transition].to, length + 1, longer));
                    }
                }
            }
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Transition;

    fn matrix(rows: [[f64; 2]; 2]) -> Matrix {
        Matrix::from_rows(&rows).unwrap()
    }

    const CLOSE: SearchEnd = SearchEnd { width: 1e-3, once_decided: false, longest_cycle: 16 };

    #[test]
    fn joint_spectral_radii_of_the_literature_lie_between_the_bounds() {
        // The golden ratio, by the product of both (V. Blondel, J. Theys, A. Vladimirov, An elementary counterexample to the finiteness
        // conjecture, SIAM Journal on Matrix Analysis 24, 2003).
        let golden = [matrix([[1.0, 1.0], [0.0, 1.0]]), matrix([[1.0, 0.0], [1.0, 1.0]])];
        // Example 5.4 of A. Ahmadi, R. Jungers, P. Parrilo, M. Roozbehani, Joint spectral radius and path-complete graph Lyapunov
        // functions, SIAM Journal on Control and Optimization 52, 2014.
        let complete = [matrix([[-1.0, -1.0], [-4.0, 0.0]]), matrix([[3.0, 3.0], [-2.0, 1.0]])];
        // Example 2.8 of P. Parrilo, A. Jadbabaie, Approximation of the joint spectral radius using sum of squares, Linear Algebra and its
        // Applications 428, 2008: a single ellipse shows no bound below √2, and products do not close the gap.
        let squares = [matrix([[1.0, 0.0], [1.0, 0.0]]), matrix([[0.0, 1.0], [0.0, -1.0]])];
        let ratio = (1.0 + 5.0_f64.sqrt()) / 2.0;
        for (matrices, radius, length, width) in [
            (golden, ratio, 2, 1.0011),
            (complete, 3.917_384_715_148, 2, 1.0011),
            (squares, 1.0, 1, 1.2),
        ] {
            let system = SwitchedSystem::unconstrained(matrices.into()).unwrap();
            let found = system.growth_bounds(&CLOSE);
            // The radii have 12 digits.
            assert!((found.lower - radius).abs() < 1e-11, "{found:?}");
            assert_eq!(found.cycle.len(), length);
            assert!(radius <= found.upper && found.upper < width * radius, "{found:?}");
        }
    }

    #[test]
    fn the_controller_with_constrained_failures_of_philippe_grows_by_what_is_published() {
        // Section 4 of M. Philippe, R. Essick, G. E. Dullerud, R. M. Jungers, Automatica 72, 2016. B. Legat, P. Parrilo, R. M. Jungers,
        // Certifying unstability of switched systems using sum of squares programming, SIAM Journal on Control and Optimization 58,
        // 2020, have the cycle of 8 steps and its growth.
        let gains = [[-0.49, 0.27], [0.0, 0.27], [-0.49, 0.0], [0.0, 0.0]];
        let matrices = gains.map(|[p, q]| matrix([[0.94, 0.56], [0.14 + p, 0.46 + q]]));
        let edges = [
            [1, 2, 3],
            [2, 1, 2],
            [1, 3, 1],
            [3, 1, 2],
            [2, 3, 1],
            [3, 2, 3],
            [3, 3, 1],
            [3, 4, 4],
            [4, 3, 1],
        ];
        let transition = |[from, to, matrix]: [usize; 3]| Transition {
            from: from - 1,
            to: to - 1,
            matrix: matrix - 1,
        };
        let transitions = edges.map(transition).to_vec();
        let system = SwitchedSystem::new(matrices.into(), 4, transitions).unwrap();
        let found = system.growth_bounds(&CLOSE);
        // 16 digits, of a product of 8 matrices.
        assert!((found.lower - 0.974_817_197_937_207_4).abs() < 1e-14, "{found:?}");
        assert_eq!((found.cycle.len(), found.verdict()), (8, Verdict::Stable));
        // The bound by quadratic forms that a semidefinite program finds is 1.00356; products are below it.
        assert!(found.upper < 0.976, "{found:?}");
        let decided = system.growth_bounds(&SearchEnd { once_decided: true, ..CLOSE });
        assert_eq!(decided.verdict(), Verdict::Stable);
        // Where longer cycles are not tried, the upper bound stays above the growth.
        for (longest_cycle, lower) in [(1, 0.939_255_023_941_847_2), (6, 0.0)] {
            let found = system.growth_bounds(&SearchEnd { longest_cycle, ..CLOSE });
            assert!(found.lower >= lower - 1e-14 && found.lower < 0.974_8, "{found:?}");
            assert!((0.974_817_197_937_207_4..0.98).contains(&found.upper), "{found:?}");
        }
    }
}
