//! Latencies in a file: numbers, or names of presets.

use core::fmt;

use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

use super::LatencyPreset;
use crate::duration::seconds;

/// A latency in s; `"preset:NAME"` is read as the latency of the preset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LatencyValue(pub f64);

/// A latency in s for all channels, or one for each.
#[derive(Clone, Debug, PartialEq)]
pub enum LatencyValues {
    /// For all.
    All(f64),
    /// For each.
    Each(Vec<f64>),
}

impl<'de> Deserialize<'de> for LatencyValue {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        match deserializer.deserialize_any(Reader { takes_lists: false })? {
            LatencyValues::All(seconds) => Ok(LatencyValue(seconds)),
            // The reader takes no lists.
            LatencyValues::Each(_) => Err(D::Error::custom("expected one latency")),
        }
    }
}

impl<'de> Deserialize<'de> for LatencyValues {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Reader { takes_lists: true })
    }
}

struct Reader {
    takes_lists: bool,
}

impl<'de> Visitor<'de> for Reader {
    type Value = LatencyValues;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self.takes_lists {
            true => "a number, a text such as \"2ms\", \"preset:NAME\", or a list with one of them for each channel",
            false => "a number, a text such as \"2ms\", or \"preset:NAME\"",
        })
    }

    fn visit_f64<E: Error>(self, x: f64) -> Result<LatencyValues, E> {
        Ok(LatencyValues::All(x))
    }

    fn visit_i64<E: Error>(self, x: i64) -> Result<LatencyValues, E> {
        Ok(LatencyValues::All(x as f64))
    }

    fn visit_u64<E: Error>(self, x: u64) -> Result<LatencyValues, E> {
        Ok(LatencyValues::All(x as f64))
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<LatencyValues, E> {
        // JSON has no infinite numbers.
        if let Some(infinite) = text.parse().ok().filter(|x: &f64| x.is_infinite()) {
            return Ok(LatencyValues::All(infinite));
        }
        match LatencyPreset::parse(text).map_err(E::custom)? {
            Some(seconds) => Ok(LatencyValues::All(seconds)),
            None => seconds(text).map(LatencyValues::All).ok_or_else(|| {
                E::custom(format!(
                    "the latency is \"{text}\"; expected a number of seconds, one with a unit such as \"2ms\", or \"preset:NAME\"; help: `libration list --presets` lists the presets"
                ))
            }),
        }
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<LatencyValues, A::Error> {
        if !self.takes_lists {
            return Err(A::Error::invalid_type(serde::de::Unexpected::Seq, &self));
        }
        let mut all = Vec::new();
        while let Some(LatencyValue(seconds)) = list.next_element()? {
            all.push(seconds);
        }
        Ok(LatencyValues::Each(all))
    }
}
