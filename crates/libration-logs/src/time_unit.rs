//! Units of time stamps.

/// A unit of time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TimeUnit {
    /// Seconds.
    S,
    /// Milliseconds.
    Ms,
    /// Microseconds.
    Us,
    /// Nanoseconds.
    Ns,
}

impl TimeUnit {
    /// The number of units per second.
    pub fn per_second(self) -> f64 {
        match self {
            TimeUnit::S => 1.0,
            TimeUnit::Ms => 1e3,
            TimeUnit::Us => 1e6,
            TimeUnit::Ns => 1e9,
        }
    }
}

/// Names of units, and the number of units per second.
const UNITS: [(&str, f64); 27] = [
    ("fs", 1e15),
    ("ps", 1e12),
    ("ns", 1e9),
    ("nsec", 1e9),
    ("nsecs", 1e9),
    ("nanosec", 1e9),
    ("nanosecs", 1e9),
    ("nanoseconds", 1e9),
    ("us", 1e6),
    ("usec", 1e6),
    ("usecs", 1e6),
    ("µs", 1e6),
    ("μs", 1e6),
    ("microseconds", 1e6),
    ("ms", 1e3),
    ("msec", 1e3),
    ("msecs", 1e3),
    ("millis", 1e3),
    ("milliseconds", 1e3),
    ("s", 1.0),
    ("sec", 1.0),
    ("secs", 1.0),
    ("seconds", 1.0),
    ("min", 1.0 / 60.0),
    ("minutes", 1.0 / 60.0),
    ("h", 1.0 / 3600.0),
    ("hours", 1.0 / 3600.0),
];

/// Characters between a name and its unit.
const SEPARATORS: [char; 7] = ['_', ' ', '(', '[', '/', '-', '.'];

/// The name without its unit in lower case, and the number of units per second: `time_ns`, `t (ms)`, `stamp [us]`, `timeMs`.
///
/// `ts` and the like have no unit: a unit follows a separator, or a name of time.
fn split_unit(name: &str) -> Option<(String, f64)> {
    let name = name.trim().trim_end_matches([')', ']', '"', '\'']);
    let lower = name.to_ascii_lowercase();
    let split = |(unit, per_second): (&str, f64)| {
        let before = lower.strip_suffix(unit)?;
        let is_name = ["time", "timestamp", "stamp"].contains(&before) && unit != "s";
        (is_name || before.ends_with(SEPARATORS))
            .then(|| (before.trim_end_matches(SEPARATORS).to_owned(), per_second))
    };
    UNITS.into_iter().find_map(split)
}

/// The number of units per second, from the name of a column.
pub(crate) fn unit_in_name(name: &str) -> Option<f64> {
    split_unit(name).map(|(_, per_second)| per_second)
}

/// The name of a stamp without `sec` or the like at its end.
pub(crate) fn split_seconds(name: &str) -> Option<String> {
    before_last_word(name, &["sec", "secs", "seconds"])
}

/// The name of a stamp without `nanosec` or the like at its end.
pub(crate) fn split_nanoseconds(name: &str) -> Option<String> {
    before_last_word(name, &["nanosec", "nanosecs", "nsec", "nsecs", "nanoseconds"])
}

fn before_last_word(name: &str, words: &[&str]) -> Option<String> {
    let (before, word) = name.rsplit_once(SEPARATORS).unwrap_or(("", name));
    words.contains(&word.to_ascii_lowercase().as_str()).then(|| before.to_owned())
}

/// Whether a text is a unit of time.
pub(crate) fn is_unit(text: &str) -> bool {
    let text = text.trim_matches(['[', ']', '(', ')', ' ']).to_ascii_lowercase();
    UNITS.into_iter().any(|(unit, _)| unit == text)
}

/// The unit of so many per second, for notes.
pub(crate) fn unit_name(per_second: f64) -> &'static str {
    UNITS.into_iter().find(|unit| unit.1 == per_second).map_or("s", |unit| unit.0)
}

/// Whether a column with this name is one of time.
pub(crate) fn is_time_name(name: &str) -> bool {
    let name = name.trim().trim_matches(['"', '\'', '%', '#', '$']).trim().to_ascii_lowercase();
    let bare = split_unit(&name).map_or_else(|| name.clone(), |(bare, _)| bare);
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

/// The number of units per second of numbers without a unit, and whether it is a guess.
///
/// A clock that counts from 1970 shows its unit by its size. Other numbers that lie more than 1000 apart in the mean are nanoseconds, as
/// ROS writes them; all others are seconds.
pub(crate) fn unit_by_magnitude(first: f64, last: f64, count: usize) -> (f64, bool) {
    const SINCE_1970: [(f64, f64); 4] = [(1e17, 1e9), (1e14, 1e6), (1e11, 1e3), (5e8, 1.0)];
    let mean_step = (last - first).abs() / count.saturating_sub(1).max(1) as f64;
    match SINCE_1970.into_iter().find(|(from, _)| first.abs() >= *from) {
        // A monotonic clock in nanoseconds has any size: a step of hours in another unit shows it.
        Some((_, per_second)) if mean_step / per_second <= 1000.0 => (per_second, false),
        _ if mean_step > 1000.0 => (1e9, true),
        _ => (1.0, true),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_has_its_unit_behind_a_separator() {
        for (name, unit) in [
            ("time_ns", Some(1e9)),
            ("t (ms)", Some(1e3)),
            ("stamp [us]", Some(1e6)),
            ("time_s", Some(1.0)),
            ("timeMs", Some(1e3)),
            ("timestampUs", Some(1e6)),
            ("time_min", Some(1.0 / 60.0)),
            ("time_ps", Some(1e12)),
            ("ts", None),
            ("times", None),
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
            "timeMs",
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
            (1.7e18, 1.700_000_000_001e18, 2, (1e9, false)),
            (1.7e15, 1.700_000_000_001e15, 2, (1e6, false)),
            (1.7e12, 1.700_000_000_01e12, 2, (1e3, false)),
            (1.7e9, 1.7e9 + 0.5, 2, (1.0, false)),
            (0.0, 2.0, 3, (1.0, true)),
            (0.0, 2e6, 3, (1e9, true)),
        ] {
            assert_eq!(unit_by_magnitude(first, last, count), unit, "{first}");
        }
    }
}
