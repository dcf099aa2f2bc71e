//! Arguments of `bodies`.

use std::path::PathBuf;

use clap::Args;
use libration::Method;
use libration::bodies::BodyIntegrator;
use libration_analyze::trajectory::Format;
use libration_settings::suggestions;

use super::number::{count, seed, time_step_of_system, trajectory_steps};
use super::simulate::{every, formats};

/// Arguments of `bodies`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(crate) struct BodiesArgs {
    /// Name of initial conditions (figure-eight, pythagorean, outer-solar-system, kozai, plummer, frozen-argon), or a file NAME.toml or NAME.csv
    #[arg(value_name = "SYSTEM")]
    pub(crate) system: String,
    /// Integrator: any explicit one of `libration list`, or wisdom-holman for orbits around a heavy first body, as wisdom-holman:TABLE with errors of
    /// higher order for light others (saba-2 to saba-6, sbab-2 to sbab-6, aba-10-4, aba-8-6-4, aba-10-6-4, abah-8-4-4, abah-8-6-4, abah-10-6-4)
    #[arg(long, value_name = "NAME", value_parser = integrator)]
    pub(crate) integrator: BodyIntegrator,
    /// Time step, in the units of the system
    #[arg(long, value_name = "TIME", value_parser = time_step_of_system, allow_hyphen_values = true)]
    pub(crate) dt: f64,
    /// Number of steps
    #[arg(long, value_name = "N", value_parser = trajectory_steps, allow_hyphen_values = true)]
    pub(crate) steps: u64,
    /// Take a sample every N steps [default: at most 1000 samples; of 64 bodies and more, at most a tenth of the time]
    #[arg(long = "save-every", value_name = "N", value_parser = every, allow_hyphen_values = true)]
    pub(crate) every: Option<u64>,
    /// Number of bodies of plummer
    #[arg(long, value_name = "N", value_parser = count, allow_hyphen_values = true)]
    pub(crate) count: Option<usize>,
    /// Seed of plummer [default: 0]
    #[arg(long, value_name = "N", value_parser = seed, allow_hyphen_values = true)]
    pub(crate) seed: Option<u64>,
    /// Softening length of the potential -G m/sqrt(r^2 + L^2) [default: that of the file, or 0]
    #[arg(long, value_name = "L", allow_hyphen_values = true)]
    pub(crate) softening: Option<f64>,
    /// Constant of gravitation [default: that of the file or of the initial conditions, or 1; 0 with a pair potential]
    #[arg(long, value_name = "G", allow_hyphen_values = true)]
    pub(crate) gravitational_constant: Option<f64>,
    /// Potential energy of two bodies, in place of that of the file: an expression of their distance r, masses m1, m2 and charges q1, q2
    #[arg(long, value_name = "EXPRESSION", allow_hyphen_values = true)]
    pub(crate) pair_potential: Option<String>,
    /// Keep what the sums of positions and velocities round off
    #[arg(long)]
    pub(crate) compensated: bool,
    /// Let the length of the steps follow the encounters, reversibly: --dt is the first; requires a symmetric splitting method
    #[arg(long)]
    pub(crate) adaptive: bool,
    /// Skip the second run with twice the time step, which predicts changes by the order
    #[arg(long)]
    pub(crate) no_prediction: bool,
    /// Number of threads (0: one per core)
    #[arg(long, value_name = "N", default_value = "0")]
    pub(crate) threads: usize,
    /// Print the audit as JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Format of the rows [default: by the extension of --output]
    #[arg(long, value_parser = formats(), requires = "output")]
    pub(crate) format: Option<Format>,
    /// Write a row for each body of each sample to FILE
    #[arg(long, short, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
}

const EXAMPLES: &str = r#"Examples:
  libration bodies figure-eight --integrator yoshida4 --dt 0.01 --steps 1e4
  libration bodies outer-solar-system --integrator wisdom-holman --dt 100 --steps 3.65e5
  libration bodies pythagorean --integrator kahan-li-6-9a --adaptive --dt 0.02 --steps 2e4
  libration bodies plummer --count 1024 --softening 0.01 --integrator leapfrog --dt 0.001 --steps 1e3
  libration bodies frozen-argon --integrator leapfrog --dt 4e-5 --steps 5e3
  libration bodies ions.csv --pair-potential "q1*q2/r + 1/r^9" --integrator leapfrog --dt 0.001 --steps 1e4
  libration bodies mine.csv --integrator blanes-moan-srkn-11-6 --dt 0.01 --steps 1e4 --output orbits.parquet

The audit compares the largest changes of energy, momentum and angular momentum with two predictions: by
the order of the integrator, from a second run with twice the time step, and by rounding.
The rows have the columns body, step, t, x, y, z, vx, vy, vz.
A file NAME.csv has the columns name (optional), mass, x, y, z, vx, vy, vz, radius and charge
(optional). Bodies with radii end the motion where they collide. With a pair potential, gravity acts only if
its constant is given.
The bits of a motion do not depend on --threads."#;

/// Parses the name of an integrator.
fn integrator(name: &str) -> Result<BodyIntegrator, String> {
    BodyIntegrator::from_name(name).ok_or_else(|| {
        let methods = Method::all().map(|method| method.name().to_owned());
        let known: Vec<String> =
            methods.chain(BodyIntegrator::wisdom_holman().map(BodyIntegrator::name)).collect();
        let few = Method::ALL.map(Method::name).join(", ");
        let near = suggestions::nearest(name, known.iter().map(String::as_str));
        let near = near.map_or_else(String::new, |near| format!("did you mean `{near}`? "));
        format!(
            "{near}expected one of wisdom-holman, wisdom-holman:abah-10-6-4, {few}, or a published method of `libration list`"
        )
    })
}
