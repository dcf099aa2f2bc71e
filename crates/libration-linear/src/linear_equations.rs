//! Linear equations.

use core::ops::{Div, Mul, Sub};

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
}
