//! The discrete algebraic Riccati equation.

use crate::{Matrix, is_schur_stable, log_spectral_radius, solve_matrix, solve_stein};

/// Doublings of the horizon: enough for a loop whose deviations fall by 10⁻¹⁵ a step.
const DOUBLINGS: usize = 64;

/// A regulator problem in discrete time: the sum of `xᵀQx + 2xᵀSu + uᵀRu` over all steps `x' = Ax + Bu`.
#[derive(Clone, Debug)]
pub struct RegulatorProblem {
    /// States × states.
    pub a: Matrix,
    /// States × commands.
    pub b: Matrix,
    /// The weight of the states.
    pub q: Matrix,
    /// The weight of products of states and commands, states × commands.
    pub s: Matrix,
    /// The weight of the commands, positive definite.
    pub r: Matrix,
}

/// The solution of a regulator problem.
#[derive(Clone, Debug)]
pub struct RegulatorSolution {
    /// The gain of `u = −Kx`, commands × states.
    pub gain: Matrix,
    /// The cost-to-go matrix.
    pub cost: Matrix,
}

impl RegulatorProblem {
    /// The feedback that costs least; none if the iteration does not settle: the problem has no stabilising solution, or one too
    /// close to the edge of stability.
    ///
    /// The solution of `X = Q + AᵀXA − (AᵀXB + S)(R + BᵀXB)⁻¹(BᵀXA + Sᵀ)` is approached from a finite horizon by doubling, which
    /// converges quadratically (E. K.-W. Chu, H.-Y. Fan, W.-W. Lin, C.-S. Wang, *Structure-preserving algorithms for periodic
    /// discrete-time algebraic Riccati equations*, International Journal of Control 77, 2004).
    pub fn solve(&self) -> Option<RegulatorSolution> {
        let RegulatorProblem { a, b, q, s, r } = self;
        let n = a.rows();
        // Without products of states and commands.
        let removed = solve_matrix(r, &s.transposed())?;
        let mut power = a.clone();
        power.add_scaled(-1.0, &(b * &removed));
        let mut cost = q.clone();
        cost.add_scaled(-1.0, &(s * &removed));
        let mut reach = b * &solve_matrix(r, &b.transposed())?;
        let mut settled = false;
        for _ in 0..DOUBLINGS {
            let mut coupling = &reach * &cost;
            coupling.add_scaled(1.0, &Matrix::identity(n));
            let moved = solve_matrix(&coupling, &power)?;
            let reached = solve_matrix(&coupling, &reach)?;
            let more = &(&power.transposed() * &cost) * &moved;
            reach.add_scaled(1.0, &(&(&power * &reached) * &power.transposed()));
            cost.add_scaled(1.0, &more);
            power = &power * &moved;
            symmetrise(&mut reach);
            symmetrise(&mut cost);
            // Entry by entry: states have units, and a covariance in m² is small beside one in V².
            if relative_diagonal(&more, &cost) <= 1e-16 {
                settled = true;
                break;
            }
        }
        let gain = self.gain(&cost)?;
        (settled && gain.is_finite()).then_some(RegulatorSolution { gain, cost })
    }

    /// The solution, if its loop is stable, `doubtful` ones by more than rounding: by a factor of `1 − 10⁻⁹` per step.
    pub(crate) fn stabilising(&self, doubtful: bool) -> Option<RegulatorSolution> {
        let solution = self.solve()?;
        let closed = self.closed(&solution.gain);
        let decays = !doubtful || log_spectral_radius(&closed) < -1e-9;
        (decays && is_schur_stable(&closed)).then_some(solution)
    }

    /// The feedback that costs least where some commands cost nothing at once, as those that act later: `price` is a weight of the
    /// commands of about the right size. None as for [`RegulatorProblem::solve`].
    ///
    /// From a gain that the price finds, by Newton's iteration (G. Hewer, *An iterative technique for the computation of the steady
    /// state gains for the discrete optimal regulator*, IEEE Transactions on Automatic Control 16, 1971).
    pub fn solve_from(&self, price: &Matrix) -> Option<RegulatorSolution> {
        let priced = RegulatorProblem { r: self.r.plus(price), ..self.clone() };
        self.improve(priced.solve()?.gain)
    }

    /// The feedback that costs least, from a gain that stabilises, by Newton's iteration; none if that gain does not stabilise.
    pub(crate) fn improve(&self, mut gain: Matrix) -> Option<RegulatorSolution> {
        let (mut before, mut change): (Option<Matrix>, f64) = (None, f64::INFINITY);
        for _ in 0..DOUBLINGS {
            let closed = self.closed(&gain);
            if !is_schur_stable(&closed) {
                return None;
            }
            // Q + KᵀRK − SK − KᵀSᵀ of the loop that the gain closes.
            let crossed = &self.s * &gain;
            let mut weight = gain.transposed().congruence(&self.r).plus(&self.q);
            weight.add_scaled(-1.0, &crossed);
            weight.add_scaled(-1.0, &crossed.transposed());
            let mut cost = solve_stein(&closed.transposed(), vec![weight]).remove(0);
            symmetrise(&mut cost);
            gain = self.gain(&cost)?;
            let off = before.map_or(f64::INFINITY, |mut before| {
                before.add_scaled(-1.0, &cost);
                relative_diagonal(&before, &cost)
            });
            // The last steps are those of rounding.
            if off.is_nan() || off <= 1e-15 || (off < 1e-6 && off >= change) {
                return (!off.is_nan()).then_some(RegulatorSolution { gain, cost });
            }
            (before, change) = (Some(cost), off);
        }
        None
    }

    /// `R + BᵀXB`: what commands cost with the cost-to-go `X`.
    pub(crate) fn price(&self, cost: &Matrix) -> Matrix {
        self.b.transposed().congruence(cost).plus(&self.r)
    }

    /// The gain of least cost with this cost-to-go; none if commands cost nothing.
    fn gain(&self, cost: &Matrix) -> Option<Matrix> {
        let moved = &(&self.b.transposed() * cost) * &self.a;
        solve_matrix(&self.price(cost), &moved.plus(&self.s.transposed()))
    }

    /// `A − BK`.
    pub fn closed(&self, gain: &Matrix) -> Matrix {
        let mut closed = self.a.clone();
        closed.add_scaled(-1.0, &(&self.b * gain));
        closed
    }
}

/// The largest size of an entry of the diagonal of `part`, over that of `whole`: independent of the units of states.
pub(crate) fn relative_diagonal(part: &Matrix, whole: &Matrix) -> f64 {
    let ratio = |i: usize| match part[(i, i)].abs() {
        0.0 => 0.0,
        size => size / whole[(i, i)].abs(),
    };
    (0..part.rows()).map(ratio).fold(0.0, |most: f64, x| if x.is_nan() { x } else { most.max(x) })
}

pub(crate) fn symmetrise(matrix: &mut Matrix) {
    let back = matrix.transposed();
    matrix.add_scaled(1.0, &back);
    matrix.entries_mut().iter_mut().for_each(|x| *x *= 0.5);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Discretisation;

    /// A regulator as WPILib designs it: exact steps, and weights `1/q²` and `1/r²` of a sum.
    fn wpilib(
        a: [[f64; 2]; 2],
        b: [f64; 2],
        q: [f64; 2],
        r: f64,
        h: f64,
    ) -> (RegulatorProblem, Matrix) {
        let a = Matrix::from_rows(&a).unwrap();
        let b = Matrix::from_fn(2, 1, |i, _| b[i]);
        let Discretisation { phi, gamma } = Discretisation::exact(&a, &b, h);
        let problem = RegulatorProblem {
            a: phi,
            b: gamma,
            q: Matrix::diagonal(&q),
            s: Matrix::zeros(2, 1),
            r: Matrix::diagonal(&[r]),
        };
        let gain = problem.solve().unwrap().gain;
        (problem, gain)
    }

    #[test]
    fn gains_are_those_of_the_tests_of_wpilib() {
        // `MatrixOverloadsWithDoubleIntegrator` of LinearQuadraticRegulatorTest.cpp.
        let (kv, ka) = (3.02, 0.642);
        let a = [[0.0, 1.0], [0.0, -kv / ka]];
        let (_, gain) = wpilib(a, [0.0, 1.0 / ka], [1.0, 0.2], 0.25, 0.005);
        let wanted = [1.996_001_778_653_728_7, 0.511_821_283_510_927_3];
        for (found, wanted) in gain.entries().iter().zip(wanted) {
            // Ten digits, as that test has it.
            assert!((found - wanted).abs() < 1e-10, "{found} {wanted}");
        }
    }

    #[test]
    fn gains_that_compensate_half_a_period_are_those_of_the_tests_of_wpilib() {
        // `LatencyCompensate`: an elevator of 8 kg on four motors of 0.71 N m, 134 A, 0.7 A and 18730 rpm at 12 V.
        let (mass, radius, gear) = (8.0, 0.75 * 0.0254, 14.67);
        let resistance = 12.0 / (4.0 * 134.0);
        let torque = 0.71 / 134.0;
        let speed = 18_730.0 * core::f64::consts::TAU / 60.0 / (12.0 - resistance * 4.0 * 0.7);
        let damping = gear * gear * torque / (resistance * radius * radius * mass * speed);
        let push = gear * torque / (resistance * radius * mass);
        let (problem, gain) =
            wpilib([[0.0, 1.0], [0.0, -damping]], [0.0, push], [100.0, 25.0], 1.0 / 144.0, 0.02);
        // K·(A − BK)^½, with the root of a matrix of two rows by its trace and determinant.
        let closed = problem.closed(&gain);
        let root = (closed[(0, 0)] * closed[(1, 1)] - closed[(0, 1)] * closed[(1, 0)]).sqrt();
        let mut half = closed.clone();
        half.add_scaled(root, &Matrix::identity(2));
        let found = (&gain * &half).scaled((closed.trace() + 2.0 * root).sqrt().recip());
        for (found, wanted) in found.entries().iter().zip([8.971_159_41, 0.079_048_81]) {
            // That test allows 10⁻³; 4·10⁻⁶ were found, beside constants of the motor that have three digits.
            assert!((found - wanted).abs() < 1e-5, "{found} {wanted}");
        }
    }

    #[test]
    fn the_solution_solves_the_equation_with_products_of_states_and_commands() {
        let a = Matrix::from_fn(5, 5, |i, j| ((3 * i + 5 * j) % 7) as f64 / 4.0 - 0.6);
        let b = Matrix::from_fn(5, 2, |i, j| ((i + 2 * j) % 3) as f64 - 0.5);
        let q = Matrix::diagonal(&[1.0, 2.0, 0.5, 1.0, 3.0]);
        let s = Matrix::from_fn(5, 2, |i, j| 0.1 * ((i + j) % 2) as f64);
        let r = Matrix::diagonal(&[1.0, 0.5]);
        let problem = RegulatorProblem { a, b, q, s, r };
        let RegulatorSolution { gain, cost } = problem.solve().unwrap();
        assert!(is_schur_stable(&problem.closed(&gain)));
        // X = Q + AᵀX(A − BK) − SK.
        let back = &problem.a.transposed() * &cost;
        let mut right = (&back * &problem.closed(&gain)).plus(&problem.q);
        right.add_scaled(-1.0, &(&problem.s * &gain));
        right.add_scaled(-1.0, &cost);
        assert!(right.largest() < 1e-12 * cost.largest(), "{}", right.largest());
    }
}
