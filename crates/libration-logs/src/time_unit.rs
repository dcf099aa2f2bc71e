//! Units of time stamps.

/// The number of units per second, from the name of a column: `time_ns`, `t (ms)`, `stamp [us]`.
///
/// `ts` and the like have no unit: a unit follows a separator.
pub(crate) fn unit_in_name(name: &str) -> Option<i64> {
    let name = name.trim().trim_end_matches([')', ']', '"', '\'']).to_ascii_lowercase();
    let units = [
        ("ns", 1_000_000_000),
        ("nsec", 1_000_000_000),
        ("nsecs", 1_000_000_000),
        ("nanoseconds", 1_000_000_000),
        ("us", 1_000_000),
        ("usec", 1_000_000),
        ("µs", 1_000_000),
        ("μs", 1_000_000),
        ("microseconds", 1_000_000),
        ("ms", 1000),
        ("msec", 1000),
        ("milliseconds", 1000),
        ("s", 1),
        ("sec", 1),
        ("seconds", 1),
    ];
    let has = |unit: &str| {
        name.strip_suffix(unit)
            .is_some_and(|before| before.ends_with(['_', ' ', '(', '[', '/', '-', '.']))
    };
    units.into_iter().find(|(unit, _)| has(unit)).map(|(_, per_second)| per_second)
}

/// Whether a column with this name is one of time.
pub(crate) fn is_time_name(name: &str) -> bool {
    let name = name.trim().trim_matches(['"', '\'', '%', '#', '$']).trim().to_ascii_lowercase();
    let bare = match unit_in_name(&name) {
        Some(_) => name
            .trim_end_matches([')', ']'])
            .rsplit_once(['_', ' ', '(', '[', '/', '-', '.'])
            .map_or("", |(b, _)| b)
            .trim(),
        None => name.as_str(),
    };
    let bare = bare.trim_end_matches(['(', '[', '_', ' ']);
    let names = [
        "t",
        "time",
        "times",
        "timestamp",
        "timestamps",
        "time_stamp",
        "stamp",
        "stamps",
        "rosbagtimestamp",
        "epoch",
        "seconds",
        "secs",
        "sec",
        "elapsed",
        "elapsed_time",
        "simtime",
        "sim_time",
        "time.stamp",
        "header.stamp",
        "timestamp_sample",
        "__time",
        "_time",
        "nanoseconds",
    ];
    names.contains(&bare)
}

/// The number of units per second of numbers without a unit.
///
/// A clock that counts from 1970 shows its unit by its size. Other numbers that lie more than 1000 apart in the mean are nanoseconds, as
/// ROS writes them; all others are seconds.
pub(crate) fn unit_by_magnitude(first: f64, last: f64, count: usize) -> i64 {
    const SINCE_1970: [(f64, i64); 4] =
        [(1e17, 1_000_000_000), (1e14, 1_000_000), (1e11, 1000), (5e8, 1)];
    let mean_step = (last - first).abs() / count.saturating_sub(1).max(1) as f64;
    match SINCE_1970.into_iter().find(|(from, _)| first.abs() >= *from) {
        // A monotonic clock in nanoseconds has any size: a step of hours in another unit shows it.
        Some((_, per_second)) if mean_step / per_second as f64 <= 1000.0 => per_second,
        _ if mean_step > 1000.0 => 1_000_000_000,
        _ => 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_has_its_unit_behind_a_separator() {
        for (name, unit) in [
            ("time_ns", Some(1_000_000_000)),
            ("t (ms)", Some(1000)),
            ("stamp [us]", Some(1_000_000)),
            ("time_s", Some(1)),
            ("ts", None),
            ("position", None),
        ] {
            assert_eq!(unit_in_name(name), unit, "{name}");
        }
    }

    #[test]
    fn names_of_time_are_recognised() {
        for name in [
            "t",
            "Time",
            "time_s",
            "timestamp",
            "stamp",
            "time_ns",
            "time_us",
            "%time",
            "t (ms)",
            "time [s]",
            "Time (s)",
        ] {
            assert!(is_time_name(name), "{name}");
        }
        for name in ["x", "position", "tau", "temperature", "ms"] {
            assert!(!is_time_name(name), "{name}");
        }
    }

    #[test]
    fn epochs_show_their_unit_and_whole_numbers_far_apart_are_nanoseconds() {
        for (first, last, count, unit) in [
            (1.7e18, 1.700_000_000_001e18, 2, 1_000_000_000),
            (1.7e15, 1.700_000_000_001e15, 2, 1_000_000),
            (1.7e12, 1.700_000_000_01e12, 2, 1000),
            (1.7e9, 1.7e9 + 0.5, 2, 1),
            (0.0, 2.0, 3, 1),
            (0.0, 2e6, 3, 1_000_000_000),
        ] {
            assert_eq!(unit_by_magnitude(first, last, count), unit, "{first}");
        }
    }
}
