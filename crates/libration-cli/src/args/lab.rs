//! Arguments of `lab`.

use std::path::PathBuf;

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser};
use libration::ensemble::InstructionSet;
use libration_lab::STUDIES;
use libration_study::Effort;

use super::{efforts, equation_file, number, simd};

/// Arguments of `lab`.
#[derive(Args, Debug)]
#[command(after_help = LAB_EXAMPLES)]
pub(crate) struct LabArgs {
    /// Studies to run [default: those of the configuration, or all that do not measure this machine]
    #[arg(value_name = "STUDY", value_parser = study_names())]
    pub(crate) studies: Vec<String>,
    /// Run also the studies that measure this machine: throughput, memory, rollout and storage
    #[arg(long, conflicts_with_all = ["studies", "system"])]
    pub(crate) all: bool,
    /// Configuration file [default: the settings of the report]
    #[arg(long, value_name = "FILE")]
    pub(crate) config: Option<PathBuf>,
    /// File NAME.toml with the equations of a system: the studies that apply to it, in its names and units
    #[arg(long, value_name = "FILE", value_parser = equation_file)]
    pub(crate) system: Option<PathBuf>,
    /// Parameter of the system of --system; repeatable
    #[arg(
        long,
        value_name = "NAME=VALUE",
        value_parser = number::assignment,
        allow_hyphen_values = true,
        requires = "system"
    )]
    pub(crate) set: Vec<(String, f64)>,
    /// Output folder of the report
    #[arg(long, value_name = "DIR", default_value = "libration-report")]
    pub(crate) out: PathBuf,
    /// Effort of the run [default: that of the configuration, or standard]
    #[arg(long, value_parser = efforts())]
    pub(crate) effort: Option<Effort>,
    /// Instruction set of the kernels [default: that of the configuration, or LIBRATION_SIMD]
    #[arg(long, value_name = "SET", value_parser = simd::instruction_sets())]
    pub(crate) simd: Option<InstructionSet>,
    /// Recompute one finding by its identifier and print it, without a report
    #[arg(long, value_name = "FINDING", conflicts_with_all = ["studies", "all", "out", "open"])]
    pub(crate) only: Option<String>,
    /// Open the report in the browser
    #[arg(long)]
    pub(crate) open: bool,
    /// Print the default configuration with comments, and exit
    #[arg(long, conflicts_with_all = ["schema", "config", "system", "studies", "all", "effort", "simd", "open"])]
    pub(crate) print_config: bool,
    /// Print the JSON schema of the configuration, and exit
    #[arg(long, conflicts_with_all = ["config", "system", "studies", "all", "effort", "simd", "open"])]
    pub(crate) schema: bool,
}

const LAB_EXAMPLES: &str = "\
Examples:
  libration lab
  libration lab --all
  libration lab spectrum drift --out my-report
  libration lab --config mine.toml --effort thorough
  libration lab --system pendulum.toml --set length=0.5 --effort quick
  libration lab --only stability.velocity-verlet.window-1-to

The output folder contains report.html, results.json, figures/*.svg and data/*.parquet.
During a run the files are in the subfolder libration-unfinished. At the end they replace the files
of an earlier run. An interrupted run leaves them in that subfolder if the output folder already
contains a complete report.";

fn study_names() -> PossibleValuesParser {
    let value = |study: &&dyn libration_study::Study| {
        PossibleValue::new(study.name()).help(study.question())
    };
    PossibleValuesParser::new(STUDIES.studies.iter().map(value).collect::<Vec<_>>())
}
