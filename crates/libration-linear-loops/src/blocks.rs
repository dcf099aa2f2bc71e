//! Matrices made of blocks.

use libration_linear::Matrix;

/// The upper half of a symmetric form, whose value is the same.
pub(super) fn folded(form: &Matrix) -> Matrix {
    Matrix::from_fn(form.rows(), form.rows(), |i, j| match i.cmp(&j) {
        core::cmp::Ordering::Less => form[(i, j)] + form[(j, i)],
        core::cmp::Ordering::Equal => form[(i, i)],
        core::cmp::Ordering::Greater => 0.0,
    })
}

/// Two matrices with equally many rows, one beside the other.
pub(super) fn beside(left: &Matrix, right: &Matrix) -> Matrix {
    let mut all = Matrix::zeros(left.rows(), left.columns() + right.columns());
    all.set_block((0, 0), left);
    all.set_block((0, left.columns()), right);
    all
}

/// Two matrices with equally many columns, one above the other.
pub(super) fn above(top: &Matrix, bottom: &Matrix) -> Matrix {
    let mut all = Matrix::zeros(top.rows() + bottom.rows(), top.columns());
    all.set_block((0, 0), top);
    all.set_block((top.rows(), 0), bottom);
    all
}
