//! Settings of the study `storage`.

use std::path::PathBuf;

use libration_settings::validation::check_folder;
use libration_settings::{Fault, optional_path};
use libration_study::Settings;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::bench::{StoragePeer, check_peers};

/// Settings of the study `storage`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StorageSettings {
    /// Folder for a temporary subfolder; by default the folder for temporary files.
    pub folder: Option<PathBuf>,
    /// Result file of `benches/storage.py` on this machine, if any.
    pub peers: Option<PathBuf>,
}

/// Settings of the study `storage`.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Table {
    /// Folder for a temporary subfolder (empty: the folder for temporary files).
    folder: String,
    /// Result file of `benches/storage.py` on this machine (empty: none).
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
        Table {
            folder: optional_path::to_text(self.folder.as_ref()),
            peers: optional_path::to_text(self.peers.as_ref()),
        }
    }

    fn from_table(table: Table) -> Result<Self, Fault> {
        Ok(StorageSettings {
            folder: optional_path::from_text(table.folder),
            peers: optional_path::from_text(table.peers),
        })
    }

    fn check(&self) -> Result<(), Fault> {
        check_folder("storage.folder", self.folder.as_deref())?;
        check_peers::<StoragePeer>("storage.peers", self.peers.as_deref())?;
        Ok(())
    }
}
