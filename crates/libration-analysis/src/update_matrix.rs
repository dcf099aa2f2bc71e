//! The matrix of a linear map of the plane of a position and its velocity.

use libration_core::number::{Dual, Wide};
use libration_core::system::DynSystem;
use libration_core::{Elementary, Integrator, Model, Scalar, State, System};

/// A linear map of the phase space of one degree of freedom as a `2 × 2` matrix, held by its columns.
///
/// Rows and columns are in the order `q, v`. That of several degrees of freedom is a [`LinearMap`](super::LinearMap).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UpdateMatrix<S> {
    /// The image of the unit vector of position.
    pub dq: State<S, 1>,
    /// The image of the unit vector of velocity.
    pub dv: State<S, 1>,
}

impl UpdateMatrix<Wide> {
    /// The Jacobian of a step of `dt` seconds on `model` about the state `at`.
    pub fn of_step(
        integrator: impl Integrator,
        model: impl Model<1>,
        at: &State<f64, 1>,
        dt: f64,
    ) -> Self {
        // A call is nothing beside numbers so long, and steps of any system are compiled once.
        let acceleration = |state: &_| model.on::<Dual<Wide>>().acceleration(state);
        let chosen = DynSystem(&acceleration);
        let h = Dual::constant(Wide::from_f64(dt));
        jacobian(&|state| integrator.step(&chosen, state, h), at)
    }

    /// The Jacobian of the rate of change of `model` at a state.
    pub fn of_rates(model: impl Model<1>, at: &State<f64, 1>) -> Self {
        let system = model.on::<Dual<Wide>>();
        jacobian(&|state| system.rate(state), at)
    }
}

/// A map of phase space on dual numbers.
type DualMap<'a> = dyn Fn(State<Dual<Wide>, 1>) -> State<Dual<Wide>, 1> + 'a;

/// The Jacobian of `f`, one direction of phase space at a time.
fn jacobian(f: &DualMap<'_>, at: &State<f64, 1>) -> UpdateMatrix<Wide> {
    let at = at.map(Wide::from_f64);
    UpdateMatrix::from_map(|direction| {
        f(State {
            q: [Dual { re: at.q[0], du: direction.q[0] }],
            v: [Dual { re: at.v[0], du: direction.v[0] }],
        })
        .map(|x| x.du)
    })
}

impl<S: Scalar> UpdateMatrix<S> {
    /// The linear map `f`, by its values on the unit vectors.
    pub fn from_map(f: impl Fn(State<S, 1>) -> State<S, 1>) -> Self {
        UpdateMatrix::from_images(&f)
    }

    /// With a dynamic map, whose numbers may be large, so that they are on the stack once.
    fn from_images(f: &dyn Fn(State<S, 1>) -> State<S, 1>) -> Self {
        let (zero, one) = (S::zero(), S::one());
        UpdateMatrix { dq: f(State { q: [one], v: [zero] }), dv: f(State { q: [zero], v: [one] }) }
    }

    /// The map that changes nothing.
    pub fn identity() -> Self {
        UpdateMatrix::from_map(|e| e)
    }

    /// The entry in row `i` and column `j`.
    pub fn entry(&self, i: usize, j: usize) -> S {
        let column = if j == 0 { &self.dq } else { &self.dv };
        if i == 0 { column.q[0] } else { column.v[0] }
    }

    /// The entries, row by row.
    pub fn rows(&self) -> Vec<Vec<S>> {
        (0..2).map(|i| (0..2).map(|j| self.entry(i, j)).collect()).collect()
    }

    /// The image of `state`.
    #[inline(always)]
    pub fn apply(&self, state: &State<S, 1>) -> State<S, 1> {
        State::origin().plus(state.q[0], self.dq).plus(state.v[0], self.dv)
    }

    /// This map after `first`: the product `self · first`.
    pub fn after(&self, first: &Self) -> Self {
        UpdateMatrix { dq: self.apply(&first.dq), dv: self.apply(&first.dv) }
    }

    /// `self + r·other`.
    pub fn plus(&self, r: S, other: &Self) -> Self {
        UpdateMatrix { dq: self.dq.plus(r, other.dq), dv: self.dv.plus(r, other.dv) }
    }

    /// This map `n` times over, by repeated squaring.
    pub fn power(&self, n: u64) -> Self {
        let (mut result, mut square) = (UpdateMatrix::identity(), *self);
        for bit in 0..u64::BITS - n.leading_zeros() {
            if n >> bit & 1 == 1 {
                result = square.after(&result);
            }
            square = square.after(&square);
        }
        result
    }

    /// The matrix with every entry on another number type.
    pub fn map<T: Scalar>(&self, f: impl Fn(S) -> T) -> UpdateMatrix<T> {
        UpdateMatrix { dq: self.dq.map(&f), dv: self.dv.map(&f) }
    }

    /// Sum of the diagonal.
    pub fn trace(&self) -> S {
        self.entry(0, 0) + self.entry(1, 1)
    }

    /// The determinant: the area that the columns span.
    pub fn determinant(&self) -> S {
        let (x, y) = (&self.dq, &self.dv);
        x.q[0] * y.v[0] - x.v[0] * y.q[0]
    }

    /// The Frobenius norm of `MᵀJM − J`, which is `(det M − 1)·J`: zero if and only if the map is symplectic.
    pub fn symplecticity_defect(&self) -> S
    where
        S: Elementary,
    {
        let excess = self.determinant() - S::one();
        (excess * excess + excess * excess).sqrt()
    }

    /// The Frobenius norm of the difference from the identity.
    pub fn distance_from_identity(&self) -> S
    where
        S: Elementary,
    {
        let apart = self.plus(-S::one(), &UpdateMatrix::identity());
        apart.rows().into_iter().flatten().fold(S::zero(), |sum, x| sum + x * x).sqrt()
    }

    /// Rows and columns exchanged.
    pub fn transposed(&self) -> Self {
        let row = |i: usize| State { q: [self.entry(i, 0)], v: [self.entry(i, 1)] };
        UpdateMatrix { dq: row(0), dv: row(1) }
    }

    /// The map that undoes this one; without a value where none does.
    pub fn inverse(&self) -> Self
    where
        S: Elementary,
    {
        let (trace, scale) = (self.trace(), self.determinant().recip());
        // The adjugate is trace − M.
        let adjugate =
            |e: State<S, 1>| State::origin().plus(trace, e).plus(-S::one(), self.apply(&e));
        UpdateMatrix::from_map(|e| State::origin().plus(scale, adjugate(e)))
    }
}
