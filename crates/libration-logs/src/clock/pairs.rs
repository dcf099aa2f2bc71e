//! Pairs of messages of two topics.

use std::collections::{HashMap, HashSet};

/// Pairs of messages.
pub(super) struct Matched {
    /// Stamps in ns, in file order of the later messages.
    pub(super) pairs: Vec<(i64, i64)>,
    pub(super) unmatched: usize,
    pub(super) unanswered: usize,
}

/// Least share of different stamps among the header stamps of a topic for which equal stamps show a cause.
const UNIQUE: f64 = 0.8;

/// Latencies between equal header stamps, each from the latest earlier message with the stamp; none if fewer than half of the later
/// messages have one, or if messages mostly repeat stamps.
pub(super) fn by_header(
    earlier: &[Option<i64>],
    earlier_headers: &[Option<i64>],
    later: &[Option<i64>],
    later_headers: &[Option<i64>],
) -> Option<Matched> {
    if ![earlier_headers, later_headers].into_iter().all(is_mostly_unique) {
        return None;
    }
    let mut times: HashMap<i64, Vec<(i64, bool)>> = HashMap::new();
    for (time, header) in earlier.iter().zip(earlier_headers) {
        if let (Some(time), Some(header)) = (time, header) {
            times.entry(*header).or_default().push((*time, false));
        }
    }
    times.values_mut().for_each(|own| own.sort_unstable());
    let mut pairs = Vec::new();
    for (time, header) in later.iter().zip(later_headers) {
        let (Some(time), Some(header)) = (time, header) else { continue };
        let Some(own) = times.get_mut(header) else { continue };
        let before = own.partition_point(|(from, _)| from <= time).saturating_sub(1);
        if let Some((from, answered)) = own.get_mut(before) {
            *answered = true;
            pairs.push((*from, *time));
        }
    }
    let unmatched = later.len() - pairs.len();
    let unanswered = times.values().flatten().filter(|(_, answered)| !answered).count();
    (pairs.len() >= unmatched).then_some(Matched { pairs, unmatched, unanswered })
}

/// Whether most header stamps occur once.
fn is_mostly_unique(headers: &[Option<i64>]) -> bool {
    let different: HashSet<i64> = headers.iter().flatten().copied().collect();
    different.len() as f64 >= UNIQUE * headers.iter().flatten().count() as f64
}

/// Latencies within a row.
pub(super) fn by_row(earlier: &[Option<i64>], later: &[Option<i64>]) -> Matched {
    let rows = earlier.iter().zip(later);
    let pairs: Vec<(i64, i64)> = rows.filter_map(|(a, b)| Some(((*a)?, (*b)?))).collect();
    let unmatched = later.iter().flatten().count() - pairs.len();
    let unanswered = earlier.iter().flatten().count() - pairs.len();
    Matched { pairs, unmatched, unanswered }
}

/// Latencies from the nearest preceding message.
pub(super) fn by_order(earlier: &[Option<i64>], later: &[Option<i64>]) -> Matched {
    let mut earlier: Vec<i64> = earlier.iter().flatten().copied().collect();
    earlier.sort_unstable();
    let mut answered = vec![false; earlier.len()];
    let mut pairs = Vec::new();
    for &time in later.iter().flatten() {
        let before = earlier.partition_point(|&own| own <= time);
        if let Some(i) = before.checked_sub(1) {
            answered[i] = true;
            pairs.push((earlier[i], time));
        }
    }
    let unmatched = later.len() - pairs.len();
    let unanswered = answered.iter().filter(|answered| !**answered).count();
    Matched { pairs, unmatched, unanswered }
}

impl Matched {
    /// The latencies in s, in the order of the pairs.
    pub(super) fn latencies(&self) -> Vec<f64> {
        self.pairs.iter().map(|&(from, to)| seconds(from, to)).collect()
    }
}

/// The time between stamps in ns, in s.
pub(super) fn seconds(from: i64, to: i64) -> f64 {
    (i128::from(to) - i128::from(from)) as f64 / 1e9
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_are_matched_with_the_nearest_that_precedes() {
        let stamps = |all: &[i64]| all.iter().map(|&x| Some(x)).collect::<Vec<_>>();
        let found = by_order(&stamps(&[10, 30, 20]), &stamps(&[5, 12, 25, 26]));
        assert_eq!(found.latencies(), [2e-9, 5e-9, 6e-9]);
        assert_eq!((found.unmatched, found.unanswered), (1, 1));
    }

    #[test]
    fn equal_header_stamps_belong_together() {
        let stamps = |all: &[i64]| all.iter().map(|&x| Some(x)).collect::<Vec<_>>();
        let (earlier, later) = (stamps(&[10, 20, 30]), stamps(&[35, 36, 37]));
        let found = by_header(&earlier, &stamps(&[1, 2, 3]), &later, &stamps(&[1, 3, 9])).unwrap();
        assert_eq!(found.latencies(), [25e-9, 6e-9]);
        assert_eq!((found.unmatched, found.unanswered), (1, 1));
        assert!(by_header(&earlier, &stamps(&[1, 2, 3]), &later, &stamps(&[7, 8, 9])).is_none());
        // Stamps that are held show no cause.
        assert!(by_header(&earlier, &stamps(&[1, 2, 3]), &later, &stamps(&[1, 1, 1])).is_none());
        // The latest earlier message of two with a stamp.
        let (earlier, headers) = (stamps(&[10, 20, 30, 40, 50, 60]), [1, 2, 3, 4, 5, 5]);
        let later = stamps(&[55, 65]);
        let found = by_header(&earlier, &stamps(&headers), &later, &stamps(&[5, 6])).unwrap();
        assert_eq!(found.latencies(), [5e-9]);
    }
}
