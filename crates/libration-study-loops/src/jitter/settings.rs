//! Settings of the study `jitter`.

use std::path::{Path, PathBuf};

use libration_logs::{StampOptions, read_time_stamps};
use libration_settings::{Fault, optional_path};
use libration_study::Settings;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Settings of the study `jitter`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JitterSettings {
    /// File with measured time stamps of a loop on this host, if any.
    pub time_stamps: Option<PathBuf>,
}

/// Settings of the study `jitter`.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Table {
    /// File of time stamps from `libration measure-jitter --output` (empty: none).
    time_stamps: String,
}

impl Default for Table {
    fn default() -> Self {
        JitterSettings::default().table()
    }
}

impl Settings for JitterSettings {
    const NAME: &'static str = "jitter";
    const TEXT: &'static str = include_str!("default.toml");
    type Table = Table;

    fn table(&self) -> Table {
        Table { time_stamps: optional_path::to_text(self.time_stamps.as_ref()) }
    }

    fn from_table(table: Table) -> Result<Self, Fault> {
        Ok(JitterSettings { time_stamps: optional_path::from_text(table.time_stamps) })
    }

    fn check(&self) -> Result<(), Fault> {
        time_stamps("jitter.time_stamps", self.time_stamps.as_deref())?;
        Ok(())
    }
}

/// A file of time stamps exists, and is the record of a clock.
fn time_stamps(key: &'static str, path: Option<&Path>) -> Result<(), Fault> {
    let Some(path) = path else { return Ok(()) };
    let wrong = |why| Fault::new(key, format!("cannot use `{}`: {why}", path.display()));
    read_time_stamps(path, &StampOptions::default()).map(|_| ()).map_err(wrong)
}
