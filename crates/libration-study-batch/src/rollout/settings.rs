//! Settings of the study `rollout`.

use std::path::PathBuf;

use libration_settings::{Fault, path};
use libration_study::Settings;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::bench::{RolloutPeer, check_peers};

/// Settings of the study `rollout`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RolloutSettings {
    /// What `benches/rollouts.py` wrote on this machine, if its ratios are to be judged.
    pub peers: Option<PathBuf>,
}

/// The study of rollouts.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Table {
    /// A file that `benches/rollouts.py` wrote on this machine; none if empty.
    peers: String,
}

impl Default for Table {
    fn default() -> Self {
        RolloutSettings::default().table()
    }
}

impl Settings for RolloutSettings {
    const NAME: &'static str = "rollout";
    const TEXT: &'static str = include_str!("default.toml");
    type Table = Table;

    fn table(&self) -> Table {
        Table { peers: path::text(self.peers.as_ref()) }
    }

    fn from_table(table: Table) -> Result<Self, Fault> {
        Ok(RolloutSettings { peers: path::of(table.peers) })
    }

    fn check(&self) -> Result<(), Fault> {
        check_peers::<RolloutPeer>("rollout.peers", self.peers.as_deref())?;
        Ok(())
    }
}
