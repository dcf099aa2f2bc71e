//! Tables of systems.

use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

use libration_settings::Number;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer};

/// The equations of a system.
#[derive(Clone, Copy, Debug)]
pub enum EquationSource<'a> {
    /// In a file.
    File(&'a Path),
    /// The text of a file, with its name in messages.
    Text {
        /// The name.
        name: &'a str,
        /// The text.
        text: &'a str,
    },
}

/// The tables of `[system]`: equations, or systems of the catalogue with their parameters.
#[derive(Default)]
pub(super) struct SystemTables {
    pub(super) equations: Option<EquationsTable>,
    pub(super) catalogued: BTreeMap<String, BTreeMap<String, Number>>,
}

/// A system by equations: the name of a file, or its text.
#[derive(Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct EquationsTable {
    pub(super) of: Option<String>,
    /// In manifests, which need no other file.
    pub(super) text: Option<String>,
    /// The name of a text in messages.
    #[serde(skip)]
    pub(super) name: Option<String>,
    pub(super) parameters: BTreeMap<String, Number>,
    pub(super) max_action: Option<Numbers>,
}

impl EquationsTable {
    /// The table of a source alone.
    pub(super) fn of(source: EquationSource<'_>) -> Self {
        match source {
            EquationSource::File(path) => EquationsTable {
                of: Some(path.to_string_lossy().into_owned()),
                ..EquationsTable::default()
            },
            EquationSource::Text { name, text } => EquationsTable {
                text: Some(text.to_owned()),
                name: Some(name.to_owned()),
                ..EquationsTable::default()
            },
        }
    }
}

impl<'de> Deserialize<'de> for SystemTables {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Reader;

        // Not an untagged enum, whose errors have no place.
        impl<'de> Visitor<'de> for Reader {
            type Value = SystemTables;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a table, as [system.oscillator]")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<SystemTables, A::Error> {
                let mut tables = SystemTables::default();
                while let Some(name) = map.next_key::<String>()? {
                    if name == "equations" {
                        tables.equations = Some(map.next_value()?);
                    } else {
                        tables.catalogued.insert(name, map.next_value()?);
                    }
                }
                Ok(tables)
            }
        }
        deserializer.deserialize_map(Reader)
    }
}

/// A number, or one for each action.
#[derive(Clone, Deserialize)]
#[serde(untagged, expecting = "expected a number, or a list with one for each action")]
pub(super) enum Numbers {
    One(Number),
    Each(Vec<Number>),
}

impl Numbers {
    pub(super) const fn one(x: f64) -> Self {
        Numbers::One(Number(x))
    }
}

/// Weights of a linear policy: in one row, or a row for each action.
#[derive(Clone, Deserialize)]
#[serde(untagged, expecting = "expected a list of numbers, or one such list for each action")]
pub(super) enum Weights {
    Flat(Vec<Number>),
    Rows(Vec<Vec<Number>>),
}

impl Weights {
    pub(super) fn flat(self) -> Vec<f64> {
        let all = match self {
            Weights::Flat(all) => all,
            Weights::Rows(rows) => rows.concat(),
        };
        all.into_iter().map(|x| x.0).collect()
    }
}
