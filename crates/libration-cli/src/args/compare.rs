//! Arguments of `compare`.

use std::path::PathBuf;

use clap::Args;
use libration_lab::NOISE;

/// Arguments of `compare`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct CompareArgs {
    /// Output folder of an earlier `libration lab`, or its file results.json
    #[arg(value_name = "BEFORE")]
    pub(crate) before: PathBuf,
    /// Output folder of a later run, or its file
    #[arg(value_name = "AFTER")]
    pub(crate) after: PathBuf,
    /// Largest relative change of a measurement without a prediction, such as a speed, that is taken for noise
    #[arg(long, value_name = "PART", value_parser = noise, default_value_t = NOISE, allow_hyphen_values = true)]
    pub(crate) noise: f64,
    /// Print the comparison as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

const EXAMPLES: &str = "\
Examples:
  libration lab --all --out before
  libration lab --all --out after
  libration compare before after

A finding is worse if it disagrees with theory and did not before, or if it is a rate (its unit ends in /s) that
fell by more than --noise or is missing. Then the exit code is 1. It is 1 as well if no finding was compared, if a
prediction changed under the same settings, if only the second run is unfinished, and if a finding is judged and
undecided at once. An identifier that occurs twice in a file is an error (2).";

fn noise(text: &str) -> Result<f64, String> {
    let noise = super::timing::finite(text).filter(|x| (0.0..=1.0).contains(x));
    noise.ok_or_else(|| "expected a number from 0 to 1".to_owned())
}
