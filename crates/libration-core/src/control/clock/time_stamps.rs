//! Parser of time stamps.

use super::RecordedError;

/// Between two stamps of a loop there are not so many seconds: whole numbers that lie further apart are nanoseconds.
const LONGEST: f64 = 1000.0;

/// Digits after the point that are kept; before it there may be [`MOST_DIGITS`].
const FRACTION: usize = 18;

/// Whole digits of a number that `i128` holds with its fraction.
const MOST_DIGITS: usize = 19;

/// Reads the time stamps of a file, in seconds from the first on.
///
/// One on each line, at its beginning, before a comma, a semicolon or a space, and perhaps in parentheses, as `candump -L` has them.
/// Empty lines and those that begin with `#` are passed over, and so is the first line if it is the name of a column: letters without a
/// digit. A name that ends in `ns`, `us` or `ms` (or has that in brackets) is a unit; without one, whole numbers that lie more than 1000
/// apart in the mean are nanoseconds, as ROS writes them, and all others are seconds. Differences are exact, whatever the stamps
/// are counted from.
pub(super) fn read(text: &str) -> Result<Vec<f64>, RecordedError> {
    // Some programs mark a file as Unicode.
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let lines = text.lines().enumerate().map(|(i, line)| (i + 1, line.trim()));
    let told = lines.filter(|(_, line)| !(line.is_empty() || line.starts_with('#')));
    let (mut numbers, mut unit) = (Vec::new(), None);
    for (nth, (line, text)) in told.enumerate() {
        let first = text.split([',', ';']).next().unwrap_or(text).trim();
        let letters = first.contains(char::is_alphabetic) && !first.contains(char::is_numeric);
        let word = first.split_whitespace().next().unwrap_or(first);
        let word = word.trim_matches(['(', ')', '"', '\'']);
        match Number::read(word) {
            Some(number) => numbers.push(number),
            None if nth == 0 && letters => unit = named(first),
            None => {
                let text = text.chars().take(40).collect();
                return Err(RecordedError::Line { line, text });
            }
        }
    }
    let Some(&first) = numbers.first() else { return Ok(Vec::new()) };
    let plain: Vec<f64> = numbers.iter().map(|number| number.since(first)).collect();
    let unit = unit.unwrap_or_else(|| guessed(&numbers, &plain));
    // A division has one rounding, where a product with a decimal fraction has two.
    Ok(plain.into_iter().map(|x| x / unit).collect())
}

/// The number of units per second, from the name of a column.
fn named(name: &str) -> Option<f64> {
    let name = name.trim_end_matches([')', ']', '"', '\'']).to_ascii_lowercase();
    let units = [("ns", 1e9), ("nsec", 1e9), ("us", 1e6), ("µs", 1e6), ("ms", 1e3), ("s", 1.0)];
    let of = |unit: &str| {
        let before = name.strip_suffix(unit)?;
        before.ends_with(['_', ' ', '(', '[', '/']).then_some(())
    };
    units.into_iter().find_map(|(unit, many)| of(unit).map(|()| many))
}

/// The number of units per second, guessed from the numbers.
fn guessed(numbers: &[Number], since: &[f64]) -> f64 {
    let whole = numbers.iter().all(|number| matches!(number, Number::Decimal { whole: true, .. }));
    let steps = numbers.len().saturating_sub(1).max(1) as f64;
    let far = since.last().is_some_and(|last| last.abs() / steps > LONGEST);
    if whole && far { 1e9 } else { 1.0 }
}

/// A number as it is written.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Number {
    /// Digits and a point, in units of 10⁻¹⁸.
    Decimal { parts: i128, whole: bool },
    /// Any other.
    Float(f64),
}

impl Number {
    fn read(word: &str) -> Option<Self> {
        Self::decimal(word).or_else(|| word.parse().ok().map(Number::Float))
    }

    fn decimal(word: &str) -> Option<Self> {
        let (negative, digits) = match word.strip_prefix('-') {
            Some(digits) => (true, digits),
            None => (false, word),
        };
        let (before, after) = digits.split_once('.').unwrap_or((digits, ""));
        let all = |text: &str| text.bytes().all(|b| b.is_ascii_digit());
        let fits = before.len() <= MOST_DIGITS && after.len() <= FRACTION;
        if before.is_empty() || !fits || !all(before) || !all(after) {
            return None;
        }
        let parts: i128 = format!("{before}{after:0<FRACTION$}").parse().ok()?;
        let whole = !digits.contains('.');
        Some(Number::Decimal { parts: if negative { -parts } else { parts }, whole })
    }

    /// The difference from an earlier one.
    fn since(self, first: Number) -> f64 {
        let scale = 10.0_f64.powi(FRACTION as i32);
        match (self, first) {
            (Number::Decimal { parts, .. }, Number::Decimal { parts: first, .. }) => {
                (parts - first) as f64 / scale
            }
            (own, first) => own.float() - first.float(),
        }
    }

    fn float(self) -> f64 {
        match self {
            Number::Decimal { parts, .. } => parts as f64 / 10.0_f64.powi(FRACTION as i32),
            Number::Float(x) => x,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seconds_and_nanoseconds_are_told_apart() {
        assert_eq!(read("0\n0.001\n0.0025\n"), Ok(vec![0.0, 0.001, 0.0025]));
        assert_eq!(read("0\n1\n2\n"), Ok(vec![0.0, 1.0, 2.0]));
        // A loop of a kilohertz in nanoseconds since 1970.
        let epoch = "%time,field.x\n1700000000000000000,1\n1700000000001000017,2\n";
        assert_eq!(read(epoch), Ok(vec![0.0, 0.001_000_017]));
        for name in ["time_ns", "t (ns)", "stamp [ns]", "time_nsec"] {
            assert_eq!(read(&format!("{name}\n5\n6\n")), Ok(vec![0.0, 1e-9]), "{name}");
        }
        assert_eq!(read("t_ms,x\n10,a\n12.5,b\n"), Ok(vec![0.0, 0.0025]));
        assert_eq!(read("t_us\n10\n12\n"), Ok(vec![0.0, 2e-6]));
        // A name says more than the size.
        assert_eq!(read("time_s\n0\n5000\n"), Ok(vec![0.0, 5000.0]));
    }

    #[test]
    fn a_log_of_a_bus_is_read_with_all_its_digits() {
        let log = "(1436509052.249713) vcan0 044#2A36\n(1436509052.250714) vcan0 044#2A37\n";
        assert_eq!(read(log), Ok(vec![0.0, 0.001_001]));
    }

    #[test]
    fn what_is_no_time_stamp_is_refused_with_its_line() {
        let refused = |text: &str| read(text).unwrap_err().to_string();
        assert!(refused("time\n0\nfoo\n").starts_with("line 3 is `foo`"));
        assert!(refused("0\n\n1.2.3\n").starts_with("line 3 is `1.2.3`"));
        // Exponents and what is no number at all are left to those who check what they are.
        assert_eq!(read("1e0\n3e0\n"), Ok(vec![0.0, 2.0]));
        assert!(read("0\nnan\n").unwrap()[1].is_nan());
        assert_eq!(read("# nothing\n"), Ok(vec![]));
    }
}
