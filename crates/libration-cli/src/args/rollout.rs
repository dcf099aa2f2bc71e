//! What `rollout` and `verify` take.

use std::path::PathBuf;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{ArgGroup, Args};
use libration_env::dataset::DataFormat;

use super::number::whole_number;

/// What `rollout` takes.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct RolloutArgs {
    /// File of settings [default: the case of the report]
    #[arg(long, value_name = "FILE")]
    pub(crate) config: Option<PathBuf>,
    /// Folder for the data set
    #[arg(long, value_name = "DIR", required_unless_present = "print_config")]
    pub(crate) out: Option<PathBuf>,
    /// At least so many transitions, in whole steps of all environments [default: those of the settings]
    #[arg(long, value_name = "N", value_parser = transitions, allow_hyphen_values = true)]
    pub(crate) transitions: Option<u64>,
    /// Format of the files
    #[arg(long, value_parser = formats(), default_value = "parquet")]
    pub(crate) format: DataFormat,
    /// Only the I-th of N parts of the environments: the parts of all N together are the data set
    #[arg(long, value_name = "I/N", value_parser = shard, default_value = "1/1")]
    pub(crate) shard: [usize; 2],
    /// Resume the interrupted data set in the folder; reads all of it first and repairs broken chunks
    #[arg(long)]
    pub(crate) resume: bool,
    /// Threads; 0 for as many as there are cores
    #[arg(long, value_name = "N", default_value = "0")]
    pub(crate) threads: usize,
    /// Print the default settings, with comments, and stop
    #[arg(long, conflicts_with_all = ["config", "out", "transitions", "shard", "resume", "threads"])]
    pub(crate) print_config: bool,
}

const EXAMPLES: &str = "\
Examples:
  libration rollout --out swings
  libration rollout --print-config > mine.toml
  libration rollout --config mine.toml --out data --transitions 1e9 --format npy
  libration rollout --config mine.toml --out data --transitions 1e9 --format npy --resume
  libration rollout --config mine.toml --out part-2 --shard 2/3

With Parquet the folder gets transitions/*.parquet, a row for each transition, with npy a folder for each field with
tensors [step, environment, …]; both get ends/*: what was seen where an episode ended, and after the last step of a
chunk where one goes on. Chunks are listed in manifest.jsonl, with checksums, as soon as they are on the disk. All
follows from the settings: what was interrupted ends as if it had not been, byte for byte.";

/// What `verify` takes.
#[derive(Args, Debug)]
#[command(
    after_help = "Examples:\n  libration verify data\n  libration verify data --replay\n  libration verify data --repair",
    group(ArgGroup::new("computing").args(["replay", "repair"]).multiple(true))
)]
pub(crate) struct VerifyArgs {
    /// Folder of the data set
    pub(crate) folder: PathBuf,
    /// Compute all of it again and compare the bits
    #[arg(long)]
    pub(crate) replay: bool,
    /// Compute broken chunks again and replace their files: missing, truncated or altered ones
    #[arg(long)]
    pub(crate) repair: bool,
    /// Threads of --replay and --repair; 0 for as many as there are cores
    #[arg(long, value_name = "N", default_value = "0", requires = "computing")]
    pub(crate) threads: usize,
}

fn transitions(text: &str) -> Result<u64, String> {
    let most = 1_000_000_000_000_000;
    let count = whole_number(text).and_then(|n| u64::try_from(n).ok());
    let count = count.filter(|count| (1..=most).contains(count));
    count.ok_or_else(|| "it must be a whole number from 1 to 1e15".to_owned())
}

fn shard(text: &str) -> Result<[usize; 2], String> {
    let parts = text.split_once('/').and_then(|(i, n)| Some([i.parse().ok()?, n.parse().ok()?]));
    let parts: Option<[usize; 2]> = parts.filter(|&[i, n]: &[usize; 2]| 1 <= i && i <= n);
    parts.ok_or_else(|| {
        "it must be two whole numbers, the first from 1 to the second, as 2/3".to_owned()
    })
}

fn formats() -> impl TypedValueParser<Value = DataFormat> {
    let value = |format: DataFormat| PossibleValue::new(format.name()).help(format.summary());
    PossibleValuesParser::new(DataFormat::ALL.map(value))
        .try_map(|name| DataFormat::from_name(&name).ok_or("unknown format"))
}
