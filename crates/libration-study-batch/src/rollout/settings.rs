//! Settings of the study `rollout`.

use std::path::PathBuf;

use libration_settings::{Fault, optional_path};
use libration_study::Settings;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::bench::{RolloutPeer, check_peers};

/// Settings of the study `rollout`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RolloutSettings {
    /// Result file of `benches/rollouts.py` on this machine, if any.
    pub peers: Option<PathBuf>,
}

/// Settings of the study `rollout`.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Table {
    /// Result file of `benches/rollouts.py` on this machine (empty: none).
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
        Table { peers: optional_path::to_text(self.peers.as_ref()) }
    }

    fn from_table(table: Table) -> Result<Self, Fault> {
        Ok(RolloutSettings { peers: optional_path::from_text(table.peers) })
    }

    fn check(&self) -> Result<(), Fault> {
        check_peers::<RolloutPeer>("rollout.peers", self.peers.as_deref())?;
        Ok(())
    }
}
