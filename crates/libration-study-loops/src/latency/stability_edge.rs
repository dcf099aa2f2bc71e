//! Edges between stable and unstable latencies, as lines of a map.
//!
//! It uses nothing of the crate: the tests of `tests/study_loops` compile it alone, in place of the whole crate once more.

use libration::analysis::LatencyWindows;

/// Whether theory has a loop stable at a whole latency.
pub(super) fn is_stable(windows: &LatencyWindows, steps: f64) -> bool {
    windows.stable.iter().any(|&(from, to)| from <= steps && to.is_none_or(|to| steps <= to))
}

/// All edges by rising latency, from the first stable interval on; one that is a whole number is drawn between it and its
/// unstable neighbour.
pub(super) fn edges(windows: &LatencyWindows) -> Vec<f64> {
    let mut edges = Vec::new();
    for &(from, to) in &windows.stable {
        if from > 0.0 || !edges.is_empty() {
            edges.push(if from.fract() == 0.0 { from - 0.5 } else { from });
        }
        edges.extend(to.map(|to| if to.fract() == 0.0 { to + 0.5 } else { to }));
    }
    edges
}

/// Lines through edges of neighbouring rows: the k-th of each row, as long as it lies below `longest`.
pub(super) fn lines(rows: &[(f64, LatencyWindows)], longest: f64) -> Vec<(Vec<f64>, Vec<f64>)> {
    let all: Vec<(f64, Vec<f64>)> = rows.iter().map(|(y, w)| (*y, edges(w))).collect();
    let most = all.iter().map(|(_, edges)| edges.len()).max().unwrap_or(0);
    let line = |k: usize| -> (Vec<f64>, Vec<f64>) {
        let of = |(y, edges): &(f64, Vec<f64>)| {
            edges.get(k).filter(|&&x| x <= longest).map(|&x| (x, *y))
        };
        all.iter().filter_map(of).unzip()
    };
    (0..most).map(line).filter(|(x, _)| x.len() > 1).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_lie_between_stable_and_unstable_latencies_and_join_from_row_to_row() {
        let windows =
            LatencyWindows { stable: vec![(0.0, Some(4.5)), (10.25, Some(12.0)), (20.0, None)] };
        assert_eq!(edges(&windows), [4.5, 10.25, 12.5, 19.5]);
        assert_eq!([4.0, 5.0, 99.0].map(|d| is_stable(&windows, d)), [true, false, true]);
        let above = LatencyWindows { stable: vec![(0.0, Some(4.25))] };
        let lines = lines(&[(1.0, windows), (2.0, above)], 11.0);
        assert_eq!(lines, [(vec![4.5, 4.25], vec![1.0, 2.0])]);
    }
}
