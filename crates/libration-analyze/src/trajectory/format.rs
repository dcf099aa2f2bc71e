//! The file formats of a trajectory.

use std::path::Path;

/// How a trajectory is written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Format {
    /// Text, a line for each row, floats in their shortest form.
    #[default]
    Csv,
    /// An object with what was asked, the rows, and why they end early if they do.
    Json,
    /// A NumPy structured array.
    Npy,
    /// Apache Parquet, compressed, units and request in its metadata.
    Parquet,
}

impl Format {
    /// All of them.
    pub const ALL: [Format; 4] = [Format::Csv, Format::Json, Format::Npy, Format::Parquet];

    /// Name on the command line, and extension of its files.
    pub const fn name(self) -> &'static str {
        match self {
            Format::Csv => "csv",
            Format::Json => "json",
            Format::Npy => "npy",
            Format::Parquet => "parquet",
        }
    }

    /// What it is, in one line.
    pub const fn summary(self) -> &'static str {
        match self {
            Format::Csv => "text; floats in the shortest form that reads back as the same bits",
            Format::Json => "an object with the request, the rows and why they end early if so",
            Format::Npy => "a NumPy structured array with a field for each column",
            Format::Parquet => "Apache Parquet, compressed, with units in its metadata",
        }
    }

    /// The format of that name, if there is one.
    pub fn from_name(name: &str) -> Option<Format> {
        Format::ALL.into_iter().find(|f| f.name() == name)
    }

    /// The format that the extension of `path` stands for, if it stands for one.
    pub fn of_path(path: &Path) -> Option<Format> {
        Format::from_name(&path.extension()?.to_str()?.to_ascii_lowercase())
    }

    /// Whether its files are no text.
    pub const fn is_binary(self) -> bool {
        matches!(self, Format::Npy | Format::Parquet)
    }
}
