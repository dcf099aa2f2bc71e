//! Compact path data.

use std::fmt::Write;

use crate::figure::geometry::Place;

/// A coordinate to a tenth of a pixel, as short as it goes.
pub(in crate::figure) fn px(value: f64) -> String {
    let tenths = (value * 10.0).round() as i64;
    let sign = if tenths < 0 { "-" } else { "" };
    let (whole, tenth) = (tenths.abs() / 10, tenths.abs() % 10);
    if tenth == 0 { format!("{sign}{whole}") } else { format!("{sign}{whole}.{tenth}") }
}

/// A line through places. What cannot be seen is left out: of the places in one column of half a
/// pixel stay the first, the highest, the lowest and the last.
pub(super) fn line(places: &[Place]) -> String {
    let mut out = String::new();
    let mut last = String::new();
    let mut put = |place: Place| {
        let here = format!("{} {}", px(place[0]), px(place[1]));
        if here != last {
            let _ = write!(out, "{}{here}", if out.is_empty() { "M" } else { "L" });
            last = here;
        }
    };
    let column = |place: Place| (place[0] * 2.0).floor();
    let mut rest = places;
    while let Some(&first) = rest.first() {
        let count = rest.iter().take_while(|&&place| column(place) == column(first)).count();
        let (run, after) = rest.split_at(count);
        rest = after;
        if count <= 4 {
            run.iter().for_each(|&place| put(place));
            continue;
        }
        let by_height = |a: &usize, b: &usize| run[*a][1].total_cmp(&run[*b][1]);
        let least = (0..count).min_by(by_height).unwrap_or(0);
        let most = (0..count).max_by(by_height).unwrap_or(0);
        let mut kept = [0, least.min(most), least.max(most), count - 1].to_vec();
        kept.dedup();
        kept.into_iter().for_each(|index| put(run[index]));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_are_short() {
        assert_eq!([0.04, -0.04, 1.25, -2.0, 374.0].map(px), ["0", "0", "1.3", "-2", "374"]);
    }

    #[test]
    fn a_dense_line_keeps_its_extremes() {
        let mut places: Vec<Place> =
            (0..10_000).map(|i| [f64::from(i) / 100.0, 50.0 + f64::from(i % 7)]).collect();
        places[5005][1] = 3.0;
        let path = line(&places);
        assert!(path.contains(" 3L") && path.len() < 12_000, "{} bytes", path.len());
    }
}
