//! The modes of a plant, each named by the states that move.

use core::ops::Range;

use num_complex::Complex64;

use crate::eigenvector::size_of;
use crate::hessenberg::HessenbergForm;
use crate::{LinearPlant, Matrix, PlantMode, solve};

/// Sine of the angle between eigenvectors below which they are one, of a repeated eigenvalue. Rounding parts those by its root.
const ALIKE: f64 = 1e-6;

/// Part of the size of the plant by which inverse iteration is beside an eigenvalue that repeats, so that rounding does not part the
/// repetitions.
const NEAR: f64 = 1e-6;

impl LinearPlant {
    /// The modes of the plant, the one that grows fastest first; of a pair one.
    ///
    /// A repeated eigenvalue may have one eigenvector only, as that of a free mass: the first of its modes is named by it, and each
    /// further one by the motion at a right angle to those before it in their invariant subspace. Where it has several, they are those
    /// next to single states, so that equal subsystems have a mode each.
    pub fn modes(&self) -> Vec<PlantMode> {
        let shapes = self.shapes();
        let named = self.name_shapes(&shapes);
        shapes.iter().zip(&named).map(|((value, _), shape)| self.mode(*value, shape)).collect()
    }

    /// The motion by which each of these modes is named.
    pub(crate) fn name_shapes(
        &self,
        shapes: &[(Complex64, Vec<Complex64>)],
    ) -> Vec<Vec<Complex64>> {
        let own: Vec<Vec<Complex64>> =
            shapes.iter().map(|(_, shape)| normalised(shape.clone())).collect();
        let alike = |k: usize, j: usize| {
            let mut rest = own[k].clone();
            remove(&mut rest, &own[j]);
            norm(&rest) < ALIKE
        };
        let mut named: Vec<Option<Vec<Complex64>>> = vec![None; shapes.len()];
        for k in 0..shapes.len() {
            if named[k].is_some() {
                continue;
            }
            let same: Vec<usize> = (k..shapes.len()).filter(|&j| alike(k, j)).collect();
            let value = shapes[k].0;
            let single =
                if same.len() > 1 { self.single_motions(value, same.len()) } else { vec![] };
            if single.len() == same.len() {
                same.into_iter().zip(single).for_each(|(j, shape)| named[j] = Some(shape));
                continue;
            }
            let mut before: Vec<Vec<Complex64>> = Vec::new();
            for j in same {
                let further =
                    if before.is_empty() { None } else { further_vector(&self.a, value, &before) };
                let shape = further.unwrap_or_else(|| own[j].clone());
                before.push(shape.clone());
                named[j] = Some(shape);
            }
        }
        named.into_iter().flatten().collect()
    }

    /// Up to `count` independent eigenvectors of an eigenvalue, each the part of one state that lies in its eigenspace.
    fn single_motions(&self, value: Complex64, count: usize) -> Vec<Vec<Complex64>> {
        let n = self.a.rows();
        let size = size_of(&self.a);
        let near = value + Complex64::new(1.0, 1.0) * (size * NEAR);
        let form = HessenbergForm::new(&self.a);
        let unit = |i: usize| (0..n).map(|j| f64::from(u8::from(i == j))).collect::<Vec<f64>>();
        let columns: Vec<Vec<f64>> = (0..n).map(|i| form.column(&unit(i))).collect();
        let parts: Vec<Vec<Complex64>> =
            form.resolvent(near, &columns).solutions.iter().map(|x| form.restored(x)).collect();
        let most = parts.iter().map(|x| norm(x)).fold(0.0, f64::max);
        let mut found: Vec<Vec<Complex64>> = Vec::new();
        let mut basis: Vec<Vec<Complex64>> = Vec::new();
        for part in parts {
            let mut rest = part.clone();
            basis.iter().for_each(|along| remove(&mut rest, along));
            // A chain of a defective eigenvalue has another length.
            let moved: Vec<Complex64> = (0..n)
                .map(|i| {
                    (0..n).map(|j| part[j] * self.a[(i, j)]).sum::<Complex64>() - value * part[i]
                })
                .collect();
            let is_eigenvector = norm(&moved) < ALIKE.sqrt() * size * norm(&part);
            if found.len() < count && is_eigenvector && norm(&rest) > 0.1 * most {
                basis.push(normalised(rest));
                found.push(normalised(part));
            }
        }
        found
    }

    /// The modes of some of the states without all others, such as those of lags and filters. They are modes of the plant if these
    /// states do not depend on the others, or the others do not depend on them.
    pub fn modes_of(&self, states: Range<usize>) -> Vec<PlantMode> {
        let (start, count) = (states.start, states.len());
        let rows = |matrix: &Matrix| matrix.block((start, 0), (count, matrix.columns()));
        let alone = LinearPlant {
            a: self.a.block((start, start), (count, count)),
            b: rows(&self.b),
            g: rows(&self.g),
            c: self.c.block((0, start), (self.c.rows(), count)),
            states: self.states[states].to_vec(),
            ..self.clone()
        };
        alone.modes()
    }

    /// The rounding of simple eigenvalues in 1/s, `n ε ‖A‖`: computed ones are exact for a matrix so much off (G. Golub, C. Van Loan,
    /// *Matrix Computations*, 4th edition, section 7.5.6). Those of a sampled plant are of size 1 where this matters.
    pub fn mode_rounding(&self) -> f64 {
        let rounding = self.states.len() as f64 * f64::EPSILON * self.a.row_sum_norm();
        rounding / self.sampling_period.unwrap_or(1.0)
    }
}

fn norm(x: &[Complex64]) -> f64 {
    x.iter().map(|x| x.norm_sqr()).sum::<f64>().sqrt()
}

fn normalised(mut x: Vec<Complex64>) -> Vec<Complex64> {
    let size = norm(&x);
    x.iter_mut().for_each(|x| *x /= size);
    x
}

/// Removes the part along a vector of norm 1.
fn remove(x: &mut [Complex64], along: &[Complex64]) {
    let part: Complex64 = along.iter().zip(&*x).map(|(a, x)| a.conj() * x).sum();
    x.iter_mut().zip(along).for_each(|(x, a)| *x -= part * a);
}

/// The vector of norm 1 that spans the invariant subspace of a repeated eigenvalue together with orthonormal vectors of it: inverse
/// iteration at a right angle to those.
fn further_vector(
    a: &Matrix,
    value: Complex64,
    before: &[Vec<Complex64>],
) -> Option<Vec<Complex64>> {
    let n = a.rows();
    let size = size_of(a);
    // Beside the eigenvalue by the root of a rounding or more, so that the part along the others, larger by this, leaves digits.
    let near = value + Complex64::new(1.0, 1.0) * (size * NEAR);
    let entry = |i: usize, j: usize| a[(i, j)] - if i == j { near } else { Complex64::ZERO };
    let mut vector: Vec<Complex64> = (1..=n).map(|i| Complex64::from((i as f64).recip())).collect();
    for _ in 0..4 {
        before.iter().for_each(|along| remove(&mut vector, along));
        let row = |i: usize| (0..n).map(|j| entry(i, j)).chain([vector[i]]).collect();
        vector = solve((0..n).map(row).collect(), |x: Complex64| x.norm());
        before.iter().for_each(|along| remove(&mut vector, along));
        let size = norm(&vector);
        if !(size.is_finite() && size > 0.0) {
            return None;
        }
        vector = normalised(vector);
    }
    Some(vector)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plant(a: &[&[f64]], b: &[&[f64]], c: &[&[f64]]) -> LinearPlant {
        let of = |rows: &[&[f64]]| Matrix::from_rows(rows).unwrap();
        let d = Matrix::zeros(c.len(), b[0].len());
        LinearPlant::new(of(a), of(b), of(c), d).unwrap()
    }

    #[test]
    fn modes_of_a_repeated_eigenvalue_have_names_of_their_own() {
        // A free mass with the unit of its rate a thousand times as large, and a chain of three integrators.
        for scale in [1e-3, 1.0, 1e3] {
            let free = plant(&[&[0.0, scale], &[0.0, 0.0]], &[&[0.0], &[1.0]], &[&[1.0, 0.0]]);
            let names: Vec<String> =
                free.modes().into_iter().map(|mode| mode.states[0].0.clone()).collect();
            assert_eq!(names, ["x1", "x2"], "{scale}");
        }
        let a: &[&[f64]] = &[&[-2.0, 1.0, 0.0], &[0.0, -2.0, 1.0], &[0.0, 0.0, -2.0]];
        let chain = plant(a, &[&[0.0], &[0.0], &[1.0]], &[&[1.0, 0.0, 0.0]]);
        let modes = chain.modes();
        let names: Vec<&str> = modes.iter().map(|mode| mode.states[0].0.as_str()).collect();
        assert_eq!(names, ["x1", "x2", "x3"]);
        assert!(modes.iter().all(|mode| mode.states.len() == 1), "{modes:?}");
    }

    #[test]
    fn equal_subsystems_have_a_mode_each() {
        // Three oscillators with a common input, and two with a spring between them, whose modes are not equal.
        let spring = |n: usize, between: f64| {
            Matrix::from_fn(2 * n, 2 * n, |i, j| match (i < n, j < n) {
                (true, _) => f64::from(u8::from(j == i + n)),
                (false, true) if j + n == i => -100.0 - between,
                (false, true) => between,
                (false, false) => {
                    if i == j {
                        -0.1
                    } else {
                        0.0
                    }
                }
            })
        };
        let of = |n: usize, between: f64| {
            let push = Matrix::from_fn(2 * n, 1, |i, _| f64::from(u8::from(i >= n)));
            let shown = Matrix::from_fn(1, 2 * n, |_, j| f64::from(u8::from(j == 0)));
            LinearPlant::new(spring(n, between), push, shown, Matrix::zeros(1, 1)).unwrap()
        };
        let equal = of(3, 0.0).modes();
        let names: Vec<&str> = equal.iter().map(|mode| mode.states[0].0.as_str()).collect();
        assert_eq!(names, ["x4", "x5", "x6"], "{equal:?}");
        assert!(equal.iter().all(|mode| mode.states.len() <= 2), "{equal:?}");
        let coupled = of(2, 5.0).modes();
        assert!(
            coupled.iter().all(|mode| mode.states.len() == 4 || mode.states[1].1 > 0.99),
            "{coupled:?}"
        );
    }

    #[test]
    fn modes_of_a_part_are_those_of_its_states() {
        let a: &[&[f64]] = &[&[0.0, 1.0, 0.0], &[0.0, 0.0, 5.0], &[0.0, 0.0, -30.0]];
        let driven = plant(a, &[&[0.0], &[0.0], &[30.0]], &[&[1.0, 0.0, 0.0]]);
        let [lag] = &driven.modes_of(2..3)[..] else { panic!("one state") };
        assert_eq!((lag.growth_rate, lag.states[0].0.as_str()), (-30.0, "x3"));
        assert_eq!(driven.modes_of(0..2).len(), 2);
    }

    #[test]
    fn a_free_motion_of_coupled_masses_is_zero_to_rounding() {
        let a: &[&[f64]] = &[
            &[0.0, 0.0, 1.0, 0.0],
            &[0.0, 0.0, 0.0, 1.0],
            &[-1500.0, 1500.0, -2.5, 1.0],
            &[300.0, -300.0, 0.2, -0.3],
        ];
        let drive = plant(a, &[&[0.0], &[0.0], &[50.0], &[0.0]], &[&[1.0, 0.0, 0.0, 0.0]]);
        let rates = drive.modes().into_iter().map(|mode| mode.growth_rate.abs());
        assert_eq!(rates.filter(|rate| *rate <= drive.mode_rounding()).count(), 1);
        assert!(drive.mode_rounding() < 1e-11);
    }
}
