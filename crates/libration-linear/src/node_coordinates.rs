//! Coordinates of a switched system in which its steps are short.

use crate::hessenberg::balance;
use crate::spectral_norm::spectral_norm;
use crate::{Matrix, SwitchedSystem, Transition, solve_matrix};

/// Coordinates `F x` at each node of a switched system. The longest step in them is an upper bound of its growth: the norms
/// `‖F x‖` are a multinorm (M. Philippe, R. Essick, G. E. Dullerud, R. M. Jungers, *Stability of discrete-time switching systems with
/// constrained switching sequences*, Automatica 72, 2016).
#[derive(Clone)]
pub(crate) struct NodeCoordinates {
    forth: Vec<Matrix>,
    back: Vec<Matrix>,
}

/// The steps of a switched system in the coordinates of its nodes.
pub(crate) struct Steps {
    /// The matrix of each transition.
    pub(crate) matrices: Vec<Matrix>,
    /// The largest norm of a step.
    pub(crate) longest: f64,
    /// A bound of what rounding takes from a step.
    pub(crate) rounding: f64,
}

/// The value of the objective at some coordinates, and its slope at each node.
struct Slope {
    value: f64,
    directions: Vec<Matrix>,
    steepest: f64,
}

impl NodeCoordinates {
    /// The same coordinates at all nodes, in which the rows and columns of the steps are about equally large.
    pub(crate) fn balanced(system: &SwitchedSystem) -> Self {
        let n = system.size();
        let mut sizes = Matrix::zeros(n, n);
        for matrix in system.matrices() {
            sizes.add_scaled(1.0, &matrix.map(f64::abs));
        }
        let factors = balance(&mut sizes);
        let inverse: Vec<f64> = factors.iter().map(|x| x.recip()).collect();
        let at_all = |diagonal: &[f64]| vec![Matrix::diagonal(diagonal); system.nodes()];
        NodeCoordinates { forth: at_all(&inverse), back: at_all(&factors) }
    }

    /// The same coordinates for [`SwitchedSystem::refined`].
    pub(crate) fn refined(&self, system: &SwitchedSystem) -> Self {
        let at = |all: &[Matrix]| -> Vec<Matrix> {
            system.transitions().iter().map(|transition| all[transition.to].clone()).collect()
        };
        NodeCoordinates { forth: at(&self.forth), back: at(&self.back) }
    }

    /// The steps in these coordinates.
    pub(crate) fn steps(&self, system: &SwitchedSystem) -> Steps {
        let n = system.size() as f64;
        let norm = |m: &Matrix| m.inner(m).sqrt();
        let off: Vec<f64> = self
            .forth
            .iter()
            .zip(&self.back)
            .map(|(forth, back)| {
                let mut product = forth * back;
                product.add_scaled(-1.0, &Matrix::identity(system.size()));
                norm(&product)
            })
            .collect();
        let matrices = self.transformed(system);
        let (mut longest, mut rounding) = (0.0_f64, 0.0_f64);
        for (i, (step, transition)) in matrices.iter().zip(system.transitions()).enumerate() {
            let length = spectral_norm(step);
            longest = longest.max(length);
            // Two products, each with n roundings in an entry, and coordinates back that are not quite the inverse.
            let factors =
                [&self.forth[transition.to], system.matrix(i), &self.back[transition.from]];
            let size: f64 = factors.map(norm).iter().product();
            let lost = 2.0 * n * f64::EPSILON * size + 2.0 * off[transition.from] * length;
            rounding = rounding.max(lost);
        }
        Steps { matrices, longest, rounding }
    }

    fn transformed(&self, system: &SwitchedSystem) -> Vec<Matrix> {
        let step = |(i, transition): (usize, &Transition)| {
            &(&self.forth[transition.to] * system.matrix(i)) * &self.back[transition.from]
        };
        system.transitions().iter().enumerate().map(step).collect()
    }

    /// Shortens the steps: descends on the sum of the `2p`-th powers of all their singular values with `p = 2^doublings`.
    ///
    /// Along geodesics of the positive definite matrices `FᵀF` the logarithm of that sum is convex, so that descent along its slope finds its least
    /// value (S. Sra, R. Hosseini, *Conic geometric optimization on the manifold of positive definite matrices*, SIAM Journal on
    /// Optimization 25, 2015). For large powers it is that of the longest step, which semidefinite programs would find.
    pub(crate) fn descend(&mut self, system: &SwitchedSystem, doublings: u32, iterations: usize) {
        let mut rate = 0.5_f64.powi(doublings as i32);
        let mut here = self.slope(system, doublings);
        for _ in 0..iterations {
            if here.steepest.is_nan() || here.steepest <= 1e-9 {
                break;
            }
            // Beyond this a step of the descent is a leap.
            rate = rate.min(2.0 / here.steepest);
            let better = loop {
                if let Some(tried) = self.moved(&here.directions, rate) {
                    let there = tried.slope(system, doublings);
                    if there.value < here.value {
                        break Some((tried, there));
                    }
                }
                rate *= 0.5;
                if rate * here.steepest < 1e-7 {
                    break None;
                }
            };
            let Some((tried, there)) = better else { break };
            let gained = here.value - there.value;
            (*self, here) = (tried, there);
            rate *= 1.6;
            if gained < 1e-7 {
                break;
            }
        }
    }

    /// The coordinates after a step along geodesics, in second order; none where rounding makes them singular.
    fn moved(&self, directions: &[Matrix], rate: f64) -> Option<Self> {
        let mut forth = Vec::with_capacity(self.forth.len());
        let mut back = Vec::with_capacity(self.back.len());
        for (i, direction) in directions.iter().enumerate() {
            // 1 + x + x²/2 of a symmetric x is positive definite.
            let x = direction.scaled(0.5 * rate);
            let mut turn = Matrix::identity(x.rows());
            turn.add_scaled(0.5, &(&x * &x));
            turn.add_scaled(1.0, &x);
            let next = &turn * &self.forth[i];
            back.push(solve_matrix(&next, &Matrix::identity(x.rows()))?);
            forth.push(next);
        }
        Some(NodeCoordinates { forth, back })
    }

    fn slope(&self, system: &SwitchedSystem, doublings: u32) -> Slope {
        let steps = self.transformed(system);
        let largest = steps.iter().map(|step| step.inner(step)).fold(0.0, f64::max);
        let n = system.size();
        let mut directions = vec![Matrix::zeros(n, n); system.nodes()];
        let mut total = 0.0;
        let power = |mut square: Matrix| {
            square = square.scaled(largest.recip());
            for _ in 0..doublings {
                square.normalise(1.0);
                square = &square * &square;
            }
            square
        };
        for (step, transition) in steps.iter().zip(system.transitions()) {
            let back = step.transposed();
            let right = power(&back * step);
            total += right.trace();
            directions[transition.from].add_scaled(1.0, &right);
            directions[transition.to].add_scaled(-1.0, &power(step * &back));
        }
        let mut steepest = 0.0_f64;
        for direction in &mut directions {
            *direction = direction.scaled(total.recip());
            steepest = steepest.max(direction.row_sum_norm());
        }
        let value = largest.ln() + total.ln() * 0.5_f64.powi(doublings as i32);
        Slope { value, directions, steepest }
    }
}
