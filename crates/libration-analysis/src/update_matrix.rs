//! The matrix of a linear map of phase space.

use core::array::from_fn;

use libration_core::{Elementary, Scalar, State};

/// A linear map of phase space as a `2D × 2D` matrix, held by its columns.
///
/// Rows and columns are in the order `q₀ … q_{D−1}, v₀ … v_{D−1}`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UpdateMatrix<S, const D: usize> {
    /// Images of the unit vectors of position.
    pub dq: [State<S, D>; D],
    /// Images of the unit vectors of velocity.
    pub dv: [State<S, D>; D],
}

impl<S: Scalar, const D: usize> UpdateMatrix<S, D> {
    /// The linear map `f`, by its values on the unit vectors.
    pub fn from_map(f: impl Fn(State<S, D>) -> State<S, D>) -> Self {
        UpdateMatrix::from_images(&f)
    }

    /// With a dynamic map, so that this is compiled once for each number type and dimension.
    fn from_images(f: &dyn Fn(State<S, D>) -> State<S, D>) -> Self {
        let unit = |set: &dyn Fn(&mut State<S, D>)| {
            let mut e = State::origin();
            set(&mut e);
            f(e)
        };
        UpdateMatrix {
            dq: from_fn(|j| unit(&|e| e.q[j] = S::one())),
            dv: from_fn(|j| unit(&|e| e.v[j] = S::one())),
        }
    }

    /// The map that changes nothing.
    pub fn identity() -> Self {
        UpdateMatrix::from_map(|e| e)
    }

    /// Column `j`.
    fn column(&self, j: usize) -> &State<S, D> {
        if j < D { &self.dq[j] } else { &self.dv[j - D] }
    }

    /// The entry in row `i` and column `j`.
    pub fn entry(&self, i: usize, j: usize) -> S {
        let column = self.column(j);
        if i < D { column.q[i] } else { column.v[i - D] }
    }

    /// The entries, row by row.
    pub fn rows(&self) -> Vec<Vec<S>> {
        (0..2 * D).map(|i| (0..2 * D).map(|j| self.entry(i, j)).collect()).collect()
    }

    /// The image of `state`.
    #[inline(always)]
    pub fn apply(&self, state: &State<S, D>) -> State<S, D> {
        // Plain loops: a fold over chained iterators is not inlined.
        let mut image = State::origin();
        for j in 0..D {
            image = image.plus(state.q[j], self.dq[j]);
        }
        for j in 0..D {
            image = image.plus(state.v[j], self.dv[j]);
        }
        image
    }

    /// This map after `first`: the product `self · first`.
    pub fn after(&self, first: &Self) -> Self {
        UpdateMatrix {
            dq: first.dq.map(|column| self.apply(&column)),
            dv: first.dv.map(|column| self.apply(&column)),
        }
    }

    /// `self + r·other`.
    pub fn plus(&self, r: S, other: &Self) -> Self {
        UpdateMatrix {
            dq: from_fn(|j| self.dq[j].plus(r, other.dq[j])),
            dv: from_fn(|j| self.dv[j].plus(r, other.dv[j])),
        }
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
    pub fn map<T: Scalar>(&self, f: impl Fn(S) -> T) -> UpdateMatrix<T, D> {
        let zero = State { q: [T::zero(); D], v: [T::zero(); D] };
        let mut image = UpdateMatrix { dq: [zero; D], dv: [zero; D] };
        for i in 0..D {
            (image.dq[i], image.dv[i]) = (self.dq[i].map(&f), self.dv[i].map(&f));
        }
        image
    }

    /// Sum of the diagonal.
    pub fn trace(&self) -> S {
        (0..2 * D).fold(S::zero(), |sum, i| sum + self.entry(i, i))
    }

    /// The `2 × 2` matrices of the degrees of freedom, if they are decoupled.
    pub fn decoupled(&self) -> Option<[UpdateMatrix<S, 1>; D]>
    where
        S: PartialEq,
    {
        let coupled =
            (0..2 * D).any(|i| (0..2 * D).any(|j| i % D != j % D && self.entry(i, j) != S::zero()));
        let block = |i: usize| UpdateMatrix {
            dq: [State { q: [self.entry(i, i)], v: [self.entry(D + i, i)] }],
            dv: [State { q: [self.entry(i, D + i)], v: [self.entry(D + i, D + i)] }],
        };
        (!coupled).then(|| from_fn(block))
    }

    /// The entries of `MᵀJM − J`, which vanish if and only if the map is symplectic.
    ///
    /// Hairer, Lubich, Wanner: Geometric Numerical Integration, 2nd ed., §VI.2.
    pub fn symplecticity_residual(&self) -> impl Iterator<Item = S> + '_ {
        let canonical = |i: usize, j: usize| match () {
            () if i + D == j => S::one(),
            () if j + D == i => -S::one(),
            () => S::zero(),
        };
        (0..2 * D).flat_map(move |i| {
            (0..2 * D)
                .map(move |j| symplectic_form(self.column(i), self.column(j)) - canonical(i, j))
        })
    }

    /// The Frobenius norm of `MᵀJM − J`.
    pub fn symplecticity_defect(&self) -> S
    where
        S: Elementary,
    {
        frobenius(self.symplecticity_residual())
    }

    /// The Frobenius norm of the difference from the identity.
    pub fn distance_from_identity(&self) -> S
    where
        S: Elementary,
    {
        let identity = UpdateMatrix::<S, D>::identity();
        let entries = (0..2 * D).flat_map(|i| (0..2 * D).map(move |j| (i, j)));
        frobenius(entries.map(|(i, j)| self.entry(i, j) - identity.entry(i, j)))
    }
}

impl<S: Scalar> UpdateMatrix<S, 1> {
    /// The determinant.
    pub fn determinant(&self) -> S {
        symplectic_form(&self.dq[0], &self.dv[0])
    }

    /// Rows and columns exchanged.
    pub fn transposed(&self) -> Self {
        let row = |i: usize| State { q: [self.entry(i, 0)], v: [self.entry(i, 1)] };
        UpdateMatrix { dq: [row(0)], dv: [row(1)] }
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

/// `xᵀJy = Σ x.q·y.v − x.v·y.q`; in one dimension the area that `x` and `y` span.
fn symplectic_form<S: Scalar, const D: usize>(x: &State<S, D>, y: &State<S, D>) -> S {
    (0..D).fold(S::zero(), |sum, i| sum + (x.q[i] * y.v[i] - x.v[i] * y.q[i]))
}

/// The square root of the sum of squares.
fn frobenius<S: Elementary>(entries: impl Iterator<Item = S>) -> S {
    entries.fold(S::zero(), |sum, x| sum + x * x).sqrt()
}
