//! Settings of the study `jitter`.

use std::path::{Path, PathBuf};

use libration_advise::wakeups;
use libration_settings::{Fault, path};
use libration_study::Settings;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Settings of the study `jitter`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JitterSettings {
    /// Time stamps of a loop that ran on this host, if its clock is to be judged.
    pub time_stamps: Option<PathBuf>,
}

/// The study of uneven clocks.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(default, deny_unknown_fields)]
pub struct Table {
    /// A file of time stamps, as `libration measure-jitter --output` writes it; none if empty.
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
        Table { time_stamps: path::text(self.time_stamps.as_ref()) }
    }

    fn from_table(table: Table) -> Result<Self, Fault> {
        Ok(JitterSettings { time_stamps: path::of(table.time_stamps) })
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
    wakeups::time_stamps(path).map(|_| ()).map_err(wrong)
}
