//! Settings of the study `storage`.

use std::path::PathBuf;

use libration_settings::check::folder;
use libration_settings::{Fault, path};
use libration_study::Settings;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::bench::{StoragePeer, check_peers};

/// Settings of the study `storage`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StorageSettings {
    /// Where it writes, in a folder of its own; the system's folder for temporary files if none.
    pub folder: Option<PathBuf>,
    /// What `benches/storage.py` wrote on this machine, if its ratios are to be judged.
    pub peers: Option<PathBuf>,
}

/// The study of what is kept.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Table {
    /// The folder in which a folder of its own is written to; that of the system for temporary files if empty.
    folder: String,
    /// A file that `benches/storage.py` wrote on this machine; none if empty.
    peers: String,
}

impl Default for Table {
    fn default() -> Self {
        StorageSettings::default().table()
    }
}

impl Settings for StorageSettings {
    const NAME: &'static str = "storage";
    const TEXT: &'static str = include_str!("default.toml");
    type Table = Table;

    fn table(&self) -> Table {
        Table { folder: path::text(self.folder.as_ref()), peers: path::text(self.peers.as_ref()) }
    }

    fn from_table(table: Table) -> Result<Self, Fault> {
        Ok(StorageSettings { folder: path::of(table.folder), peers: path::of(table.peers) })
    }

    fn check(&self) -> Result<(), Fault> {
        folder("storage.folder", self.folder.as_deref())?;
        check_peers::<StoragePeer>("storage.peers", self.peers.as_deref())?;
        Ok(())
    }
}
