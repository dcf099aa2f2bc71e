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
        struct Reader;

        impl Visitor<'_> for Reader {
            type Value = f64;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number")
            }
            fn visit_f64<E: Error>(self, x: f64) -> Result<f64, E> {
                Ok(x)
            }
            /// JSON has no infinite numbers.
            fn visit_str<E: Error>(self, x: &str) -> Result<f64, E> {
                let infinite = x.parse().ok().filter(|x: &f64| x.is_infinite());
                infinite.ok_or_else(|| E::invalid_type(serde::de::Unexpected::Str(x), &self))
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
        }

        deserializer.deserialize_any(Reader).map(Number)
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
