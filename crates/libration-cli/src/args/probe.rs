//! Arguments of `probe`.

use std::path::PathBuf;
use std::time::Duration;

use clap::{ArgGroup, Args};
use libration_settings::duration;

use super::number::{self, Coordinates};

/// Arguments of `probe`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES, group = ArgGroup::new("simulator").required(true))]
pub(crate) struct ProbeArgs {
    /// Program that answers each line `x1 … xn u1 … um dt` with a line `x1 … xn`, the states dt seconds later
    #[arg(long, value_name = "PROGRAM", group = "simulator", value_parser = words)]
    pub(crate) command: Option<Words>,
    /// MuJoCo model, as XML or MJB; requires the Python packages libration and mujoco
    #[arg(long, value_name = "FILE", group = "simulator")]
    pub(crate) mujoco: Option<PathBuf>,
    /// File of a sampled plant x' = Ax + Bu: .npz, .toml, .json, .csv or .mat, as for `advise --plant`
    #[arg(long, value_name = "FILE", group = "simulator")]
    pub(crate) matrices: Option<PathBuf>,
    /// State at which the step is linearised [default: that of the model; 0 for --matrices]
    #[arg(long, value_name = "NUMBERS", value_parser = number::coordinates, allow_hyphen_values = true, conflicts_with = "mujoco")]
    pub(crate) state: Option<Coordinates>,
    /// Constant action there [default: none; 0 for --matrices]
    #[arg(long, value_name = "NUMBERS", value_parser = number::coordinates, allow_hyphen_values = true, conflicts_with = "mujoco")]
    pub(crate) action: Option<Coordinates>,
    /// Time step in s [default: that of the model]
    #[arg(long, value_name = "SECONDS", value_parser = number::time_step, allow_hyphen_values = true, conflicts_with = "matrices")]
    pub(crate) dt: Option<f64>,
    /// Names of the states of --command, with units, e.g. "angle (rad),speed (rad/s)" [default: x1, x2, …]
    #[arg(long, value_name = "NAMES", value_delimiter = ',', conflicts_with_all = ["mujoco", "matrices"])]
    pub(crate) state_names: Vec<String>,
    /// Names of the actions of --command [default: u1, u2, …]
    #[arg(long, value_name = "NAMES", value_delimiter = ',', conflicts_with_all = ["mujoco", "matrices"])]
    pub(crate) action_names: Vec<String>,
    /// Typical deviations of the states; of --mujoco also one number for all [default: the larger of 1 and the absolute state]
    #[arg(long, value_name = "NUMBERS", value_parser = number::coordinates, conflicts_with_all = ["matrices"])]
    pub(crate) state_scale: Option<Coordinates>,
    /// Typical deviations of the actions of --command [default: the larger of 1 and the absolute action]
    #[arg(long, value_name = "NUMBERS", value_parser = number::coordinates, conflicts_with_all = ["mujoco", "matrices"])]
    pub(crate) action_scale: Option<Coordinates>,
    /// Keyframe of the MuJoCo model, by name or number [default: the default pose]
    #[arg(long, value_name = "NAME", conflicts_with_all = ["command", "matrices"])]
    pub(crate) keyframe: Option<String>,
    /// Start from the equilibrium of the MuJoCo model near its keyframe, or else from that into which it settles
    #[arg(long, conflicts_with_all = ["command", "matrices"])]
    pub(crate) settle: bool,
    /// The simulator has this time step only
    #[arg(long, conflicts_with_all = ["mujoco", "matrices"])]
    pub(crate) fixed_dt: bool,
    /// The system conserves energy: a drift that does not depend on the time step is a fault
    #[arg(long, conflicts_with = "matrices")]
    pub(crate) conservative: bool,
    /// The state is on a motion and no equilibrium
    #[arg(long, conflicts_with = "matrices")]
    pub(crate) moving: bool,
    /// Longest time for an answer of the program, in s
    #[arg(long, value_name = "SECONDS", value_parser = timeout, default_value = "10", allow_hyphen_values = true)]
    pub(crate) timeout: Duration,
    /// Longest time for the whole audit, in s
    #[arg(long, value_name = "SECONDS", value_parser = time_limit, default_value = "600", allow_hyphen_values = true)]
    pub(crate) time_limit: Duration,
    /// Python interpreter for --mujoco
    #[arg(long, value_name = "PROGRAM", default_value = "python3", conflicts_with_all = ["command", "matrices"])]
    pub(crate) python: String,
    /// Write an HTML page to FILE
    #[arg(long, value_name = "FILE")]
    pub(crate) page: Option<PathBuf>,
    /// Write the step as a plant in continuous time to FILE.toml, for `advise --plant` and `analyze --plant`
    #[arg(long, value_name = "FILE")]
    pub(crate) save_plant: Option<PathBuf>,
    /// Leave neutral positions out of the plant of --save-plant, such as where a free base stands
    #[arg(long, requires = "save_plant")]
    pub(crate) without_neutral: bool,
    /// Print the result as JSON, with all digits
    #[arg(long)]
    pub(crate) json: bool,
}

const EXAMPLES: &str = "\
Examples:
  libration probe --command ./my_step --state 0,1 --dt 0.01
  libration probe --command 'python3 step.py' --state 0,0 --action 0 --dt 0.01 --page probe.html
  libration probe --mujoco arm.xml --keyframe home --page probe.html
  libration probe --matrices ab.npz

A program reads a line for each step and writes a line at once, until its input ends; in Python:
  for line in sys.stdin:
      q, v, dt = map(float, line.split())
      v -= dt * 9.81 * math.sin(q)
      print(q + dt * v, v, flush=True)

Exit codes: 0 no fault; 1 a fault, a verdict that is unknown, or a failed simulator; 2 invalid input.";

/// The words of a command.
#[derive(Clone, Debug)]
pub(crate) struct Words(pub(crate) Vec<String>);

fn words(text: &str) -> Result<Words, String> {
    match shlex::split(text) {
        Some(words) if !words.is_empty() => Ok(Words(words)),
        Some(_) => Err("expected a program and its arguments".into()),
        None => Err("a quotation mark is not closed".into()),
    }
}

pub(super) fn timeout(text: &str) -> Result<Duration, String> {
    seconds(text, 3600.0)
}

fn time_limit(text: &str) -> Result<Duration, String> {
    seconds(text, 1e6)
}

fn seconds(text: &str, most: f64) -> Result<Duration, String> {
    let seconds = duration::seconds(text).filter(|&x| x > 0.0 && x <= most);
    let seconds = seconds.map(Duration::from_secs_f64);
    seconds.ok_or_else(|| {
        format!("expected a number of seconds above 0, at most {most}, also as 10min")
    })
}
