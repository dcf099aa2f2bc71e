//! Durations: numbers of seconds, or with a unit.

use serde::{Deserialize, Deserializer};

use crate::Number;
use crate::value::NumberReader;

/// Units below a second, as powers of ten.
const PARTS: [(&str, i32); 5] = [
    ("ns", -9),
    ("us", -6),
    // The micro sign, and the Greek letter.
    ("µs", -6),
    ("μs", -6),
    ("ms", -3),
];

/// Longer units, in s.
const MULTIPLES: [(&str, f64); 4] = [("s", 1.0), ("min", 60.0), ("h", 3600.0), ("d", 86400.0)];

/// Units of rates, as powers of ten.
const RATES: [(&str, i32); 3] = [("kHz", 3), ("MHz", 6), ("Hz", 0)];

/// What a duration may be, in messages.
pub const DURATION: &str = "a number of seconds, also with a unit: 0.002, 2ms or 10min";

/// What a period may be, in messages.
pub const PERIOD: &str = "a number of seconds, also with a unit: 0.002, 2ms or 500Hz";

/// The seconds of a duration such as `0.002`, `2ms` or `2 ms`, with the bits of the number in seconds. None for any other text.
pub fn seconds(text: &str) -> Option<f64> {
    let text = text.trim();
    let multiple = || {
        let of = |&(unit, factor): &(&str, f64)| {
            Some(number_before(text, unit)?.parse::<f64>().ok()? * factor)
        };
        MULTIPLES.iter().find_map(of)
    };
    text.parse().ok().or_else(|| of_power(text, &PARTS)).or_else(multiple)
}

/// The seconds of a period: a duration, or a rate such as `500Hz`. None for any other text.
pub fn period(text: &str) -> Option<f64> {
    seconds(text).or_else(|| of_power(text.trim(), &RATES).map(|rate| 1.0 / rate))
}

/// The rate in Hz of a text such as `500`, `500Hz` or `0.5 kHz`. None for any other text.
pub fn rate(text: &str) -> Option<f64> {
    let text = text.trim();
    text.parse().ok().or_else(|| of_power(text, &RATES))
}

/// The error of a latency of so many seconds that is far too long for a loop with this period: milliseconds without their unit, as a
/// rule.
pub fn excessive_latency(seconds: f64, period: f64) -> String {
    // Three digits are enough to see that it is far too much.
    let periods: f64 = format!("{:.2e}", seconds / period).parse().unwrap_or(f64::INFINITY);
    let in_digits = |x: f64| if x < 1e7 { x.to_string() } else { format!("{x:e}") };
    let [seconds, periods] = [seconds, periods].map(in_digits);
    format!("{seconds} is {seconds} s, {periods} periods; did you mean {seconds}ms?")
}

/// A number with a unit that is a power of ten: the decimal point moves, so that `33.3ms` has the bits of `0.0333`.
fn of_power(text: &str, units: &[(&str, i32)]) -> Option<f64> {
    units.iter().find_map(|(unit, power)| {
        let number = number_before(text, unit)?;
        let (digits, exponent) = number.split_once(['e', 'E']).unwrap_or((number, "0"));
        let exponent = exponent.parse::<i32>().ok()?.checked_add(*power)?;
        format!("{digits}e{exponent}").parse().ok()
    })
}

/// The text before a unit, if it is a number: `infs` and `nans` are not.
fn number_before<'t>(text: &'t str, unit: &str) -> Option<&'t str> {
    let number = text.strip_suffix(unit)?.trim_end();
    let is_number = number.ends_with(|c: char| c.is_ascii_digit() || c == '.');
    (is_number && number.parse::<f64>().is_ok()).then_some(number)
}

/// Reads a field in s as a number, or as a text such as `"2ms"`.
///
/// # Errors
/// If it is no duration.
pub fn number<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Number, D::Error> {
    let expected = "a number of seconds, or a text with a unit such as \"2ms\"";
    deserializer.deserialize_any(NumberReader { expected, of_text: seconds })
}

/// The same of a field that may be missing.
///
/// # Errors
/// If it is no duration.
pub fn optional<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Number>, D::Error> {
    Ok(Option::<Duration>::deserialize(deserializer)?.map(|Duration(x)| Number(x)))
}

/// Reads a period in s as a number, or as a text such as `"2ms"` or `"500Hz"`.
///
/// # Errors
/// If it is no period.
pub fn number_of_period<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Number, D::Error> {
    let expected = "a number of seconds, or a text with a unit such as \"2ms\" or \"500Hz\"";
    deserializer.deserialize_any(NumberReader { expected, of_text: period })
}

/// The same of a field that may be missing.
///
/// # Errors
/// If it is no period.
pub fn optional_period<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<Number>, D::Error> {
    Ok(Option::<Period>::deserialize(deserializer)?.map(|Period(x)| Number(x)))
}

/// Reads a list of periods.
///
/// # Errors
/// If one of them is no period.
pub fn list_of_periods<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Vec<Number>, D::Error> {
    let all = Vec::<Period>::deserialize(deserializer)?;
    Ok(all.into_iter().map(|Period(x)| Number(x)).collect())
}

/// A duration in s in a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Duration(pub f64);

impl<'de> Deserialize<'de> for Duration {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        number(deserializer).map(|Number(x)| Duration(x))
    }
}

/// A period in s in a file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Period(pub f64);

impl<'de> Deserialize<'de> for Period {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        number_of_period(deserializer).map(|Number(x)| Period(x))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_with_units_have_the_bits_of_their_seconds() {
        for (text, wanted) in [
            ("0.002", 0.002),
            ("2ms", 0.002),
            (" 1.5 ms ", 0.0015),
            ("500us", 0.0005),
            ("500µs", 0.0005),
            ("500μs", 0.0005),
            ("250ns", 250e-9),
            ("3s", 3.0),
            ("1e3s", 1000.0),
            ("2min", 120.0),
            ("1h", 3600.0),
            ("2d", 172_800.0),
            ("33.3ms", 0.0333),
            ("0.1us", 0.1e-6),
            ("1.1ns", 1.1e-9),
            ("2e1ms", 0.02),
            ("-2ms", -0.002),
        ] {
            assert_eq!(seconds(text), Some(wanted), "{text}");
        }
        for n in 1..2000 {
            assert_eq!(seconds(&format!("{n}ms")), format!("{n}e-3").parse().ok(), "{n}");
            assert_eq!(seconds(&format!("{n}us")), format!("{n}e-6").parse().ok(), "{n}");
        }
        assert_eq!(
            (rate("500"), rate("0.5 kHz"), rate("2Hz")),
            (Some(500.0), Some(500.0), Some(2.0))
        );
    }

    #[test]
    fn a_latency_in_seconds_that_was_meant_in_milliseconds_is_named_with_its_unit() {
        for (seconds, period, text) in [
            (12.0, 0.005, "12 is 12 s, 2400 periods; did you mean 12ms?"),
            (2.5, 0.001, "2.5 is 2.5 s, 2500 periods; did you mean 2.5ms?"),
            (40.0, 0.03, "40 is 40 s, 1330 periods; did you mean 40ms?"),
        ] {
            assert_eq!(excessive_latency(seconds, period), text);
        }
    }

    #[test]
    fn other_texts_are_no_durations() {
        for text in [
            "", "ms", "2 m", "2 sec", "2ms3", "2 ms ms", "infs", "nanms", "1,5ms", "2hz", "0x2s",
            "steps",
        ] {
            assert_eq!(seconds(text), None, "{text}");
        }
        assert_eq!((rate("2ms"), rate("Hz")), (None, None));
    }
}
