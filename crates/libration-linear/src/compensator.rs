//! Compensators of least cost of a plant whose periods are drawn.

use crate::augmented_plant::AugmentedPlant;
use crate::riccati::{relative_diagonal, symmetrise};
use crate::{Matrix, RegulatorProblem, RegulatorSolution, solve_matrix, solve_stein};

/// The feedback `u = −L x̂` of the estimated state of an augmented plant, `x̂ = x̃ + K(y − Cx̃)` with the prediction
/// `x̃' = (A − BL)x̂` of the mean plant.
pub(crate) struct Compensator {
    /// `L`, commands × states.
    pub(crate) gain: Matrix,
    /// `K`, states × measurements; none if the states are known.
    pub(crate) filter: Option<Matrix>,
    /// The mean cost of a period.
    pub(crate) cost: f64,
}

/// The equation without a solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Unsolved {
    /// That of the regulator for the mean period.
    Regulator,
    /// That of the filter for the mean period.
    Filter,
    /// Those of second moments under what is drawn.
    Random,
}

/// A regulator and a filter, and what follows from them.
struct Pair {
    regulator: RegulatorSolution,
    filter: RegulatorSolution,
    /// `K`.
    correction: Matrix,
    /// `Ŝ`, the cost-to-go of the error of the estimate: what the regulator pays for acting on it.
    error_cost: Matrix,
    /// `(I − KC)ᵀŜ(I − KC)`, the cost-to-go of the error of the prediction.
    predicted_error_cost: Matrix,
    /// The second moments of states and commands.
    moments: Matrix,
}

impl AugmentedPlant {
    /// The feedback of all states, which are known: `S = E[Q + AᵀSA] − …` over the periods that are drawn.
    ///
    /// `price` is a weight of commands of about the right size. (W. L. De Koning, *Infinite horizon optimal control of linear
    /// discrete time systems with stochastic parameters*, Automatica 18, 1982.)
    pub(crate) fn state_feedback(&self, price: &Matrix) -> Result<Compensator, Unsolved> {
        let none = || Unsolved::Random;
        let problem = self.regulator_problem(None);
        let mut regulator = problem.solve_from(price).ok_or(Unsolved::Regulator)?;
        let (mut iteration, mut settled) = (Iteration::default(), !self.is_random);
        while !settled {
            let more = self.off.gathered(&regulator.cost);
            let problem = self.regulator_problem(more.as_ref());
            let next = problem.improve(regulator.gain.clone()).ok_or_else(none)?;
            let change = change(&next.cost, &regulator.cost);
            regulator = next;
            settled = iteration.has_settled(change).ok_or_else(none)?;
        }
        let cost = regulator.cost.inner(&self.process_noise) + self.constant;
        Ok(Compensator { gain: regulator.gain, filter: None, cost })
    }

    /// The feedback of states that a filter estimates. `prices` are weights of commands, and variances of measurements, of about the
    /// right sizes.
    ///
    /// If nothing is drawn, regulator and filter are independent. Else they are coupled: errors of the prediction that are in
    /// proportion to the state are noise for the filter and a cost for the regulator. With the deviations `Ã` and `B̃`, the error
    /// `e` of the estimate, and `E[e x̂ᵀ] = 0`,
    ///
    /// `M = E[APAᵀ] + E[(Ã − B̃L)P̂(Ã − B̃L)ᵀ] + W`, `P = (I − KC)M`, `P̂ = (A − BL)P̂(A − BL)ᵀ + K(CMCᵀ + V)Kᵀ`,
    ///
    /// and dual equations for `S` and `Ŝ` (W. L. De Koning, *Compensatability and optimal compensation of systems with white
    /// parameters*, IEEE Transactions on Automatic Control 37, 1992, here with a filter that uses the newest measurement). They are
    /// Riccati equations of the mean plant with additional noise and cost, solved until these no longer change.
    pub(crate) fn output_feedback(&self, prices: [&Matrix; 2]) -> Result<Compensator, Unsolved> {
        let none = || Unsolved::Random;
        let [price, variance] = prices;
        let problem = self.regulator_problem(None);
        let regulator = problem.solve_from(price).ok_or(Unsolved::Regulator)?;
        let filter = self.filter_problem(None).solve_from(variance).ok_or(Unsolved::Filter)?;
        let mut pair = self.pair(&problem, regulator, filter).ok_or(Unsolved::Filter)?;
        let (mut iteration, mut settled) = (Iteration::default(), !self.is_random);
        while !settled {
            let costs = self.off.gathered(&pair.regulator.cost.plus(&pair.predicted_error_cost));
            let problem = self.regulator_problem(costs.as_ref());
            let regulator = problem.improve(pair.regulator.gain.clone()).ok_or_else(none)?;
            let noise = self.off.spread(&pair.moments);
            let filter = self.filter_problem(Some(&noise));
            let filter = filter.improve(pair.filter.gain.clone()).ok_or_else(none)?;
            let next = self.pair(&problem, regulator, filter).ok_or_else(none)?;
            let change = [
                change(&next.regulator.cost, &pair.regulator.cost),
                change(&next.filter.cost, &pair.filter.cost),
                change(&next.error_cost, &pair.error_cost),
                change(&next.moments, &pair.moments),
            ];
            pair = next;
            let change = change.into_iter().fold(0.0, larger);
            settled = iteration.has_settled(change).ok_or_else(none)?;
        }
        let received = pair.correction.congruence(&self.measurement_noise);
        let cost = pair.regulator.cost.plus(&pair.predicted_error_cost).inner(&self.process_noise)
            + pair.error_cost.inner(&received)
            + self.constant;
        Ok(Compensator { gain: pair.regulator.gain, filter: Some(pair.correction), cost })
    }

    /// What follows from a regulator and a filter; none if the innovations have a singular covariance.
    fn pair(
        &self,
        problem: &RegulatorProblem,
        regulator: RegulatorSolution,
        filter: RegulatorSolution,
    ) -> Option<Pair> {
        let (size, m) = (self.b.rows(), self.b.columns());
        let gain = &regulator.gain;
        let error = &filter.cost;
        let seen = &self.c * error;
        let innovation = (&seen * &self.c.transposed()).plus(&self.measurement_noise);
        let correction = solve_matrix(&innovation, &seen)?.transposed();
        let mut kept = Matrix::identity(size);
        kept.add_scaled(-1.0, &(&correction * &self.c));
        // P, P̂, and from both the moments of states and commands.
        let received = correction.congruence(&self.measurement_noise);
        let rest = kept.congruence(error).plus(&received);
        let corrected = correction.congruence(&innovation);
        let estimate = solve_stein(&problem.closed(gain), vec![corrected]).remove(0);
        let commands = (gain * &estimate).scaled(-1.0);
        let mut moments = Matrix::zeros(size + m, size + m);
        moments.set_block((0, 0), &rest.plus(&estimate));
        moments.set_block((size, 0), &commands);
        moments.set_block((0, size), &commands.transposed());
        moments.set_block((size, size), &gain.congruence(&estimate));
        symmetrise(&mut moments);
        let paid = gain.transposed().congruence(&problem.price(&regulator.cost));
        let decays = (&kept * &self.a).transposed();
        let error_cost = solve_stein(&decays, vec![paid]).remove(0);
        let mut predicted_error_cost = kept.transposed().congruence(&error_cost);
        symmetrise(&mut predicted_error_cost);
        let finite = moments.is_finite() && error_cost.is_finite();
        let pair =
            Pair { regulator, filter, correction, error_cost, predicted_error_cost, moments };
        finite.then_some(pair)
    }
}

/// Largest relative change of what rounding leaves where several states are measured almost without noise: the covariance of what a
/// sample shows has eigenvalues of very different sizes. The cost, which is least, changes by the square of it.
const ROUNDING: f64 = 1e-6;

/// The relative change of a matrix, independent of units.
fn change(next: &Matrix, before: &Matrix) -> f64 {
    let mut change = next.clone();
    change.add_scaled(-1.0, before);
    relative_diagonal(&change, next)
}

fn larger(a: f64, b: f64) -> f64 {
    if a > b || a.is_nan() { a } else { b }
}

/// An iteration with a fixed point.
#[derive(Default)]
struct Iteration {
    /// The relative change of each step.
    changes: Vec<f64>,
}

impl Iteration {
    /// Steps in which changes must become less.
    const SPAN: usize = 100;

    /// Whether a step with this relative change was the last one; none if the iteration does not settle.
    ///
    /// The rest is that of a sequence that settles in equal ratios.
    fn has_settled(&mut self, change: f64) -> Option<bool> {
        let before = self.changes.last().copied();
        self.changes.push(change);
        if change.is_nan() {
            return None;
        }
        let settled = before.is_some_and(|before| {
            let ratio = (change / before).clamp(0.0, 0.9999);
            change * ratio / (1.0 - ratio) <= 1e-14 || (change < ROUNDING && change >= before)
        });
        let count = self.changes.len();
        let earlier = count.checked_sub(2 * Self::SPAN).map(|_| self.changes[count - Self::SPAN]);
        match earlier {
            Some(earlier) if !settled && change > 0.98 * earlier => None,
            _ => Some(settled),
        }
    }
}
