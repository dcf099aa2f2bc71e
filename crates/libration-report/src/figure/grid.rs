//! Values on a regular grid, and their contour lines.

use std::collections::HashMap;

use serde::Serialize;

/// Values on a grid whose samples are evenly spaced on the scale of the axes they are drawn against
/// (evenly in the logarithm on a logarithmic axis).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Grid {
    /// The abscissa of each column.
    pub x: Vec<f64>,
    /// The ordinate of each row.
    pub y: Vec<f64>,
    /// The values, row by row; what is not finite is left blank.
    pub z: Vec<f64>,
}

/// A polyline of corners `[x, y]`; closed if its last corner is its first.
pub type Polyline = Vec<[f64; 2]>;

impl Grid {
    /// Evaluates `value` on all columns `x` and rows `y`.
    pub fn sample(
        x: impl Into<Vec<f64>>,
        y: impl Into<Vec<f64>>,
        value: impl Fn(f64, f64) -> f64,
    ) -> Self {
        let (x, y) = (x.into(), y.into());
        let z = y.iter().flat_map(|&y| x.iter().map(move |&x| (x, y)));
        let z = z.map(|(x, y)| value(x, y)).collect();
        Self { x, y, z }
    }

    /// The value in a column and a row; NaN outside of the grid.
    pub fn at(&self, column: usize, row: usize) -> f64 {
        self.z.get(row * self.x.len() + column).copied().unwrap_or(f64::NAN)
    }

    /// The lines on which the grid, interpolated linearly, has the value `level` (marching squares;
    /// a saddle is decided by the mean of its cell). Cells with a blank corner have no line.
    pub fn contour(&self, level: f64) -> Vec<Polyline> {
        let mut segments = Vec::new();
        for row in 0..self.y.len().saturating_sub(1) {
            for column in 0..self.x.len().saturating_sub(1) {
                self.cell(column, row, level, &mut segments);
            }
        }
        chain(&segments)
            .iter()
            .map(|line| line.iter().map(|e| self.crossing(*e, level)).collect())
            .collect()
    }

    fn cell(&self, c: usize, r: usize, level: f64, segments: &mut Vec<[Edge; 2]>) {
        let corners = [self.at(c, r), self.at(c + 1, r), self.at(c + 1, r + 1), self.at(c, r + 1)];
        if corners.iter().any(|z| !z.is_finite()) {
            return;
        }
        let edges = [
            Edge { column: c, row: r, upright: false },
            Edge { column: c + 1, row: r, upright: true },
            Edge { column: c, row: r + 1, upright: false },
            Edge { column: c, row: r, upright: true },
        ];
        let above = corners.map(|z| z >= level);
        let crossed: Vec<usize> = (0..4).filter(|&i| above[i] != above[(i + 1) % 4]).collect();
        match crossed[..] {
            [a, b] => segments.push([edges[a], edges[b]]),
            [a, b, c, d] => {
                // Lines cut off the two corners that differ from the centre.
                let centre = corners.iter().sum::<f64>() / 4.0 >= level;
                if centre == above[0] {
                    segments.extend([[edges[a], edges[b]], [edges[c], edges[d]]]);
                } else {
                    segments.extend([[edges[d], edges[a]], [edges[b], edges[c]]]);
                }
            }
            _ => {}
        }
    }

    fn crossing(&self, edge: Edge, level: f64) -> [f64; 2] {
        let (c, r) = (edge.column, edge.row);
        let (to_c, to_r) = if edge.upright { (c, r + 1) } else { (c + 1, r) };
        let (from, to) = (self.at(c, r), self.at(to_c, to_r));
        let share = (level - from) / (to - from);
        let mix = |a: f64, b: f64| a + (b - a) * share;
        [mix(self.x[c], self.x[to_c]), mix(self.y[r], self.y[to_r])]
    }
}

/// An edge of the grid: from a sample to its right or upper neighbour.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
struct Edge {
    column: usize,
    row: usize,
    upright: bool,
}

/// Joins segments that share an edge into lines.
fn chain(segments: &[[Edge; 2]]) -> Vec<Vec<Edge>> {
    let mut touching: HashMap<Edge, Vec<usize>> = HashMap::new();
    for (index, segment) in segments.iter().enumerate() {
        for edge in segment {
            touching.entry(*edge).or_default().push(index);
        }
    }
    let mut used = vec![false; segments.len()];
    let mut walk = |start: usize| -> Option<Vec<Edge>> {
        if std::mem::replace(&mut used[start], true) {
            return None;
        }
        let mut line = segments[start].to_vec();
        for _ in 0..2 {
            line.reverse();
            while let Some(next) = touching[&line[line.len() - 1]].iter().find(|&&i| !used[i]) {
                used[*next] = true;
                let [a, b] = segments[*next];
                line.push(if a == line[line.len() - 1] { b } else { a });
            }
        }
        Some(line)
    };
    (0..segments.len()).filter_map(&mut walk).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn even(from: f64, to: f64, count: u32) -> Vec<f64> {
        (0..count).map(|i| from + (to - from) * f64::from(i) / f64::from(count - 1)).collect()
    }

    #[test]
    fn contour_of_the_unit_circle_has_radius_one() {
        let side = even(-1.5, 1.5, 151);
        let grid = Grid::sample(side.clone(), side, |x, y| x * x + y * y);
        let lines = grid.contour(1.0);
        assert_eq!(lines.len(), 1, "one closed line");
        assert_eq!(lines[0].first(), lines[0].last(), "closed");
        for [x, y] in &lines[0] {
            let radius = x.hypot(*y);
            assert!((radius - 1.0).abs() < 0.02 * 0.02 / 4.0, "radius {radius}");
        }
    }

    #[test]
    fn blank_cells_have_no_line() {
        let side = even(-1.5, 1.5, 31);
        let blank = |x: f64, y: f64| if x > 0.5 { f64::NAN } else { x * x + y * y };
        let grid = Grid::sample(side.clone(), side, blank);
        assert!(grid.contour(1.0).iter().flatten().all(|[x, _]| *x <= 0.5));
        assert!(!grid.contour(1.0).is_empty());
    }

    #[test]
    fn a_saddle_gives_two_lines_that_do_not_cross() {
        let grid = Grid::sample([0.0, 1.0], [0.0, 1.0], |x, y| if x == y { 1.0 } else { -1.0 });
        assert_eq!(grid.contour(0.1).len(), 2);
    }
}
