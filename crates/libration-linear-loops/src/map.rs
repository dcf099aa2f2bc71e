//! Linear maps on rows.

use libration_linear::Matrix;

use super::row::{LANES, Row};

/// A linear map: of each row of its result the terms that are not zero.
#[derive(Clone, Debug, Default)]
pub(super) struct Map {
    /// Where the terms of each row end.
    ends: Vec<usize>,
    terms: Vec<Term>,
}

#[derive(Clone, Copy, Debug)]
struct Term {
    column: usize,
    factor: f64,
}

impl Map {
    /// The map by a matrix.
    pub(super) fn new(matrix: &Matrix) -> Self {
        let mut map = Map::default();
        for i in 0..matrix.rows() {
            let row = matrix.row(i).iter().enumerate().filter(|(_, factor)| **factor != 0.0);
            map.terms.extend(row.map(|(column, &factor)| Term { column, factor }));
            map.ends.push(map.terms.len());
        }
        map
    }

    /// The row `i` of the map applied to `z`, with the factors of each loop.
    #[inline(always)]
    pub(super) fn row_by(&self, i: usize, z: &[Row], factors: &[Row], sum: Row) -> Row {
        let first = if i == 0 { 0 } else { self.ends[i - 1] };
        let terms = first..self.ends[i];
        let mut found = sum;
        for (term, factor) in self.terms[terms.clone()].iter().zip(&factors[terms]) {
            let x = &z[term.column];
            for l in 0..LANES {
                found[l] += factor[l] * x[l];
            }
        }
        found
    }

    /// The number of terms.
    pub(super) fn len(&self) -> usize {
        self.terms.len()
    }

    /// The row `i` of the map applied to `z`.
    #[inline(always)]
    pub(super) fn row(&self, i: usize, z: &[Row]) -> Row {
        self.row_and(i, z, [0.0; LANES])
    }

    /// The row `i` of the map applied to `z`, added to `sum`.
    #[inline(always)]
    pub(super) fn row_and(&self, i: usize, z: &[Row], sum: Row) -> Row {
        let first = if i == 0 { 0 } else { self.ends[i - 1] };
        let mut found = sum;
        for &Term { column, factor } in &self.terms[first..self.ends[i]] {
            let x = &z[column];
            for l in 0..LANES {
                found[l] += factor * x[l];
            }
        }
        found
    }
}
