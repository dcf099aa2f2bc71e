//! Arguments of `gains`.

use std::path::PathBuf;
use std::time::Duration;

use clap::{ArgGroup, Args};
use libration_probe::ServoIntegrator;

use super::number::{self, Coordinates};
use super::probe::timeout;

/// Arguments of `gains`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES, group = ArgGroup::new("servos").required(true))]
pub(crate) struct GainsArgs {
    /// MuJoCo model, as XML or MJB; requires the Python packages libration and mujoco
    #[arg(long, value_name = "FILE", group = "servos")]
    pub(crate) mujoco: Option<PathBuf>,
    /// Inertia of each joint, in kg or kg·m²
    #[arg(long, value_name = "NUMBERS", group = "servos", value_parser = number::coordinates, allow_hyphen_values = true, requires_all = ["kp", "dt"])]
    pub(crate) inertia: Option<Coordinates>,
    /// File with matrices as JSON: mass, kp and optional kv, stiffness, damping, joints
    #[arg(long, value_name = "FILE", group = "servos", requires = "dt")]
    pub(crate) matrices: Option<PathBuf>,
    /// Gain of position of each joint, in N/m or N·m/rad
    #[arg(long, value_name = "NUMBERS", value_parser = number::coordinates, allow_hyphen_values = true, conflicts_with_all = ["mujoco", "matrices"])]
    pub(crate) kp: Option<Coordinates>,
    /// Gain of velocity of each joint, in N·s/m or N·m·s/rad [default: 0]
    #[arg(long, value_name = "NUMBERS", value_parser = number::coordinates, allow_hyphen_values = true, conflicts_with_all = ["mujoco", "matrices"])]
    pub(crate) kv: Option<Coordinates>,
    /// Damping of each joint besides that of its servo [default: 0]
    #[arg(long, value_name = "NUMBERS", value_parser = number::coordinates, allow_hyphen_values = true, conflicts_with_all = ["mujoco", "matrices"])]
    pub(crate) damping: Option<Coordinates>,
    /// Time step of the simulator in s [default: that of the model]
    #[arg(long, value_name = "SECONDS", value_parser = number::time_step, allow_hyphen_values = true)]
    pub(crate) dt: Option<f64>,
    /// Steps of the integrator in each time step
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub(crate) substeps: u32,
    /// The torques of servos are computed once per time step, and held over its substeps [default: anew in each substep]
    #[arg(long)]
    pub(crate) held_torque: bool,
    /// Integrator, also by a simulator's name, e.g. euler, implicitfast, rk4
    /// [default: that of the model, or symplectic-euler]
    #[arg(long, value_name = "NAME", value_parser = integrator)]
    pub(crate) integrator: Option<ServoIntegrator>,
    /// Keyframe of the MuJoCo model, by name or number [default: the default pose]
    #[arg(long, value_name = "NAME", conflicts_with_all = ["inertia", "matrices"])]
    pub(crate) keyframe: Option<String>,
    /// Start from the equilibrium of the MuJoCo model near its keyframe
    #[arg(long, conflicts_with_all = ["inertia", "matrices"])]
    pub(crate) settle: bool,
    /// Longest time for an answer of the program, in s
    #[arg(long, value_name = "SECONDS", value_parser = timeout, default_value = "10", allow_hyphen_values = true)]
    pub(crate) timeout: Duration,
    /// Python interpreter for --mujoco
    #[arg(long, value_name = "PROGRAM", default_value = "python3", conflicts_with_all = ["inertia", "matrices"])]
    pub(crate) python: String,
    /// Write an HTML page to FILE
    #[arg(long, value_name = "FILE")]
    pub(crate) page: Option<PathBuf>,
    /// Print the result as JSON, with all digits
    #[arg(long)]
    pub(crate) json: bool,
}

const EXAMPLES: &str = "\
Examples:
  libration gains --mujoco robot.xml --keyframe home --settle --page gains.html
  libration gains --inertia 0.02,0.01 --kp 400,300 --kv 2,1 --dt 0.005 --integrator implicitfast
  libration gains --matrices arm.json --dt 0.002

Exit codes: 0 the gains hold; 1 they do not, or that is unknown, or a failed run; 2 invalid input.";

fn integrator(name: &str) -> Result<ServoIntegrator, String> {
    ServoIntegrator::from_name(name).ok_or_else(|| {
        let names: Vec<&str> = ServoIntegrator::names().collect();
        format!("unknown integrator; expected one of {}", names.join(", "))
    })
}
