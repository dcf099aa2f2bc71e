//! Compact path data.

use std::fmt::Write;

use crate::figure::geometry::Place;

/// A place in tenths of a pixel.
type Tenths = [i64; 2];

/// Distance from the drawn line within which places are left out, in tenths of a pixel.
const CLOSE: f64 = 1.0;

/// A coordinate to a tenth of a pixel, as short as it goes.
pub(in crate::figure) fn px(value: f64) -> String {
    decimal(tenths(value))
}

fn tenths(value: f64) -> i64 {
    (value * 10.0).round() as i64
}

fn decimal(tenths: i64) -> String {
    let sign = if tenths < 0 { "-" } else { "" };
    let (whole, tenth) = (tenths.abs() / 10, tenths.abs() % 10);
    if tenth == 0 { format!("{sign}{whole}") } else { format!("{sign}{whole}.{tenth}") }
}

/// A line through places: its start, then the way from each corner to the next. Places that cannot be seen
/// are left out.
pub(super) fn line(places: &[Place]) -> String {
    let columns = extremes(places);
    let mut corners: Vec<Tenths> = columns.iter().map(|place| place.map(tenths)).collect();
    corners.dedup();
    let corners = simplified(&corners);
    let Some(&first) = corners.first() else { return String::new() };
    let mut out = format!("M{} {}", decimal(first[0]), decimal(first[1]));
    for (index, pair) in corners.windows(2).enumerate() {
        let [x, y] = [0, 1].map(|i| decimal(pair[1][i] - pair[0][i]));
        // A minus separates numbers, as a space does.
        let before = match index {
            0 => "l",
            _ if x.starts_with('-') => "",
            _ => " ",
        };
        let between = if y.starts_with('-') { "" } else { " " };
        let _ = write!(out, "{before}{x}{between}{y}");
    }
    out
}

/// Of the places in one column of half a pixel the first, the highest, the lowest and the last.
fn extremes(places: &[Place]) -> Vec<Place> {
    let column = |place: Place| (place[0] * 2.0).floor();
    let mut out = Vec::new();
    let mut rest = places;
    while let Some(&first) = rest.first() {
        let count = rest.iter().take_while(|&&place| column(place) == column(first)).count();
        let (run, after) = rest.split_at(count);
        rest = after;
        if count <= 4 {
            out.extend(run);
            continue;
        }
        let by_height = |a: &usize, b: &usize| run[*a][1].total_cmp(&run[*b][1]);
        let least = (0..count).min_by(by_height).unwrap_or(0);
        let most = (0..count).max_by(by_height).unwrap_or(0);
        let mut kept = [0, least.min(most), least.max(most), count - 1].to_vec();
        kept.dedup();
        out.extend(kept.into_iter().map(|index| run[index]));
    }
    out
}

/// The corners of a line that passes all `corners` at a distance of at most [`CLOSE`] (Douglas and Peucker 1973).
fn simplified(corners: &[Tenths]) -> Vec<Tenths> {
    let Some(last) = corners.len().checked_sub(1) else { return Vec::new() };
    let mut kept = vec![false; corners.len()];
    (kept[0], kept[last]) = (true, true);
    let mut spans = vec![(0, last)];
    while let Some((from, to)) = spans.pop() {
        let off = |i: usize| distance(corners[i], [corners[from], corners[to]]);
        let farthest = (from + 1..to).map(|i| (i, off(i))).max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((middle, _)) = farthest.filter(|&(_, off)| off > CLOSE) {
            kept[middle] = true;
            spans.extend([(from, middle), (middle, to)]);
        }
    }
    corners.iter().zip(kept).filter_map(|(corner, kept)| kept.then_some(*corner)).collect()
}

/// The distance of a place from a segment.
fn distance(place: Tenths, [from, to]: [Tenths; 2]) -> f64 {
    let way = |a: Tenths, b: Tenths| [0, 1].map(|i| (b[i] - a[i]) as f64);
    let ([x, y], [along, across]) = (way(from, place), way(from, to));
    let square = along * along + across * across;
    let share =
        if square > 0.0 { ((x * along + y * across) / square).clamp(0.0, 1.0) } else { 0.0 };
    (x - share * along).hypot(y - share * across)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The corners of a path that [`line`] wrote.
    fn corners(path: &str) -> Vec<Place> {
        let spaced = path.replace('-', " -").replace(['M', 'l'], " ");
        let numbers: Vec<f64> = spaced.split_whitespace().map(|n| n.parse().unwrap()).collect();
        let mut at = [0.0, 0.0];
        let mut corners = Vec::new();
        for step in numbers.chunks(2) {
            at = [at[0] + step[0], at[1] + step[1]];
            corners.push(at);
        }
        corners
    }

    #[test]
    fn coordinates_are_short() {
        assert_eq!([0.04, -0.04, 1.25, -2.0, 374.0].map(px), ["0", "0", "1.3", "-2", "374"]);
    }

    #[test]
    fn a_line_is_written_as_its_start_and_ways_without_drift() {
        assert_eq!(line(&[[10.0, 20.0], [11.5, 18.0], [10.0, 18.0]]), "M10 20l1.5-2-1.5 0");
        assert_eq!(line(&[[1.0, 2.0]]), "M1 2");
        assert_eq!(line(&[]), "");
        // A thousand ways, each of which rounds up.
        let zigzag: Vec<Place> =
            (0..1000).map(|i| [0.66 * f64::from(i), 5.0 * f64::from(i % 2)]).collect();
        let end = *corners(&line(&zigzag)).last().unwrap();
        assert!((end[0] - 659.34).abs() <= 0.05 + 1e-9, "{end:?}");
    }

    #[test]
    fn every_corner_lies_within_a_tenth_of_a_pixel_of_the_simplified_line() {
        let spiral: Vec<Tenths> = (0..4000)
            .map(|i| {
                let (sine, cosine) = (f64::from(i) / 100.0).sin_cos();
                let radius = f64::from(i) / 20.0;
                [300.0 + radius * cosine, 250.0 + radius * sine].map(tenths)
            })
            .collect();
        let drawn = simplified(&spiral);
        assert!(drawn.len() < spiral.len() / 5, "{} corners", drawn.len());
        for &corner in &spiral {
            let off = |pair: &[Tenths]| distance(corner, [pair[0], pair[1]]);
            let nearest = drawn.windows(2).map(off).fold(f64::INFINITY, f64::min);
            assert!(nearest <= 1.0, "{corner:?}: {nearest} tenths of a pixel");
        }
    }

    #[test]
    fn a_closed_line_keeps_its_corners() {
        let square = [[0.0, 0.0], [5.0, 0.0], [9.0, 0.0], [9.0, 9.0], [0.0, 9.0], [0.0, 0.0]];
        assert_eq!(line(&square), "M0 0l9 0 0 9-9 0 0-9");
    }

    #[test]
    fn a_dense_line_keeps_its_extremes() {
        let mut places: Vec<Place> =
            (0..10_000).map(|i| [f64::from(i) / 100.0, 50.0 + f64::from(i % 7)]).collect();
        places[5005][1] = 3.0;
        let path = line(&places);
        assert!(corners(&path).iter().any(|[_, y]| (y - 3.0).abs() < 1e-9), "{path}");
        assert!(path.len() < 6000, "{} bytes", path.len());
    }
}
