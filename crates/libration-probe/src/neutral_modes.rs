//! Plants without the neutral positions of a free base.

use libration::linear::Matrix;

use crate::{Matrices, ProbeReport};

/// Entries of rates relative to the largest one that are rounding of differences.
const NONE: f64 = 1e-7;

/// A plant without states that nothing depends on.
#[derive(Clone, Debug)]
pub struct WithoutNeutral {
    /// Its rates, on the states that are kept.
    pub plant: Matrices,
    /// The numbers of these states.
    pub kept: Vec<usize>,
    /// The numbers of the states that are left out.
    pub left_out: Vec<usize>,
}

impl ProbeReport {
    /// The plant in continuous time without neutral positions, such as where a free base stands: of each combination of states that does
    /// not change and changes nothing, the state that moves most is left out, and the others are relative to it. None without a plant.
    pub fn without_neutral(&self) -> Option<WithoutNeutral> {
        self.modified_flow.as_ref().map(without_neutral)
    }

    /// The names of the states that [`ProbeReport::without_neutral`] leaves out.
    pub fn neutral_states(&self) -> Vec<String> {
        let found = self.without_neutral().map(|found| found.left_out).unwrap_or_default();
        found.into_iter().map(|k| self.states[k].clone()).collect()
    }
}

/// If `N` spans the null space of `A`, the states `y = P x` with `P N = 0` have the rates `P A E`, since `A N = 0`; `E` puts zeros in the
/// places of states that are left out.
fn without_neutral(plant: &Matrices) -> WithoutNeutral {
    let n = plant.a.rows();
    let all = null_space(&plant.a);
    let left_out: Vec<usize> = all.iter().map(|(pivot, _)| *pivot).collect();
    let kept: Vec<usize> = (0..n).filter(|k| !left_out.contains(k)).collect();
    let projected = |matrix: &Matrix| {
        Matrix::from_fn(kept.len(), matrix.columns(), |i, j| {
            let own = matrix[(kept[i], j)];
            let of_pivots = all.iter().map(|(pivot, vector)| vector[kept[i]] * matrix[(*pivot, j)]);
            own - of_pivots.sum::<f64>()
        })
    };
    let columns =
        |matrix: &Matrix| Matrix::from_fn(matrix.rows(), kept.len(), |i, j| matrix[(i, kept[j])]);
    let a = columns(&projected(&plant.a));
    let errors = columns(&plant.a_errors);
    let a_errors = Matrix::from_fn(kept.len(), kept.len(), |i, j| errors[(kept[i], j)]);
    WithoutNeutral { plant: Matrices { a, b: projected(&plant.b), a_errors }, kept, left_out }
}

/// A basis of the null space: each vector is 1 in the place of its pivot and 0 in those of the other pivots.
fn null_space(a: &Matrix) -> Vec<(usize, Vec<f64>)> {
    let n = a.rows();
    let mut rows: Vec<Vec<f64>> = (0..n).map(|i| a.row(i).to_vec()).collect();
    let least = NONE * a.largest();
    let mut pivots: Vec<usize> = Vec::new();
    let mut done = 0;
    // Elimination with full pivoting; the columns that are left without a pivot are those of the null space.
    while done < n {
        let free = (0..n).filter(|j| !pivots.contains(j));
        let places = free.flat_map(|j| (done..n).map(move |i| (i, j)));
        let largest = places.max_by(|a, b| rows[a.0][a.1].abs().total_cmp(&rows[b.0][b.1].abs()));
        let Some((i, j)) = largest.filter(|(i, j)| rows[*i][*j].abs() > least) else { break };
        rows.swap(i, done);
        let pivot: Vec<f64> = rows[done].iter().map(|x| x / rows[done][j]).collect();
        for (k, row) in rows.iter_mut().enumerate() {
            if k != done {
                let factor = row[j];
                row.iter_mut().zip(&pivot).for_each(|(x, p)| *x -= factor * p);
            }
        }
        rows[done] = pivot;
        pivots.push(j);
        done += 1;
    }
    let free = (0..n).filter(|j| !pivots.contains(j));
    free.map(|j| {
        let mut vector = vec![0.0; n];
        vector[j] = 1.0;
        for (row, pivot) in rows.iter().zip(&pivots) {
            vector[*pivot] = -row[j];
        }
        (j, vector)
    })
    .collect()
}
