//! Arguments of `rollout`, `join` and `verify`.

use std::path::PathBuf;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{ArgGroup, Args};
use libration_env::dataset::DataFormat;

use super::number::{assignment, whole_number};

/// Arguments of `rollout`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct RolloutArgs {
    /// Settings file [default: the settings of the report]
    #[arg(long, value_name = "FILE")]
    pub(crate) config: Option<PathBuf>,
    /// File of a system by equations with a task, in place of the system of the settings
    #[arg(long, value_name = "FILE")]
    pub(crate) system: Option<PathBuf>,
    /// Parameter of --system, e.g. pole=0.2; repeatable
    #[arg(
        long,
        value_name = "KEY=VALUE",
        value_parser = assignment,
        requires = "system",
        allow_hyphen_values = true
    )]
    pub(crate) set: Vec<(String, f64)>,
    /// Output folder of the data set
    #[arg(long, value_name = "DIR", required_unless_present = "print_config")]
    pub(crate) out: Option<PathBuf>,
    /// Minimum number of transitions, rounded up to whole steps of all environments [default: that of the settings]
    #[arg(long, value_name = "N", value_parser = transitions, allow_hyphen_values = true)]
    pub(crate) transitions: Option<u64>,
    /// Format of the files
    #[arg(long, value_parser = formats(), default_value = "parquet")]
    pub(crate) format: DataFormat,
    /// Write only the I-th of N shards of the environments
    #[arg(long, value_name = "I/N", value_parser = shard, default_value = "1/1")]
    pub(crate) shard: [usize; 2],
    /// Resume an interrupted data set after its last chunk; writes missing and truncated files again
    #[arg(long)]
    pub(crate) resume: bool,
    /// Number of threads (0: one per core)
    #[arg(long, value_name = "N", default_value = "0")]
    pub(crate) threads: usize,
    /// Print the default settings with comments, and exit
    #[arg(long, conflicts_with_all = ["config", "system", "out", "transitions", "shard", "resume", "threads"])]
    pub(crate) print_config: bool,
}

const EXAMPLES: &str = "\
Examples:
  libration rollout --out swings
  libration rollout --print-config > mine.toml
  libration rollout --config mine.toml --out data --transitions 1e9 --format npy
  libration rollout --system cart_pole.toml --set pole=0.2 --out falls
  libration rollout --config mine.toml --out data --transitions 1e9 --format npy --resume
  libration rollout --config mine.toml --out part-2 --shard 2/3      (then join part-1 part-2 part-3)

parquet: transitions/*.parquet has one row per transition.
npy: one folder per field has tensors [step, environment, …].
Both: ends/* has the final observation of each episode. For an episode that continues in the next
chunk, it has the observation after the last step of the chunk.
manifest.jsonl lists each chunk with checksums as soon as the chunk is on the disk.
The settings determine every byte: a resumed data set equals one without interruption.";

/// Arguments of `join`.
#[derive(Args, Debug)]
#[command(after_help = JOIN_EXAMPLES)]
pub(crate) struct JoinArgs {
    /// Folders of all shards, in any order
    #[arg(required = true, value_name = "PART")]
    pub(crate) parts: Vec<PathBuf>,
    /// Output folder of the data set
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Link files instead of copying them, where the file system can; they are not read
    #[arg(long)]
    pub(crate) link: bool,
    /// Resume an interrupted join
    #[arg(long)]
    pub(crate) resume: bool,
}

const JOIN_EXAMPLES: &str = "\
Examples:
  libration join part-1 part-2 part-3 --out data
  libration join part-* --out data --link
  libration verify data

The shards must be finished, of the same settings, complete, and none may be there twice.
The joined data set has the bytes that a single run writes. The shards stay as they are.
Linked files share their bytes with the shards, which may then be removed.";

/// Arguments of `verify`.
#[derive(Args, Debug)]
#[command(
    after_help = "Examples:\n  libration verify data\n  libration verify data --replay\n  libration verify data --repair",
    group(ArgGroup::new("computing").args(["replay", "repair"]).multiple(true))
)]
pub(crate) struct VerifyArgs {
    /// Folder of the data set, or of a report of `lab`: its studies are recomputed and all bits compared
    pub(crate) folder: PathBuf,
    /// Recompute the data set and compare all bits
    #[arg(long)]
    pub(crate) replay: bool,
    /// Recompute chunks with missing, truncated or altered files, and replace these files
    #[arg(long)]
    pub(crate) repair: bool,
    /// Number of threads of --replay and --repair (0: one per core)
    #[arg(long, value_name = "N", default_value = "0", requires = "computing")]
    pub(crate) threads: usize,
}

fn transitions(text: &str) -> Result<u64, String> {
    let most = 1_000_000_000_000_000;
    let count = whole_number(text).and_then(|n| u64::try_from(n).ok());
    let count = count.filter(|count| (1..=most).contains(count));
    count.ok_or_else(|| "expected a whole number from 1 to 1e15".to_owned())
}

fn shard(text: &str) -> Result<[usize; 2], String> {
    let parts = text.split_once('/').and_then(|(i, n)| Some([i.parse().ok()?, n.parse().ok()?]));
    let parts: Option<[usize; 2]> = parts.filter(|&[i, n]: &[usize; 2]| 1 <= i && i <= n);
    parts.ok_or_else(|| {
        "expected two whole numbers, the first from 1 to the second, e.g. 2/3".to_owned()
    })
}

fn formats() -> impl TypedValueParser<Value = DataFormat> {
    let value = |format: DataFormat| PossibleValue::new(format.name()).help(format.summary());
    PossibleValuesParser::new(DataFormat::ALL.map(value))
        .try_map(|name| DataFormat::from_name(&name).ok_or("unknown format"))
}
