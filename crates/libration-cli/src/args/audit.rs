//! Arguments of `audit`.

use std::path::PathBuf;

use clap::Args;

use super::{TimeUnitName, number};

/// Arguments of `audit`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct AuditArgs {
    /// Files with energies of runs of the same system, one for each time step: CSV, Parquet or NumPy
    #[arg(value_name = "FILE", required = true)]
    pub(crate) files: Vec<PathBuf>,
    /// Column of the energy
    #[arg(long, value_name = "COLUMN")]
    pub(crate) energy: String,
    /// Column of the time [default: t, time or a similar name; else the first column]
    #[arg(long, value_name = "COLUMN")]
    pub(crate) time: Option<String>,
    /// Unit of the column of time, which is converted to s [default: of the file or the name, else by the size of the numbers]
    #[arg(long, value_name = "UNIT")]
    pub(crate) time_unit: Option<TimeUnitName>,
    /// Time step of each file in s [default: a column `dt`; else the spacing of the samples]
    #[arg(long, value_name = "SECONDS", value_delimiter = ',', value_parser = number::time_step, allow_hyphen_values = true)]
    pub(crate) dt: Vec<f64>,
    /// Largest deviation from the energy at the start, relative to it or to --scale: judges each run [default: none; the largest step is that for 1e-4]
    #[arg(long, value_name = "NUMBER", value_parser = positive, allow_hyphen_values = true)]
    pub(crate) tolerance: Option<f64>,
    /// Energy that the tolerance is relative to, in the unit of the file, such as the mean kinetic energy [default: the energy at the start]
    #[arg(long, value_name = "NUMBER", value_parser = positive, allow_hyphen_values = true)]
    pub(crate) scale: Option<f64>,
    /// Duration for which the tolerance holds, in s, also as 10min [default: that of the runs]
    #[arg(long, value_name = "SECONDS", value_parser = positive_time, allow_hyphen_values = true)]
    pub(crate) horizon: Option<f64>,
    /// Write an HTML page to FILE
    #[arg(long, value_name = "FILE")]
    pub(crate) page: Option<PathBuf>,
    /// Print the result as JSON, with all digits
    #[arg(long)]
    pub(crate) json: bool,
}

const EXAMPLES: &str = "\
Examples:
  libration audit h1.csv h2.csv h4.csv --energy E
  libration audit a.csv b.csv --energy total --time t --dt 0.002,0.001 --tolerance 1e-4 --horizon 1000
  libration audit a.parquet b.parquet --energy E --page audit.html

Times are in s; of files with another unit, numbers without a unit in --dt and --horizon have that of the files.

Exit codes: 0 no fault, and all runs within a stated tolerance; 1 a fault, an exceeded tolerance, an unknown verdict, or a failed run;
2 invalid input.";

fn positive_time(text: &str) -> Result<f64, String> {
    let time = number::time(text)?;
    if time > 0.0 { Ok(time) } else { Err("expected a duration above 0".to_owned()) }
}

fn positive(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(x) if x > 0.0 && x.is_finite() => Ok(x),
        _ => Err("expected a number above 0".to_owned()),
    }
}
