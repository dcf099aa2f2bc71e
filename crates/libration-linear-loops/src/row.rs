//! Rows of numbers of neighbouring loops.

/// Loops in a tile. Sums over four vectors of AVX2, or two of AVX-512, do not wait for each other.
pub(super) const LANES: usize = 16;

/// A number of each loop of a tile.
pub(super) type Row = [f64; LANES];
