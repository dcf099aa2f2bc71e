//! Forces between pairs of bodies from a potential that is an expression.

use std::sync::Arc;

use libration_batch::ColumnProgram;
use libration_core::number::{Dual, TwoFloat};
use libration_core::{Elementary, Scalar};
use libration_equations::{EquationError, EquationErrorKind, Program, Recorded};

/// The inputs of a potential: the distance, and mass and charge of the body that comes first in the list and of the other.
const NAMES: [&str; 5] = ["r", "m1", "m2", "q1", "q2"];

/// The potential energy of two bodies as an expression of their distance `r`, masses `m1`, `m2` and charges `q1`, `q2`; body 1 is that
/// which comes first in the list.
///
/// Forces are its derivative, by automatic differentiation, along the line between the bodies: they are opposite to the last bit.
#[derive(Clone, Debug)]
pub struct PairPotential {
    text: String,
    parameters: Vec<(String, f64)>,
    /// From the offset of body and other to the force on the body.
    force: Program,
    /// From the offset of body and other to the energy of both.
    energy: Program,
    /// From the offset to the second derivative of the energy along it.
    stiffness: Program,
    columns: Arc<[ColumnProgram; 2]>,
}

impl PartialEq for PairPotential {
    fn eq(&self, other: &Self) -> bool {
        self.text == other.text && self.parameters == other.parameters
    }
}

/// What a pair is evaluated from: the offset from a body to another, and the rest of [`NAMES`].
pub(crate) type Pair = [f64; 7];

impl PairPotential {
    /// The potential of an expression, in the units of the bodies; `parameters` are other names in it.
    ///
    /// # Errors
    /// [`EquationError`], with the place in the text: an expression that is wrong or does not depend on `r`, or a parameter that it does not
    /// have.
    pub fn new(text: &str, parameters: &[(String, f64)]) -> Result<Self, EquationError> {
        let potential = Program::of_expression(PairPotential::KEY, text, &NAMES, parameters)?;
        if !potential.inputs_in_use().any(|input| input == 0) {
            return Err(PairPotential::fault(EquationErrorKind::Independent(NAMES[0])));
        }
        let force = Program::record(7, |x| force(&potential, x).to_vec());
        let energy = Program::record(7, |x| vec![value(&potential, distance(x), &x[3..])]);
        let stiffness = Program::record(7, |x| {
            let inner = Dual { re: distance(x), du: Recorded::one() };
            let r = Dual { re: inner, du: Dual::constant(Recorded::one()) };
            let rest: Vec<_> = x[3..].iter().map(|&x| Dual::constant(Dual::constant(x))).collect();
            vec![value(&potential, r, &rest).du.du]
        });
        let columns = Arc::new([&force, &energy].map(ColumnProgram::new));
        let (text, parameters) = (text.to_owned(), parameters.to_vec());
        Ok(PairPotential { text, parameters, force, energy, stiffness, columns })
    }

    fn fault(kind: EquationErrorKind) -> EquationError {
        EquationError { key: PairPotential::KEY.to_owned(), span: None, kind }
    }

    /// The key of the expression in errors and files.
    pub const KEY: &str = "pair-potential";

    /// The expression.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Other names in the expression, with their values.
    pub fn parameters(&self) -> &[(String, f64)] {
        &self.parameters
    }

    pub(crate) fn force_columns(&self) -> &ColumnProgram {
        &self.columns[0]
    }

    pub(crate) fn energy_columns(&self) -> &ColumnProgram {
        &self.columns[1]
    }

    /// The energy of two bodies and its derivative by their distance.
    pub(crate) fn terms(&self, pair: &Pair) -> [f64; 2] {
        let force = self.force.on::<f64>().run(pair).next();
        let energy = self.energy.on::<f64>().run(pair).next();
        [energy, force].map(|value| value.unwrap_or(f64::NAN))
    }

    /// The second derivative of the energy of two bodies by their distance.
    pub(crate) fn second_derivative(&self, pair: &Pair) -> f64 {
        self.stiffness.on::<f64>().run(pair).sum()
    }

    /// The square of the rounding error of the force between two bodies, and of the derivative of the force along the line between them.
    pub(crate) fn errors(&self, pair: &Pair) -> [f64; 2] {
        let rounded = self.force.on::<f64>().run(pair).collect::<Vec<_>>();
        let wide = self.force.on::<TwoFloat>();
        let exact = { wide }.run(&pair.map(TwoFloat::from_f64)).collect::<Vec<_>>();
        let error = exact.iter().zip(&rounded).map(|(exact, rounded)| {
            let error = (*exact - TwoFloat::from_f64(*rounded)).hi();
            error * error
        });
        let stiffness = self.second_derivative(pair);
        [error.sum(), stiffness * stiffness]
    }
}

fn distance(offset: &[Recorded]) -> Recorded {
    let [x, y, z] = [offset[0], offset[1], offset[2]];
    (x * x + y * y + z * z).sqrt()
}

/// The potential at a distance.
fn value<S: Elementary>(potential: &Program, distance: S, rest: &[S]) -> S {
    let inputs: Vec<S> = core::iter::once(distance).chain(rest.iter().copied()).collect();
    // A program of one expression has one output.
    potential.on::<S>().run(&inputs).next().unwrap_or_else(S::zero)
}

/// The force on a body: the derivative of the potential, along the offset to the other.
fn force(potential: &Program, x: &[Recorded]) -> [Recorded; 3] {
    let re = distance(x);
    let r = Dual { re, du: Recorded::one() };
    let rest: Vec<Dual<Recorded>> = x[3..].iter().map(|&x| Dual::constant(x)).collect();
    let weight = value(potential, r, &rest).du.quotient(re);
    [x[0], x[1], x[2]].map(|x| weight * x)
}
