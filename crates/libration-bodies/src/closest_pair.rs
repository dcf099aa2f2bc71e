//! The two bodies that come nearest to each other.

use super::direct_sum::axes;

/// The closest pair so far.
#[derive(Clone, Debug, Default)]
pub(crate) struct ClosestPair {
    /// The bodies, the square of their distance, and the time.
    found: Option<([usize; 2], f64, f64)>,
}

impl ClosestPair {
    /// Looks at the distances of all pairs. Relative positions are those of all bodies but the first, relative to it.
    pub(crate) fn update(&mut self, positions: &[f64], is_relative: bool, time: f64) {
        let [x, y, z] = axes(positions);
        let first = usize::from(is_relative);
        let mut least = self.found.map_or(f64::INFINITY, |(_, square, _)| square);
        let mut look = |pair: [usize; 2], square: f64| {
            if square < least {
                least = square;
                self.found = Some((pair, square, time));
            }
        };
        for j in 0..x.len() {
            if is_relative {
                look([0, j + 1], x[j] * x[j] + y[j] * y[j] + z[j] * z[j]);
            }
            for i in 0..j {
                let (dx, dy, dz) = (x[j] - x[i], y[j] - y[i], z[j] - z[i]);
                look([i + first, j + first], dx * dx + dy * dy + dz * dz);
            }
        }
    }

    /// The bodies, their distance, and the time.
    pub(crate) fn found(&self) -> Option<([usize; 2], f64, f64)> {
        self.found.map(|(pair, square, time)| (pair, square.sqrt(), time))
    }
}
