//! Movements of a plant between two events, by Taylor's series.

use super::dot;
use crate::{Discretisation, Matrix};

/// The movement of a plant through so many seconds: `x = φ x + γ push`.
pub(super) struct Movement {
    pub(super) seconds: f64,
    pub(super) phi: Matrix,
    pub(super) gamma: Matrix,
}

impl Movement {
    /// By a series for each state and each push.
    pub(super) fn new(a: &Matrix, seconds: f64) -> Self {
        let n = a.rows();
        let unit = |i: usize| (0..n).map(|j| f64::from(u8::from(i == j))).collect::<Vec<f64>>();
        let moved = |mut x: Vec<f64>, push: &[f64]| {
            flow(a, &mut x, push, seconds);
            x
        };
        let of_states: Vec<Vec<f64>> = (0..n).map(|i| moved(unit(i), &vec![0.0; n])).collect();
        let of_pushes: Vec<Vec<f64>> = (0..n).map(|i| moved(vec![0.0; n], &unit(i))).collect();
        Movement {
            seconds,
            phi: Matrix::from_fn(n, n, |i, j| of_states[j][i]),
            gamma: Matrix::from_fn(n, n, |i, j| of_pushes[j][i]),
        }
    }
}

/// `ẋ = Ax + push` for so many seconds, by Taylor's series of short steps.
pub(super) fn flow(a: &Matrix, x: &mut [f64], push: &[f64], seconds: f64) {
    let n = x.len();
    // Terms reach e⁴ at most before they fall: two digits.
    let parts = (0.25 * a.row_sum_norm() * seconds).ceil().max(1.0);
    if parts > 64.0 {
        let driving = Matrix::from_fn(n, 1, |i, _| push[i]);
        let Discretisation { phi, gamma } = Discretisation::exact(a, &driving, seconds);
        let moved = phi.apply(x);
        x.iter_mut()
            .zip(moved)
            .zip(gamma.entries())
            .for_each(|((x, moved), push)| *x = moved + push);
        return;
    }
    let h = seconds / parts;
    let (mut term, mut next) = (vec![0.0; n], vec![0.0; n]);
    for _ in 0..parts as u64 {
        for i in 0..n {
            term[i] = h * (dot(a.row(i), x) + push[i]);
        }
        for k in 2..40 {
            x.iter_mut().zip(&term).for_each(|(x, y)| *x += y);
            if term.iter().zip(x.iter()).all(|(y, x)| y.abs() <= 1e-14 * x.abs()) {
                break;
            }
            let share = h / f64::from(k);
            next.iter_mut().enumerate().for_each(|(i, x)| *x = share * dot(a.row(i), &term));
            core::mem::swap(&mut term, &mut next);
        }
    }
}
