//! Linear equations of few polynomials.

use libration_core::{Elementary, Scalar};

use super::UnknownImplicitStep;

/// The `x` with `matrix · x = right`, by Cramer's rule.
///
/// Of polynomials it divides once, so that degrees stay those of determinants. Elimination multiplies denominators that cancel later.
pub(crate) fn solve<const N: usize>(
    matrix: &[[UnknownImplicitStep; N]; N],
    right: &[UnknownImplicitStep; N],
) -> [UnknownImplicitStep; N] {
    let rows = |column: Option<usize>| -> Vec<Vec<UnknownImplicitStep>> {
        let rows = matrix.iter().zip(right).map(|(row, &right)| {
            let mut row = row.to_vec();
            if let Some(place) = column.and_then(|j| row.get_mut(j)) {
                *place = right;
            }
            row
        });
        rows.collect()
    };
    let denominator = determinant(&rows(None));
    core::array::from_fn(|j| determinant(&rows(Some(j))).quotient(denominator))
}

/// The determinant, by expansion along the first column.
fn determinant(rows: &[Vec<UnknownImplicitStep>]) -> UnknownImplicitStep {
    let mut sum = UnknownImplicitStep::zero();
    if rows.is_empty() {
        return UnknownImplicitStep::one();
    }
    for (i, row) in rows.iter().enumerate() {
        let others = rows.iter().enumerate().filter(|(k, _)| *k != i);
        let minor: Vec<Vec<UnknownImplicitStep>> =
            others.map(|(_, row)| row[1..].to_vec()).collect();
        let term = row[0] * determinant(&minor);
        sum = if i % 2 == 0 { sum + term } else { sum - term };
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_equations_of_polynomials_are_solved() {
        let number = UnknownImplicitStep::from_f64;
        let z = UnknownImplicitStep::unknown();
        let wanted = [number(1.0), z, number(3.0) - z];
        let matrix = [
            [number(2.0), z, number(0.0)],
            [z, number(0.0), number(-1.0)],
            [number(0.0), number(1.0), number(1.0)],
        ];
        let right = matrix
            .map(|row| row.into_iter().zip(wanted).fold(number(0.0), |sum, (a, x)| sum + a * x));
        assert_eq!(solve(&matrix, &right), wanted);
    }
}
