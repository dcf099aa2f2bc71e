//! The matrices of a step.

use libration::linear::{LinearPlant, Matrix};

use crate::differences::{Jacobian, jacobian, quick_jacobian};
use crate::prober::Prober;
use crate::{BlackBoxError, Subject};

/// Largest relative error of a derivative.
const UNCLEAR: f64 = 0.01;
/// Errors in units of the scales that may be roundings.
const ROUNDING: f64 = 1e-9;

/// The matrices of a step of small deviations, `x' = A x + B u`, with estimated absolute errors.
#[derive(Clone, Debug)]
pub(crate) struct LinearisedStep {
    /// The length of the step, in s.
    pub(crate) dt: f64,
    /// States × states.
    pub(crate) a: Matrix,
    /// States × inputs.
    pub(crate) b: Matrix,
    /// Estimated absolute errors of `a`.
    pub(crate) a_errors: Matrix,
    /// Estimated absolute errors of `b`.
    pub(crate) b_errors: Matrix,
}

impl LinearisedStep {
    /// That of a step of `dt` seconds at the state and the action of the subject.
    pub(crate) fn at(prober: &mut Prober<'_>, dt: f64) -> Result<Self, BlackBoxError> {
        let Subject { state, action, action_scale, .. } = prober.subject;
        LinearisedStep::by(prober, state, [action, action_scale], dt)
    }

    /// The same without actions, for fewer calls.
    pub(crate) fn of_states(prober: &mut Prober<'_>, dt: f64) -> Result<Self, BlackBoxError> {
        LinearisedStep::of_states_at(prober, &prober.subject.state, dt)
    }

    /// The same at another state.
    pub(crate) fn of_states_at(
        prober: &mut Prober<'_>,
        state: &[f64],
        dt: f64,
    ) -> Result<Self, BlackBoxError> {
        LinearisedStep::by(prober, state, [&[]; 2], dt)
    }

    /// The same by few short differences, for searches.
    pub(crate) fn quick(prober: &mut Prober<'_>, dt: f64) -> Result<Self, BlackBoxError> {
        let subject = prober.subject;
        let n = subject.state.len();
        let of = |points: &Matrix| {
            let actions = |_, j: usize| subject.action[j];
            let actions = Matrix::from_fn(points.rows(), subject.action.len(), actions);
            prober.step(points, &actions, dt)
        };
        let Jacobian { values, errors } = quick_jacobian(of, &subject.state, &subject.state_scale)?;
        let [b, b_errors] = [(); 2].map(|()| Matrix::zeros(n, 0));
        Ok(LinearisedStep { dt, a: values, b, a_errors: errors, b_errors })
    }

    /// The derivatives at a state by the states and by these actions with their scales, which are all or none.
    fn by(
        prober: &mut Prober<'_>,
        state: &[f64],
        [actions, action_scale]: [&[f64]; 2],
        dt: f64,
    ) -> Result<Self, BlackBoxError> {
        let subject = prober.subject;
        let n = subject.state.len();
        let coarseness = prober.coarseness;
        let z = [state, actions].concat();
        let scale = [&subject.state_scale[..], action_scale].concat();
        let of = |points: &Matrix| {
            let rows = points.rows();
            let states = points.block((0, 0), (rows, n));
            let actions = match actions.is_empty() {
                true => Matrix::from_fn(rows, subject.action.len(), |_, j| subject.action[j]),
                false => points.block((0, n), (rows, z.len() - n)),
            };
            prober.step(&states, &actions, dt)
        };
        let Jacobian { values, errors } = jacobian(of, &z, &scale, coarseness)?;
        let part = |matrix: &Matrix, start, count| matrix.block((0, start), (n, count));
        let inputs = z.len() - n;
        Ok(LinearisedStep {
            dt,
            a: part(&values, 0, n),
            b: part(&values, n, inputs),
            a_errors: part(&errors, 0, n),
            b_errors: part(&errors, n, inputs),
        })
    }

    /// Whether all entries are known.
    pub(crate) fn is_finite(&self) -> bool {
        self.a.is_finite() && self.b.is_finite()
    }

    /// The largest estimated error of an entry, in units of the scales and relative to the largest entry of its row.
    pub(crate) fn relative_error(&self, subject: &Subject) -> f64 {
        self.error_of(subject, true)
    }

    /// The same of derivatives by states only.
    pub(crate) fn relative_error_of_states(&self, subject: &Subject) -> f64 {
        self.error_of(subject, false)
    }

    fn error_of(&self, subject: &Subject, with_inputs: bool) -> f64 {
        let scaled = |matrix: &Matrix, i: usize, j: usize, scale: &[f64]| {
            (matrix[(i, j)] * scale[j] / subject.state_scale[i]).abs()
        };
        let largest = |i: usize, of_a: &Matrix, of_b: &Matrix| {
            let states = (0..of_a.columns()).map(|j| scaled(of_a, i, j, &subject.state_scale));
            let inputs = (0..of_b.columns()).map(|j| scaled(of_b, i, j, &subject.action_scale));
            states.chain(inputs).fold(0.0, f64::max)
        };
        (0..self.a.rows())
            .map(|i| {
                let size = largest(i, &self.a, &self.b).max(f64::MIN_POSITIVE);
                let none = Matrix::zeros(self.a.rows(), 0);
                let b_errors = if with_inputs { &self.b_errors } else { &none };
                largest(i, &self.a_errors, b_errors) / size
            })
            .fold(0.0, f64::max)
    }

    /// The inputs by which the step has no derivative: the error of their column is no small part of it, and no rounding.
    pub(crate) fn unclear_inputs(&self, subject: &Subject) -> Vec<usize> {
        let largest = |matrix: &Matrix, j: usize| {
            let scaled = |i: usize| {
                (matrix[(i, j)] * subject.action_scale[j] / subject.state_scale[i]).abs()
            };
            (0..matrix.rows()).map(scaled).fold(0.0, f64::max)
        };
        let is_unclear = |j: &usize| {
            let error = largest(&self.b_errors, *j);
            error > UNCLEAR * largest(&self.b, *j) && error > ROUNDING
        };
        (0..self.b.columns()).filter(is_unclear).collect()
    }

    /// The matrices on states and held actions, `[[A, B], [0, 1]]`.
    pub(crate) fn augmented(&self) -> Matrix {
        let (n, m) = (self.a.rows(), self.b.columns());
        let mut whole = Matrix::identity(n + m);
        whole.set_block((0, 0), &self.a);
        whole.set_block((0, n), &self.b);
        whole
    }

    /// The step as a sampled plant with the names of the subject. Without actions it has one without effect.
    pub(crate) fn plant(&self, subject: &Subject) -> Option<LinearPlant> {
        plant_of(&self.a, &self.b, Some(self.dt), subject)
    }
}

/// The largest entry of a matrix states × states, in units of the scales.
pub(crate) fn largest_scaled(matrix: &Matrix, subject: &Subject) -> f64 {
    let scale = &subject.state_scale;
    let places = (0..matrix.rows()).flat_map(|i| (0..matrix.columns()).map(move |j| (i, j)));
    places.map(|(i, j)| (matrix[(i, j)] * scale[j] / scale[i]).abs()).fold(0.0, f64::max)
}

/// A plant with the names of the subject.
pub(crate) fn plant_of(
    a: &Matrix,
    b: &Matrix,
    sampling_period: Option<f64>,
    subject: &Subject,
) -> Option<LinearPlant> {
    let n = a.rows();
    let b = if b.columns() == 0 { Matrix::zeros(n, 1) } else { b.clone() };
    let d = Matrix::zeros(n, b.columns());
    let mut plant = LinearPlant::new(a.clone(), b, Matrix::identity(n), d).ok()?;
    plant.sampling_period = sampling_period;
    plant.states.clone_from(&subject.states);
    plant.outputs.clone_from(&subject.states);
    if subject.inputs.len() == plant.inputs.len() {
        plant.inputs.clone_from(&subject.inputs);
    }
    Some(plant)
}
