//! The formats of data sets.

use libration::rl::Layout;

/// How the files of a data set are made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum DataFormat {
    /// Apache Parquet: a row for each transition, compressed.
    #[default]
    Parquet,
    /// NumPy's own: a tensor `[step, environment, …]` for each field.
    Npy,
    /// What the package Minari reads: a folder for each episode, with a Parquet file.
    Minari,
}

impl DataFormat {
    /// All of them.
    pub const ALL: [DataFormat; 3] = [DataFormat::Parquet, DataFormat::Npy, DataFormat::Minari];

    /// Its name, which is the extension of files except for Minari's.
    pub const fn name(self) -> &'static str {
        match self {
            DataFormat::Parquet => "parquet",
            DataFormat::Npy => "npy",
            DataFormat::Minari => "minari",
        }
    }

    /// What it is, in one line.
    pub const fn summary(self) -> &'static str {
        match self {
            DataFormat::Parquet => {
                "a row for each transition, compressed; for pandas, pyarrow, polars"
            }
            DataFormat::Npy => "a tensor [step, environment, …] for each field; for NumPy",
            DataFormat::Minari => "a folder for each episode; for Minari",
        }
    }

    /// The format of that name, if there is one.
    pub fn from_name(name: &str) -> Option<DataFormat> {
        DataFormat::ALL.into_iter().find(|format| format.name() == name)
    }

    /// How tensors lie in memory, so that nothing has to be turned around.
    pub(super) fn layout(self) -> Layout {
        match self {
            DataFormat::Parquet => Layout::Planes,
            DataFormat::Npy | DataFormat::Minari => Layout::Interleaved,
        }
    }
}
