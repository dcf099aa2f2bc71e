//! Least squares of few columns.

/// Most columns.
const COLUMNS: usize = 3;

/// The solution of a least-squares problem.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Solution {
    /// Coefficients of the columns.
    pub coefficients: [f64; COLUMNS],
    /// Entry of the inverse of XᵀX on the diagonal, for each column.
    pub inverse_diagonal: [f64; COLUMNS],
    /// Logarithm of the determinant of XᵀX.
    pub log_determinant: f64,
    /// Sum of the squares of the residuals.
    pub residual: f64,
}

/// A row: the entries of the columns, and the value.
pub(crate) type Row = ([f64; COLUMNS], f64);

/// Returns the least-squares solution of the first `columns` columns, by Cholesky's factors. None if they are dependent.
pub(crate) fn least_squares(rows: &[Row], columns: usize) -> Option<Solution> {
    let n = columns.min(COLUMNS);
    let mut xx = [[0.0; COLUMNS]; COLUMNS];
    let mut xy = [0.0; COLUMNS];
    for (x, y) in rows {
        for i in 0..n {
            for j in 0..n {
                xx[i][j] += x[i] * x[j];
            }
            xy[i] += x[i] * y;
        }
    }
    let mut factor = [[0.0; COLUMNS]; COLUMNS];
    let mut log_determinant = 0.0;
    for i in 0..n {
        for j in 0..=i {
            let known: f64 = (0..j).map(|k| factor[i][k] * factor[j][k]).sum();
            let rest = xx[i][j] - known;
            if i == j {
                if rest.is_nan() || rest <= 0.0 {
                    return None;
                }
                factor[i][i] = rest.sqrt();
                log_determinant += rest.ln();
            } else {
                factor[i][j] = rest / factor[j][j];
            }
        }
    }
    let forward = |right: [f64; COLUMNS]| {
        let mut z = [0.0; COLUMNS];
        for i in 0..n {
            let known: f64 = (0..i).map(|k| factor[i][k] * z[k]).sum();
            z[i] = (right[i] - known) / factor[i][i];
        }
        z
    };
    let z = forward(xy);
    let mut coefficients = [0.0; COLUMNS];
    for i in (0..n).rev() {
        let known: f64 = (i + 1..n).map(|k| factor[k][i] * coefficients[k]).sum();
        coefficients[i] = (z[i] - known) / factor[i][i];
    }
    let mut inverse_diagonal = [0.0; COLUMNS];
    for (i, entry) in inverse_diagonal.iter_mut().enumerate().take(n) {
        let mut unit = [0.0; COLUMNS];
        unit[i] = 1.0;
        *entry = forward(unit).iter().map(|x| x * x).sum();
    }
    let fitted = |x: &[f64; COLUMNS]| (0..n).map(|i| x[i] * coefficients[i]).sum::<f64>();
    let residual = rows.iter().map(|(x, y)| (y - fitted(x)).powi(2)).sum();
    Some(Solution { coefficients, inverse_diagonal, log_determinant, residual })
}
