//! Tables of systems.

use std::collections::BTreeMap;
use std::path::Path;

use libration_settings::Number;
use serde::Deserialize;

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
