//! A linear map of a phase space of any dimension, in 1024 bits.

use libration_core::number::Wide;
use libration_core::{Elementary, Scalar, State};

use super::UpdateMatrix;

/// A linear map of phase space as a `2D × 2D` matrix for any number `D` of degrees of freedom.
///
/// Rows and columns are in the order `q₀ … q_{D−1}, v₀ … v_{D−1}`.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearMap {
    columns: Vec<Vec<Wide>>,
}

impl LinearMap {
    /// The map with these columns: the images of the unit vectors.
    pub fn of_columns(columns: Vec<Vec<Wide>>) -> Self {
        LinearMap { columns }
    }

    /// The map with these rows.
    pub fn of_rows(rows: &[Vec<Wide>]) -> Self {
        let n = rows.len();
        LinearMap::of_columns((0..n).map(|j| (0..n).map(|i| rows[i][j]).collect()).collect())
    }

    /// The number of coordinates: twice that of degrees of freedom.
    pub fn dimension(&self) -> usize {
        self.columns.len()
    }

    /// The entry in row `i` and column `j`.
    pub fn entry(&self, i: usize, j: usize) -> Wide {
        self.columns[j][i]
    }

    /// The entries, row by row.
    pub fn rows(&self) -> Vec<Vec<Wide>> {
        let n = self.dimension();
        (0..n).map(|i| (0..n).map(|j| self.entry(i, j)).collect()).collect()
    }

    /// The image of a vector.
    pub fn apply(&self, vector: &[Wide]) -> Vec<Wide> {
        let mut image = vec![Wide::ZERO; vector.len()];
        for (column, &x) in self.columns.iter().zip(vector) {
            image.iter_mut().zip(column).for_each(|(sum, &entry)| *sum = *sum + entry * x);
        }
        image
    }

    /// This map after `first`: the product `self · first`.
    pub fn after(&self, first: &Self) -> Self {
        LinearMap::of_columns(first.columns.iter().map(|column| self.apply(column)).collect())
    }

    /// The same map with velocities in multiples of `unit`.
    pub fn with_velocities_in(&self, unit: Wide) -> Self {
        let degrees = self.dimension() / 2;
        let size = |i: usize| if i < degrees { Wide::one() } else { unit };
        let scaled = |(j, column): (usize, &Vec<Wide>)| {
            column.iter().enumerate().map(|(i, &x)| x * size(j) * size(i).recip()).collect()
        };
        LinearMap::of_columns(self.columns.iter().enumerate().map(scaled).collect())
    }

    /// Sum of the diagonal.
    pub fn trace(&self) -> Wide {
        (0..self.dimension()).fold(Wide::ZERO, |sum, i| sum + self.entry(i, i))
    }

    /// The `2 × 2` matrices of the degrees of freedom, if they are decoupled.
    pub fn decoupled(&self) -> Option<Vec<UpdateMatrix<Wide>>> {
        let (n, degrees) = (self.dimension(), self.dimension() / 2);
        let is_apart = |i: usize, j: usize| i % degrees != j % degrees;
        let coupled = (0..n).any(|i| (0..n).any(|j| is_apart(i, j) && !self.entry(i, j).is_zero()));
        let block = |i: usize| {
            let column = |j| State { q: [self.entry(i, j)], v: [self.entry(degrees + i, j)] };
            UpdateMatrix { dq: column(i), dv: column(degrees + i) }
        };
        (!coupled).then(|| (0..degrees).map(block).collect())
    }

    /// The Frobenius norm of `MᵀJM − J`, which is zero if and only if the map is symplectic.
    ///
    /// Hairer, Lubich, Wanner: Geometric Numerical Integration, 2nd ed., §VI.2.
    pub fn symplecticity_defect(&self) -> Wide {
        let degrees = self.dimension() / 2;
        let form = |x: &[Wide], y: &[Wide]| {
            (0..degrees)
                .fold(Wide::ZERO, |sum, i| sum + (x[i] * y[degrees + i] - x[degrees + i] * y[i]))
        };
        let canonical = |i: usize, j: usize| match () {
            () if i + degrees == j => Wide::one(),
            () if j + degrees == i => -Wide::one(),
            () => Wide::ZERO,
        };
        self.frobenius(|i, j| form(&self.columns[i], &self.columns[j]) - canonical(i, j))
    }

    /// The Frobenius norm of the difference from the identity.
    pub fn distance_from_identity(&self) -> Wide {
        let unit = |i, j| if i == j { Wide::one() } else { Wide::ZERO };
        self.frobenius(|i, j| self.entry(i, j) - unit(i, j))
    }

    /// The square root of the sum of squares of a matrix of this size.
    fn frobenius(&self, entry: impl Fn(usize, usize) -> Wide) -> Wide {
        let n = self.dimension();
        let entries = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
        entries.map(|(i, j)| entry(i, j)).fold(Wide::ZERO, |sum, x| sum + x * x).sqrt()
    }
}
