//! The table `[start]` of a settings file.

use std::fmt;

use serde::de::value::SeqAccessDeserializer;
use serde::de::{Error, IntoDeserializer, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::{Number, numbers};

/// Initial positions and velocities; a missing key has the default of the command.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct StartTable {
    /// Positions.
    pub q: Option<Coordinates>,
    /// Velocities.
    pub v: Option<Coordinates>,
}

/// A number, or a list of numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Coordinates(Vec<Number>);

impl Coordinates {
    /// The list of these numbers.
    pub fn new(coordinates: &[f64]) -> Self {
        Coordinates(coordinates.iter().copied().map(Number).collect())
    }

    /// The numbers; one for a number without a list.
    pub fn list(self) -> Vec<f64> {
        numbers(self.0)
    }
}

impl Serialize for Coordinates {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match &*self.0 {
            [one] => one.serialize(serializer),
            all => all.serialize(serializer),
        }
    }
}

impl<'de> Deserialize<'de> for Coordinates {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        // Not an untagged enum, whose errors have no place.
        struct Reader;

        impl<'de> Visitor<'de> for Reader {
            type Value = Coordinates;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number or a list of numbers")
            }
            fn visit_f64<E: Error>(self, x: f64) -> Result<Coordinates, E> {
                Ok(Coordinates(vec![Number(x)]))
            }
            fn visit_i64<E: Error>(self, x: i64) -> Result<Coordinates, E> {
                self.visit_f64(x as f64)
            }
            fn visit_u64<E: Error>(self, x: u64) -> Result<Coordinates, E> {
                self.visit_f64(x as f64)
            }
            fn visit_i128<E: Error>(self, x: i128) -> Result<Coordinates, E> {
                self.visit_f64(x as f64)
            }
            fn visit_str<E: Error>(self, text: &str) -> Result<Coordinates, E> {
                // JSON has no infinite numbers.
                let number = Number::deserialize(text.into_deserializer());
                let wrong = |_: E| E::invalid_type(serde::de::Unexpected::Str(text), &self);
                Ok(Coordinates(vec![number.map_err(wrong)?]))
            }
            fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<Coordinates, A::Error> {
                Vec::deserialize(SeqAccessDeserializer::new(list)).map(Coordinates)
            }
        }
        deserializer.deserialize_any(Reader)
    }
}
