//! File formats of data sets.

use libration::rl::Layout;

/// A file format of data sets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum DataFormat {
    /// Apache Parquet: a row per transition, compressed.
    #[default]
    Parquet,
    /// NumPy: a tensor `[step, environment, …]` per field.
    Npy,
    /// Minari: a folder with a Parquet file per episode.
    Minari,
}

impl DataFormat {
    /// All formats.
    pub const ALL: [DataFormat; 3] = [DataFormat::Parquet, DataFormat::Npy, DataFormat::Minari];

    /// The name, and the extension of files except for Minari.
    pub const fn name(self) -> &'static str {
        match self {
            DataFormat::Parquet => "parquet",
            DataFormat::Npy => "npy",
            DataFormat::Minari => "minari",
        }
    }

    /// The description in one line.
    pub const fn summary(self) -> &'static str {
        match self {
            DataFormat::Parquet => "a row per transition, compressed; for pandas, pyarrow, polars",
            DataFormat::Npy => "a tensor [step, environment, …] per field; for NumPy",
            DataFormat::Minari => "a folder per episode; for Minari",
        }
    }

    /// The format with this name, if it exists.
    pub fn from_name(name: &str) -> Option<DataFormat> {
        DataFormat::ALL.into_iter().find(|format| format.name() == name)
    }

    /// The number of files of a chunk; of Minari at least.
    pub(super) const fn files(self) -> u64 {
        match self {
            DataFormat::Parquet | DataFormat::Minari => 2,
            DataFormat::Npy => 6,
        }
    }

    /// The memory layout that needs no transposition.
    pub(super) fn layout(self) -> Layout {
        match self {
            DataFormat::Parquet => Layout::Planes,
            DataFormat::Npy | DataFormat::Minari => Layout::Interleaved,
        }
    }
}
