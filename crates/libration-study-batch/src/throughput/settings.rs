//! Settings of the study `throughput`.

use std::path::PathBuf;

use libration_settings::validation::{check_counts, parse_counts, parse_names};
use libration_settings::{Count, Fault, optional_path};
use libration_study::{Settings, schema};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Deserialize, Serialize};

use crate::bench::{Implementation, Peer, check_peers};

/// Settings of the study `throughput`.
#[derive(Clone, Debug, PartialEq)]
pub struct ThroughputSettings {
    /// Implementations to measure, each once.
    pub implementations: Vec<Implementation>,
    /// Numbers of trajectories, ascending; effort and memory limit them.
    pub counts: Vec<u64>,
    /// Result file of `benches/peers.py` on this machine, if any.
    pub peers: Option<PathBuf>,
}

impl Default for ThroughputSettings {
    fn default() -> Self {
        ThroughputSettings {
            implementations: Implementation::ALL.to_vec(),
            counts: (0..=8).map(|power| 10u64.pow(power)).collect(),
            peers: None,
        }
    }
}

/// The study of speed.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Table {
    /// Implementations to measure, each once.
    #[schemars(schema_with = "implementations_schema")]
    implementations: Vec<String>,
    /// Numbers of trajectories, each once; effort and memory limit them.
    #[schemars(schema_with = "schema::horizons")]
    counts: Vec<Count>,
    /// Result file of `benches/peers.py` on this machine (empty: none).
    peers: String,
}

impl Default for Table {
    fn default() -> Self {
        ThroughputSettings::default().table()
    }
}

impl Settings for ThroughputSettings {
    const NAME: &'static str = "throughput";
    const TEXT: &'static str = include_str!("default.toml");
    type Table = Table;

    fn table(&self) -> Table {
        Table {
            implementations: self.implementations.iter().map(|one| one.name().into()).collect(),
            counts: self.counts.iter().map(|&n| Count(n.into())).collect(),
            peers: optional_path::to_text(self.peers.as_ref()),
        }
    }

    fn from_table(table: Table) -> Result<Self, Fault> {
        Ok(ThroughputSettings {
            implementations: implementations("throughput.implementations", &table.implementations)?,
            counts: parse_counts("throughput.counts", table.counts)?,
            peers: optional_path::from_text(table.peers),
        })
    }

    fn check(&self) -> Result<(), Fault> {
        each_once("throughput.implementations", &self.implementations)?;
        check_counts("throughput.counts", &self.counts)?;
        check_peers::<Peer>("throughput.peers", self.peers.as_deref())?;
        Ok(())
    }

    fn sort(&mut self) {
        self.counts.sort_unstable();
    }
}

/// The implementations of these names.
fn implementations(key: &'static str, list: &[String]) -> Result<Vec<Implementation>, Fault> {
    let known = Implementation::ALL.map(Implementation::name);
    parse_names(key, ("implementation", "implementations"), list, &known, Implementation::from_name)
}

/// Implementations, at least one, each once.
fn each_once(key: &'static str, list: &[Implementation]) -> Result<(), Fault> {
    if list.is_empty() {
        return Err(Fault::new(key, format!("`{key}` must name at least one")));
    }
    for (i, one) in list.iter().enumerate() {
        if list[..i].contains(one) {
            let message = format!("the implementation `{}` is named twice", one.name());
            return Err(Fault::at(key, i, message));
        }
    }
    Ok(())
}

fn implementations_schema(_: &mut SchemaGenerator) -> Schema {
    schema::list(schema::one_of(&Implementation::ALL.map(Implementation::name)))
}
