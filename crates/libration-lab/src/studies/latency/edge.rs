//! Edges between stable and unstable latencies, as lines of a map.

use libration::analysis::Windows;

/// Whether theory has a loop stable at a whole latency.
pub(super) fn is_stable(windows: &Windows, steps: f64) -> bool {
    windows.stable.iter().any(|&(from, to)| from <= steps && to.is_none_or(|to| steps <= to))
}

/// All edges by rising latency, from the first stable interval on; one that is a whole number is drawn between it and its
/// unstable neighbour.
pub(super) fn edges(windows: &Windows) -> Vec<f64> {
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
pub(super) fn lines(rows: &[(f64, Windows)], longest: f64) -> Vec<(Vec<f64>, Vec<f64>)> {
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
