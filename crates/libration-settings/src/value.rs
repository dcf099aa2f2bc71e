//! Numbers in settings files.

use std::fmt;

use serde::de::{Error, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

/// A number; `10` is read as `10.0`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(transparent)]
pub struct Number(pub f64);

/// A whole number; `1e6` is read as `1_000_000`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(transparent)]
pub struct Count(pub i128);

impl<'de> Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        // JSON has no infinite numbers.
        let of_text = |text: &str| text.parse().ok().filter(|x: &f64| x.is_infinite());
        deserializer.deserialize_any(NumberReader { expected: "a number", of_text })
    }
}

/// Reads a number, or a text that stands for one.
pub(crate) struct NumberReader {
    pub(crate) expected: &'static str,
    pub(crate) of_text: fn(&str) -> Option<f64>,
}

impl Visitor<'_> for NumberReader {
    type Value = Number;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.expected)
    }
    fn visit_f64<E: Error>(self, x: f64) -> Result<Number, E> {
        Ok(Number(x))
    }
    fn visit_str<E: Error>(self, text: &str) -> Result<Number, E> {
        let number = (self.of_text)(text).map(Number);
        number.ok_or_else(|| E::invalid_type(serde::de::Unexpected::Str(text), &self))
    }
    fn visit_i64<E: Error>(self, x: i64) -> Result<Number, E> {
        Ok(Number(x as f64))
    }
    fn visit_u64<E: Error>(self, x: u64) -> Result<Number, E> {
        Ok(Number(x as f64))
    }
    fn visit_i128<E: Error>(self, x: i128) -> Result<Number, E> {
        Ok(Number(x as f64))
    }
}

impl<'de> Deserialize<'de> for Count {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Reader;

        impl Visitor<'_> for Reader {
            type Value = i128;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a whole number")
            }
            fn visit_f64<E: Error>(self, x: f64) -> Result<i128, E> {
                // The cast saturates far outside the range of any count.
                if x.fract() == 0.0 {
                    Ok(x as i128)
                } else {
                    Err(E::invalid_type(serde::de::Unexpected::Float(x), &self))
                }
            }
            fn visit_i64<E: Error>(self, x: i64) -> Result<i128, E> {
                Ok(x.into())
            }
            fn visit_u64<E: Error>(self, x: u64) -> Result<i128, E> {
                Ok(x.into())
            }
            fn visit_i128<E: Error>(self, x: i128) -> Result<i128, E> {
                Ok(x)
            }
        }

        deserializer.deserialize_any(Reader).map(Count)
    }
}

/// The numbers of a list.
pub fn numbers(list: Vec<Number>) -> Vec<f64> {
    list.into_iter().map(|Number(x)| x).collect()
}
