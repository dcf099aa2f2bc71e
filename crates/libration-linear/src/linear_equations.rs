//! Linear equations.

use core::ops::{Div, Mul, Sub};

use crate::Matrix;

/// The solution of linear equations, by elimination with the pivot of the largest `size`. The right side is the last column.
pub fn solve<T>(mut rows: Vec<Vec<T>>, size: impl Fn(T) -> f64) -> Vec<T>
where
    T: Copy + Sub<Output = T> + Mul<Output = T> + Div<Output = T>,
{
    let n = rows.len();
    for k in 0..n {
        let largest = (k..n).max_by(|&a, &b| size(rows[a][k]).total_cmp(&size(rows[b][k])));
        rows.swap(k, largest.unwrap_or(k));
        let (above, below) = rows.split_at_mut(k + 1);
        let pivot = &above[k];
        for row in below.iter_mut().filter(|row| size(row[k]) != 0.0) {
            let factor = row[k] / pivot[k];
            row.iter_mut().zip(pivot).skip(k).for_each(|(x, &p)| *x = *x - factor * p);
        }
    }
    let mut solution: Vec<T> = rows.iter().map(|row| row[n]).collect();
    for k in (0..n).rev() {
        let rest = (k + 1..n).fold(solution[k], |rest, j| rest - rows[k][j] * solution[j]);
        solution[k] = rest / rows[k][k];
    }
    solution
}

/// The solution of `AX = B`, by elimination with partial pivoting; none if `A` is singular.
pub fn solve_matrix(a: &Matrix, b: &Matrix) -> Option<Matrix> {
    let n = a.rows();
    let (mut a, mut x) = (a.clone(), b.clone());
    for k in 0..n {
        let largest = (k..n).max_by(|&i, &j| a[(i, k)].abs().total_cmp(&a[(j, k)].abs()))?;
        a.swap_rows(k, largest);
        x.swap_rows(k, largest);
        if a[(k, k)] == 0.0 || !a[(k, k)].is_finite() {
            return None;
        }
        for i in k + 1..n {
            let factor = a[(i, k)] / a[(k, k)];
            if factor != 0.0 {
                a.subtract_row(i, factor, k, k);
                x.subtract_row(i, factor, k, 0);
            }
        }
    }
    for k in (0..n).rev() {
        for j in k + 1..n {
            x.subtract_row(k, a[(k, j)], j, 0);
        }
        let pivot = a[(k, k)];
        x.row_mut(k).iter_mut().for_each(|x| *x /= pivot);
    }
    x.is_finite().then_some(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_system_with_a_zero_pivot_is_solved() {
        // y + z = 5, x − z = −2, 2x + y = 4 at (1, 2, 3).
        let rows =
            vec![vec![0.0, 1.0, 1.0, 5.0], vec![1.0, 0.0, -1.0, -2.0], vec![2.0, 1.0, 0.0, 4.0]];
        assert_eq!(solve(rows, f64::abs), [1.0, 2.0, 3.0]);
    }

    #[test]
    fn a_matrix_equation_is_solved_and_a_singular_one_is_not() {
        let a = Matrix::from_rows(&[[0.0, 2.0], [1.0, 1.0]]).unwrap();
        let x = solve_matrix(&a, &Matrix::identity(2)).unwrap();
        assert_eq!(x.entries(), [-0.5, 1.0, 0.5, 0.0]);
        let singular = Matrix::from_rows(&[[1.0, 2.0], [2.0, 4.0]]).unwrap();
        assert_eq!(solve_matrix(&singular, &x), None);
    }
}
