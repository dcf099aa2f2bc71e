//! What is studied: every number that a study takes from outside.

mod check;
mod error;
mod file;
pub mod limits;
mod locate;
pub mod names;
mod schema;
mod settings_file;
mod tables;
mod value;

use std::path::{Path, PathBuf};

use libration::Method;
use libration::ensemble::InstructionSet;
use libration::system::Oscillator;
use serde::{Serialize, Serializer};

use crate::Effort;
use crate::bench::Implementation;

pub use check::Fault;
pub use error::ConfigError;
pub use file::{DEFAULT, parse, parse_bytes};
pub(crate) use locate::Document;
pub use schema::schema;
pub use settings_file::{read, read_text};
pub(crate) use value::{Count, Number};

/// A checked configuration. The default is the setting of the source report (§4.3, §9.1).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Config {
    /// The studies to run, by name; all of them if empty.
    pub studies: Vec<String>,
    /// How much work a run may take.
    pub effort: Effort,
    /// The instruction set of ensembles; the widest that there is if none.
    #[serde(serialize_with = "instruction_set_name")]
    pub simd: Option<InstructionSet>,
    /// The integrators under study, each once.
    #[serde(serialize_with = "method_names")]
    pub integrators: Vec<Method>,
    /// The oscillator that is simulated.
    pub oscillator: Spring,
    /// Where trajectories start.
    pub start: Start,
    /// Settings of the study `spectrum`.
    pub spectrum: Spectrum,
    /// Settings of the study `drift`.
    pub drift: Drift,
    /// Settings of the study `error`.
    pub error: Error,
    /// Settings of the study `stability`.
    pub stability: Stability,
    /// Settings of the study `efficiency`.
    pub efficiency: Efficiency,
    /// Settings of the study `convergence`.
    pub convergence: Convergence,
    /// Settings of the study `nonlinear`.
    pub nonlinear: Nonlinear,
    /// Settings of the study `precision`.
    pub precision: Precision,
    /// Settings of the study `jitter`.
    pub jitter: Jitter,
    /// Settings of the study `throughput`.
    pub throughput: Throughput,
    /// Settings of the study `rollout`.
    pub rollout: Rollout,
    /// Settings of the study `storage`.
    pub storage: Storage,
}

/// A mass on a spring.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spring {
    /// Mass in kg, positive.
    pub m: f64,
    /// Stiffness in N/m, positive.
    pub k: f64,
}

impl Spring {
    /// The system that moves as this spring does.
    pub fn system(self) -> Oscillator<f64> {
        Oscillator::from_mass_and_stiffness(self.m, self.k)
    }

    /// The natural angular frequency `ω = √(k/m)`, in rad/s.
    pub fn omega(self) -> f64 {
        self.system().omega2.sqrt()
    }
}

/// The state at time zero; not the origin.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Start {
    /// Position in m.
    pub q: f64,
    /// Velocity in m/s.
    pub v: f64,
}

/// Settings of the study `spectrum`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spectrum {
    /// The time step at which numbers are shown, in s.
    pub dt: f64,
}

/// Settings of the study `drift`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Drift {
    /// The time steps under study, in s, rising.
    pub dt: Vec<f64>,
    /// Number of steps.
    pub steps: u64,
}

/// Settings of the study `error`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Error {
    /// The time step, in s.
    pub dt: f64,
    /// Number of steps.
    pub steps: u64,
}

/// Settings of the study `stability`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Stability {
    /// Relative energy drifts that are tolerated, rising.
    pub tolerances: Vec<f64>,
    /// Numbers of steps, rising.
    pub steps: Vec<u64>,
}

/// Settings of the study `efficiency`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Efficiency {
    /// Errors that are tolerated, in energy and in state, rising.
    pub tolerances: Vec<f64>,
    /// Horizons, in periods of the oscillator, rising.
    pub periods: Vec<u64>,
}

/// Settings of the study `convergence`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Convergence {
    /// The systems under study, each once, of [`SYSTEMS`](crate::studies::SYSTEMS).
    pub systems: Vec<String>,
    /// Steps a turn at the largest time step, a multiple of 16.
    pub coarsest: u64,
}

/// Settings of the study `nonlinear`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Nonlinear {
    /// The systems under study, each once, of [`SYSTEMS`](crate::studies::SYSTEMS).
    pub systems: Vec<String>,
    /// Steps a turn over the long horizon.
    pub steps: u64,
    /// Turns of the long horizon.
    pub turns: u64,
}

/// Settings of the study `precision`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Precision {
    /// The time steps under study, in s, rising.
    pub dt: Vec<f64>,
    /// Number of steps.
    pub steps: u64,
}

/// Settings of the study `throughput`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Throughput {
    /// The implementations that are timed, each once.
    pub implementations: Vec<Implementation>,
    /// Numbers of trajectories, rising; the effort and the memory bound them.
    pub counts: Vec<u64>,
    /// What `benches/peers.py` wrote on this machine, if its ratios are to be judged.
    #[serde(serialize_with = "path")]
    pub peers: Option<PathBuf>,
}

/// Settings of the study `jitter`.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Jitter {
    /// Time stamps of a loop that ran on this host, if its clock is to be judged.
    #[serde(serialize_with = "path")]
    pub time_stamps: Option<PathBuf>,
}

/// Settings of the study `rollout`.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Rollout {
    /// What `benches/rollouts.py` wrote on this machine, if its ratios are to be judged.
    #[serde(serialize_with = "path")]
    pub peers: Option<PathBuf>,
}

/// Settings of the study `storage`.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Storage {
    /// Where it writes, in a folder of its own; the system's folder for temporary files if none.
    #[serde(serialize_with = "path")]
    pub folder: Option<PathBuf>,
    /// What `benches/storage.py` wrote on this machine, if its ratios are to be judged.
    #[serde(serialize_with = "path")]
    pub peers: Option<PathBuf>,
}

impl Default for Config {
    fn default() -> Self {
        Config {
            studies: Vec::new(),
            effort: Effort::Standard,
            simd: None,
            integrators: vec![
                Method::ExplicitEuler,
                Method::SymplecticEuler,
                Method::VelocityVerlet,
                Method::Rk4,
            ],
            oscillator: Spring { m: 1.0, k: 10.0 },
            start: Start { q: 1.0, v: 0.0 },
            spectrum: Spectrum { dt: 0.01 },
            drift: Drift { dt: vec![1e-3, 1e-2, 1e-1], steps: 1_000_000 },
            error: Error { dt: 1e-3, steps: 1_000_000 },
            stability: Stability {
                tolerances: vec![1e-3, 1e-2, 1e-1],
                steps: vec![1_000, 10_000, 100_000],
            },
            efficiency: Efficiency {
                tolerances: vec![1e-6, 1e-4, 1e-2],
                periods: vec![10, 1_000, 1_000_000],
            },
            convergence: Convergence {
                systems: ["oscillator", "pendulum", "henon-heiles", "kepler"]
                    .map(String::from)
                    .to_vec(),
                coarsest: 64,
            },
            nonlinear: Nonlinear {
                systems: ["pendulum", "henon-heiles", "kepler"].map(String::from).to_vec(),
                steps: 200,
                turns: 1000,
            },
            precision: Precision { dt: vec![1e-3, 1e-2], steps: 1_000_000 },
            jitter: Jitter::default(),
            throughput: Throughput {
                implementations: Implementation::ALL.to_vec(),
                counts: (0..=8).map(|power| 10u64.pow(power)).collect(),
                peers: None,
            },
            rollout: Rollout::default(),
            storage: Storage::default(),
        }
    }
}

impl Config {
    /// The same configuration with its lists rising.
    fn sorted(mut self) -> Self {
        self.drift.dt.sort_by(f64::total_cmp);
        self.stability.tolerances.sort_by(f64::total_cmp);
        self.stability.steps.sort_unstable();
        self.efficiency.tolerances.sort_by(f64::total_cmp);
        self.efficiency.periods.sort_unstable();
        self.precision.dt.sort_by(f64::total_cmp);
        self.throughput.counts.sort_unstable();
        self
    }
}

fn method_names<S: Serializer>(methods: &[Method], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(methods.iter().map(|m| m.name()))
}

fn path<S: Serializer>(path: &Option<PathBuf>, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(&path.as_deref().unwrap_or(Path::new("")).display())
}

fn instruction_set_name<S: Serializer>(
    set: &Option<InstructionSet>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(names::instruction_set(*set))
}
