//! Linear maps that are known only by what they make of a vector: their largest eigenvalue, and equations with them.

use num_complex::Complex64;

use crate::{Matrix, eigenvalues, eigenvector, solve_matrix};

/// Vectors in a Krylov space before it is begun anew.
const SIZE: usize = 24;

/// New beginnings at most.
const BEGINNINGS: usize = 40;

/// Of the norm of the map: what rounding leaves of a residual.
const ROUNDING: f64 = 1e-14;

/// An orthonormal basis of a vector and its images under a map, and the map in this basis (W. E. Arnoldi, *The principle of minimized
/// iterations in the solution of the matrix eigenvalue problem*, Quarterly of Applied Mathematics 9, 1951).
struct KrylovSpace {
    basis: Vec<Vec<f64>>,
    /// The coordinates of the image of each vector but the last; the last coordinate is the norm of what is new.
    images: Vec<Vec<f64>>,
}

impl KrylovSpace {
    fn new(first: &[f64]) -> Self {
        KrylovSpace { basis: vec![scaled(first, norm(first).recip())], images: Vec::new() }
    }

    /// Adds the image of the last vector; none if it is not finite.
    fn grow(&mut self, map: &impl Fn(&[f64]) -> Vec<f64>) -> Option<()> {
        let mut image = map(self.basis.last()?);
        let mut coordinates = vec![0.0; self.basis.len()];
        // Once more against what rounding left.
        for _ in 0..2 {
            for (coordinate, vector) in coordinates.iter_mut().zip(&self.basis) {
                let along = inner(vector, &image);
                *coordinate += along;
                add(&mut image, -along, vector);
            }
        }
        let rest = norm(&image);
        coordinates.push(rest);
        let finite = coordinates.iter().all(|x| x.is_finite());
        self.basis.push(scaled(&image, if rest > 0.0 { rest.recip() } else { 0.0 }));
        self.images.push(coordinates);
        finite.then_some(())
    }

    /// The map within the space.
    fn restricted(&self) -> Matrix {
        let size = self.images.len();
        Matrix::from_fn(size, size, |i, j| self.images[j].get(i).copied().unwrap_or(0.0))
    }

    /// How far the image of a vector of the space leads out of it.
    fn residual(&self, coordinates: &[f64]) -> f64 {
        let rest = self.images.last().and_then(|image| image.last()).copied().unwrap_or(0.0);
        coordinates.last().map_or(0.0, |last| rest * last.abs())
    }

    fn combined(&self, coordinates: &[f64]) -> Vec<f64> {
        let mut sum = vec![0.0; self.basis[0].len()];
        for (x, vector) in coordinates.iter().zip(&self.basis) {
            add(&mut sum, *x, vector);
        }
        sum
    }

    /// Whether now is a time to look at the result: each look costs as much as some images.
    fn is_look(&self) -> bool {
        let size = self.images.len();
        size == SIZE || size.is_multiple_of(3) || self.images[size - 1][size] == 0.0
    }
}

/// The largest eigenvalue of a map whose spectral radius is an eigenvalue, as of one that takes positive semidefinite matrices to such
/// (M. G. Krein, M. A. Rutman, American Mathematical Society Translations 26, 1950); infinite if an image is not finite. `first` has to
/// have a part along its eigenvector. `settles` decides by the value and the norm of its residual whether it suffices.
pub(crate) fn largest_eigenvalue(
    map: impl Fn(&[f64]) -> Vec<f64>,
    first: &[f64],
    settles: impl Fn(f64, f64) -> bool,
) -> f64 {
    let mut first = first.to_vec();
    let mut found = f64::NAN;
    for _ in 0..BEGINNINGS {
        let mut space = KrylovSpace::new(&first);
        while space.images.len() < SIZE {
            if space.grow(&map).is_none() {
                return f64::INFINITY;
            }
            if !space.is_look() {
                continue;
            }
            let restricted = space.restricted();
            let Some(values) = eigenvalues(&restricted) else { return f64::INFINITY };
            let largest = values.into_iter().max_by(|a, b| a.re.total_cmp(&b.re));
            let value = largest.map_or(0.0, |value| value.re);
            let Some(vector) = eigenvector(&restricted, Complex64::from(value)) else {
                return value;
            };
            let vector: Vec<f64> = vector.iter().map(|x| x.re).collect();
            let vector = scaled(&vector, norm(&vector).recip());
            let residual = space.residual(&vector);
            found = value;
            if residual <= ROUNDING * restricted.row_sum_norm() || settles(value, residual) {
                return found;
            }
            if space.images.len() == SIZE {
                first = space.combined(&vector);
            }
        }
    }
    found
}

/// The solution of `x = T x + b` with a map `T` whose spectral radius is below 1.
///
/// By the full orthogonalisation method, begun anew (Y. Saad, *Iterative Methods for Sparse Linear Systems*, 2nd ed., section 6.4).
pub(crate) fn solve_fixed_point(map: impl Fn(&[f64]) -> Vec<f64>, b: &[f64]) -> Vec<f64> {
    let size = norm(b);
    let (mut x, mut rest) = (vec![0.0; b.len()], b.to_vec());
    for _ in 0..BEGINNINGS {
        let begun = norm(&rest);
        if begun.is_nan() || begun <= ROUNDING * size {
            break;
        }
        let mut space = KrylovSpace::new(&rest);
        let mut step = Vec::new();
        while space.images.len() < SIZE {
            if space.grow(&map).is_none() {
                return x;
            }
            if !space.is_look() {
                continue;
            }
            let restricted = space.restricted();
            let k = restricted.rows();
            let equations =
                Matrix::from_fn(k, k, |i, j| f64::from(u8::from(i == j)) - restricted[(i, j)]);
            let right = Matrix::from_fn(k, 1, |i, _| if i == 0 { begun } else { 0.0 });
            if let Some(solution) = solve_matrix(&equations, &right) {
                step = solution.entries().to_vec();
                if space.residual(&step) <= ROUNDING * size {
                    break;
                }
            }
        }
        add(&mut x, 1.0, &space.combined(&step));
        rest = b.to_vec();
        add(&mut rest, 1.0, &map(&x));
        add(&mut rest, -1.0, &x);
    }
    x
}

fn inner(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn norm(x: &[f64]) -> f64 {
    inner(x, x).sqrt()
}

fn scaled(x: &[f64], factor: f64) -> Vec<f64> {
    x.iter().map(|x| factor * x).collect()
}

fn add(sums: &mut [f64], factor: f64, more: &[f64]) {
    sums.iter_mut().zip(more).for_each(|(sum, more)| *sum += factor * more);
}
