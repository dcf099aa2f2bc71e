//! Conditions of two runs that differ.

use serde::Serialize;
use serde_json::{Map, Value};

/// A condition of the runs that differs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Condition {
    /// Its key in `results.json`.
    pub key: String,
    /// Its value in the first run.
    pub before: String,
    /// Its value in the second run.
    pub after: String,
}

/// The entries of a table that differ, each with its key.
pub(crate) fn differing<'a>(
    table: &'a str,
    [first, second]: [&'a Map<String, Value>; 2],
) -> impl Iterator<Item = Condition> + 'a {
    let others = second.keys().filter(|key| !first.contains_key(*key));
    first.keys().chain(others).filter_map(move |key| {
        let of = |map: &Map<String, Value>| map.get(key).unwrap_or(&Value::Null).to_string();
        let (before, after) = (of(first), of(second));
        (before != after).then(|| Condition { key: format!("{table}.{key}"), before, after })
    })
}
