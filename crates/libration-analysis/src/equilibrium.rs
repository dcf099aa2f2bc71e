//! Equilibria of systems that are known when the program runs.

use libration_core::number::Dual;
use libration_equations::Dynamics;
use libration_linear::{Matrix, SingularValues};

use super::conserved_sums::ConservedSums;
use super::equilibrium_search::EquilibriumSearch;

/// The part of the largest singular value of the slopes, each row and column scaled to 1, below which one is zero.
const SINGULAR: f64 = 1e-10;

/// The part of the scale of a state by which it is moved to see whether other equilibria are near.
const NEIGHBOUR: f64 = 1e-3;

/// The part of the scale of a state up to which a coordinate may be the rounding of zero.
const SMALL: f64 = 1e-6;

/// The largest number of unknowns of the damped search, and of equilibria whose neighbours are examined: both decompose matrices.
const MOST_UNKNOWNS: usize = 64;

/// A state at which the accelerations are zero.
#[derive(Clone, Debug, PartialEq)]
pub struct Equilibrium {
    /// Positions, velocities and inputs.
    pub state: Vec<f64>,
    /// The largest absolute acceleration there.
    pub residual: f64,
    /// The derivatives of the accelerations there: degrees of freedom × (positions, velocities and inputs). Those that change by their
    /// own size where the equilibrium may also lie are zero.
    pub jacobian: Matrix,
    /// The dimension of the set of equilibria near this one; 0 if it is isolated.
    pub continuum: usize,
    /// The number of directions in which all derivatives are zero, without other equilibria. Higher derivatives decide there.
    pub undecided: usize,
}

impl Equilibrium {
    /// The equilibrium near `start`: positions, velocities and inputs. The search changes the entries in `unknowns`.
    ///
    /// Of the ends of Newton's method with halved steps and of a damped one, whose steps are the shortest, it is the nearer one. If both
    /// fail, it is where the start ends with its velocities taken away all the time. Derivatives are exact.
    ///
    /// # Errors
    /// The state with the least acceleration, if no shift of the unknowns by 10⁻⁸ of the larger of 1 and their values causes what is left.
    pub fn near(
        dynamics: &Dynamics,
        start: &[f64],
        unknowns: &[usize],
    ) -> Result<Equilibrium, Equilibrium> {
        let search = EquilibriumSearch::new(dynamics, start, unknowns);
        let newton = search.newton(start);
        let damped = match unknowns.len() > MOST_UNKNOWNS {
            true => newton.clone(),
            false => search.damped(start),
        };
        let distance = |state: &[f64]| search.distance(state);
        let rests = |state: &Vec<f64>| search.rests(state);
        // The same to rounding: that of Newton's method, which is polished.
        let same = SMALL * search.scale();
        let found = match (rests(&newton), rests(&damped)) {
            (true, true) if distance(&damped) < distance(&newton) - same => damped,
            (true, _) => newton,
            (false, true) => damped,
            (false, false) => {
                let flow = search.newton(&search.flow());
                // Near a pole of the accelerations a small shift causes all of them.
                match rests(&flow) && search.residual(&flow) <= search.residual(start) {
                    true => flow,
                    false => return Err(Equilibrium::at(&search, newton)),
                }
            }
        };
        Ok(Equilibrium::polished(&search, found))
    }

    /// The equilibrium at which Newton's method ends, whose set of neighbours is not examined. It takes a fraction of the time of
    /// [`near`](Equilibrium::near), as a page requires that searches hundreds of times.
    ///
    /// # Errors
    /// As for [`near`](Equilibrium::near).
    pub fn by_newton(
        dynamics: &Dynamics,
        start: &[f64],
        unknowns: &[usize],
    ) -> Result<Equilibrium, Equilibrium> {
        let search = EquilibriumSearch::new(dynamics, start, unknowns);
        let end = search.newton(start);
        let rests = search.rests(&end);
        let found = Equilibrium::at(&search, end);
        if rests { Ok(found) } else { Err(found) }
    }

    /// The equilibrium with the values that conserved sums have at their start, by the damped method; none if there is no such equilibrium.
    pub fn with_sums(
        dynamics: &Dynamics,
        start: &[f64],
        unknowns: &[usize],
        sums: &ConservedSums,
    ) -> Option<Equilibrium> {
        if unknowns.len() > MOST_UNKNOWNS {
            return None;
        }
        let search = EquilibriumSearch::new(dynamics, start, unknowns).with_sums(sums)?;
        let mut found = search.damped(start);
        if !search.rests(&found) {
            found = search.damped(&search.flow());
        }
        let rests = search.rests(&found) && search.residual(&found) <= search.residual(start);
        rests.then(|| Equilibrium::polished(&search, found))
    }

    /// A state with its derivatives.
    fn at(search: &EquilibriumSearch<'_>, state: Vec<f64>) -> Self {
        let (residual, jacobian) = (search.residual(&state), search.jacobian(&state));
        Equilibrium { state, residual, jacobian, continuum: 0, undecided: 0 }
    }

    /// An equilibrium without rounding, and the set of those near it.
    fn polished(search: &EquilibriumSearch<'_>, mut state: Vec<f64>) -> Self {
        let scale = search.scale();
        for &i in search.unknowns() {
            let mut without = state.clone();
            without[i] = 0.0;
            let is_small = state[i] != 0.0 && state[i].abs() <= SMALL * scale;
            if is_small && search.residual(&without) <= search.residual(&state) {
                state = without;
            }
        }
        let search = search.from(&state);
        let mut found = Equilibrium::at(&search, state);
        if search.unknowns().len() <= MOST_UNKNOWNS {
            found.remove_rounding(&search);
            found.examine_neighbours(&search);
        }
        found
    }

    /// Sets derivatives to zero that are not known: they change by their own size within the distance in which the equilibrium may lie.
    fn remove_rounding(&mut self, search: &EquilibriumSearch<'_>) {
        let unknowns = search.unknowns();
        let distance = search.uncertainty(&self.state);
        let mut change = Matrix::zeros(self.jacobian.rows(), self.jacobian.columns());
        for &place in unknowns {
            let beside = [-distance, distance].map(|shift| {
                let mut state = self.state.clone();
                state[place] += shift;
                search.jacobian(&state)
            });
            for (i, most) in change.entries_mut().iter_mut().enumerate() {
                let own = self.jacobian.entries()[i];
                let sizes = beside.iter().map(|beside| (beside.entries()[i] - own).abs());
                *most += sizes.fold(0.0, f64::max);
            }
        }
        for (own, change) in self.jacobian.entries_mut().iter_mut().zip(change.entries()) {
            // Where one is infinite, nothing is known.
            if own.abs() <= *change && change.is_finite() {
                *own = 0.0;
            }
        }
    }

    /// Counts the directions in which the derivatives are zero, and those of them with other equilibria.
    fn examine_neighbours(&mut self, search: &EquilibriumSearch<'_>) {
        let unknowns = search.unknowns();
        let slopes = search.slopes_of(&self.jacobian);
        let largest = |sizes: &mut dyn Iterator<Item = f64>| {
            let most = sizes.fold(0.0, f64::max);
            if most > 0.0 { most } else { 1.0 }
        };
        let rows: Vec<f64> = (0..slopes.rows())
            .map(|i| largest(&mut slopes.row(i).iter().map(|x| x.abs())))
            .collect();
        let columns: Vec<f64> = (0..slopes.columns())
            .map(|j| largest(&mut (0..slopes.rows()).map(|i| slopes[(i, j)].abs() / rows[i])))
            .collect();
        let balanced = Matrix::from_fn(slopes.rows(), slopes.columns(), |i, j| {
            slopes[(i, j)] / rows[i] / columns[j]
        });
        let Some(values) = SingularValues::of(&balanced) else { return };
        let rank = values.rank(SINGULAR);
        let distance = NEIGHBOUR * search.scale();
        let has_neighbour = |k: usize| {
            let direction: Vec<f64> =
                (0..unknowns.len()).map(|j| values.right[(j, k)] / columns[j]).collect();
            let size = direction.iter().map(|x| x * x).sum::<f64>().sqrt();
            let mut state = self.state.clone();
            for (&place, x) in unknowns.iter().zip(&direction) {
                state[place] += distance * x / size;
            }
            let end = search.damped(&state);
            search.rests(&end) && search.distance(&end) >= 0.5 * distance
        };
        let singular = unknowns.len() - rank;
        self.continuum = (rank..unknowns.len()).filter(|&k| has_neighbour(k)).count();
        self.undecided = singular - self.continuum;
    }
}

/// The derivatives of the accelerations by positions, velocities and inputs, exact to rounding: degrees of freedom × inputs of the
/// program.
pub fn jacobian(dynamics: &Dynamics, at: &[f64]) -> Matrix {
    let mut accelerations = dynamics.accelerations().on::<Dual<f64>>();
    let mut jacobian = Matrix::zeros(dynamics.degrees(), at.len());
    let mut inputs: Vec<Dual<f64>> = at.iter().map(|&x| Dual::constant(x)).collect();
    for j in 0..at.len() {
        inputs[j] = Dual::variable(at[j]);
        for (i, acceleration) in accelerations.run(&inputs).enumerate() {
            jacobian[(i, j)] = acceleration.du;
        }
        inputs[j] = Dual::constant(at[j]);
    }
    jacobian
}

/// The derivative of the rate of coordinate `row` of positions and velocities by entry `column` of positions, velocities and inputs,
/// from the derivatives of the accelerations.
pub fn rate_derivative(jacobian: &Matrix, row: usize, column: usize) -> f64 {
    let degrees = jacobian.rows();
    match row.checked_sub(degrees) {
        Some(row) => jacobian[(row, column)],
        // The rate of a position is its velocity.
        None => f64::from(u8::from(column == row + degrees)),
    }
}

#[cfg(test)]
mod tests;
