//! File formats of trajectories.

use std::path::Path;

/// A file format of trajectories.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Format {
    /// Text with a line per row and floats in their shortest form.
    #[default]
    Csv,
    /// An object with the request, the rows, and the reason if they end early.
    Json,
    /// A NumPy structured array.
    Npy,
    /// Apache Parquet, compressed, units and request in its metadata.
    Parquet,
}

impl Format {
    /// All formats.
    pub const ALL: [Format; 4] = [Format::Csv, Format::Json, Format::Npy, Format::Parquet];

    /// The name on the command line and the extension of files.
    pub const fn name(self) -> &'static str {
        match self {
            Format::Csv => "csv",
            Format::Json => "json",
            Format::Npy => "npy",
            Format::Parquet => "parquet",
        }
    }

    /// The description in one line.
    pub const fn summary(self) -> &'static str {
        match self {
            Format::Csv => "text; floats in the shortest form that round-trips to the same bits",
            Format::Json => {
                "an object with the request, the rows, and the reason if they end early"
            }
            Format::Npy => "a NumPy structured array with a field for each column",
            Format::Parquet => "Apache Parquet, compressed, with units in its metadata",
        }
    }

    /// The format with this name, if it exists.
    pub fn from_name(name: &str) -> Option<Format> {
        Format::ALL.into_iter().find(|f| f.name() == name)
    }

    /// The format of the extension of `path`, if it exists.
    pub fn of_path(path: &Path) -> Option<Format> {
        Format::from_name(&path.extension()?.to_str()?.to_ascii_lowercase())
    }

    /// Whether files are binary.
    pub const fn is_binary(self) -> bool {
        matches!(self, Format::Npy | Format::Parquet)
    }
}
