//! Durations: numbers of seconds, or with a unit.

use core::fmt;

use serde::de::{Error, Visitor};
use serde::{Deserialize, Deserializer};

use crate::Number;

/// Units of durations, in s.
const DURATIONS: [(&str, f64); 9] = [
    ("ns", 1e-9),
    ("us", 1e-6),
    // The micro sign, and the Greek letter.
    ("µs", 1e-6),
    ("μs", 1e-6),
    ("ms", 1e-3),
    ("s", 1.0),
    ("min", 60.0),
    ("h", 3600.0),
    ("d", 86400.0),
];

/// Units of rates, in Hz.
const RATES: [(&str, f64); 3] = [("Hz", 1.0), ("kHz", 1e3), ("MHz", 1e6)];

/// What a duration may be, in messages.
pub const DURATION: &str = "a number of seconds, also with a unit: 0.002, 2ms, 500us or 500Hz";

/// The seconds of a duration such as `0.002`, `2ms` or `2 ms`; a rate such as `500Hz` stands for its period. None for any other text.
pub fn seconds(text: &str) -> Option<f64> {
    let text = text.trim();
    text.parse().ok().or_else(|| of_unit(text, &DURATIONS)).or_else(|| {
        // A quotient of the number and the unit, so that 500 Hz has the bits of 0.002 s.
        let (number, unit) = parts(text, &RATES)?;
        Some(1.0 / (number * unit))
    })
}

/// The rate in Hz of a text such as `500`, `500Hz` or `0.5 kHz`. None for any other text.
pub fn rate(text: &str) -> Option<f64> {
    let text = text.trim();
    text.parse().ok().or_else(|| of_unit(text, &RATES))
}

fn of_unit(text: &str, units: &[(&str, f64)]) -> Option<f64> {
    let (number, unit) = parts(text, units)?;
    // The quotient by a power of ten has one rounding, the product with a negative power two: 2 ms has the bits of 0.002 s.
    Some(if unit < 1.0 { number / (1.0 / unit).round() } else { number * unit })
}

/// The number of a text, and its unit.
fn parts(text: &str, units: &[(&str, f64)]) -> Option<(f64, f64)> {
    units.iter().find_map(|(name, unit)| {
        let number = text.strip_suffix(name)?.trim_end();
        // `1e3s` is a number and its unit, `infs` and `nans` are not.
        let is_number = number.ends_with(|c: char| c.is_ascii_digit() || c == '.');
        let number = number.parse().ok().filter(|_| is_number)?;
        Some((number, *unit))
    })
}

/// A number of seconds in a file; `"2ms"` and `"500Hz"` are read as `0.002`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seconds(pub f64);

/// Reads a field of type [`Number`] as [`Seconds`].
///
/// # Errors
/// If it is no duration.
pub fn number<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Number, D::Error> {
    Seconds::deserialize(deserializer).map(|Seconds(x)| Number(x))
}

/// Reads a field that may be missing.
///
/// # Errors
/// If it is no duration.
pub fn optional<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<Number>, D::Error> {
    number(deserializer).map(Some)
}

impl<'de> Deserialize<'de> for Seconds {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Reader;

        impl Visitor<'_> for Reader {
            type Value = f64;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(
                    "a number of seconds, or a text with a unit such as \"2ms\" or \"500Hz\"",
                )
            }
            fn visit_f64<E: Error>(self, x: f64) -> Result<f64, E> {
                Ok(x)
            }
            fn visit_i64<E: Error>(self, x: i64) -> Result<f64, E> {
                Ok(x as f64)
            }
            fn visit_u64<E: Error>(self, x: u64) -> Result<f64, E> {
                Ok(x as f64)
            }
            fn visit_i128<E: Error>(self, x: i128) -> Result<f64, E> {
                Ok(x as f64)
            }
            fn visit_str<E: Error>(self, text: &str) -> Result<f64, E> {
                seconds(text)
                    .ok_or_else(|| E::invalid_value(serde::de::Unexpected::Str(text), &self))
            }
        }

        deserializer.deserialize_any(Reader).map(Seconds)
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
            ("500Hz", 0.002),
            ("0.5 kHz", 0.002),
            ("1MHz", 1e-6),
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
