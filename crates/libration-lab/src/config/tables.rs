//! The tables of a configuration file, one for each study and what they share.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::file::File;
use super::schema;
use super::value::{Count, Number};

/// A mass on a spring, m q'' = -k q.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct SpringTable {
    /// Mass in kg.
    #[schemars(schema_with = "schema::spring")]
    pub(super) m: Number,
    /// Stiffness in N/m.
    #[schemars(schema_with = "schema::spring")]
    pub(super) k: Number,
}

/// A state.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct StartTable {
    /// Position in m.
    #[schemars(schema_with = "schema::coordinate")]
    pub(super) q: Number,
    /// Velocity in m/s.
    #[schemars(schema_with = "schema::coordinate")]
    pub(super) v: Number,
}

/// Settings of the study `spectrum`.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct SpectrumTable {
    /// Time step in s at which numbers are shown.
    #[schemars(schema_with = "schema::time_step")]
    pub(super) dt: Number,
}

/// Settings of the study `drift`.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct DriftTable {
    /// Time steps in s, each once.
    #[schemars(schema_with = "schema::time_steps")]
    pub(super) dt: Vec<Number>,
    /// Number of steps at each of them.
    #[schemars(schema_with = "schema::steps")]
    pub(super) steps: Count,
}

/// Settings of the study `error`.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct ErrorTable {
    /// Time step in s.
    #[schemars(schema_with = "schema::time_step")]
    pub(super) dt: Number,
    /// Number of steps.
    #[schemars(schema_with = "schema::steps")]
    pub(super) steps: Count,
}

/// Settings of the study `stability`.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct StabilityTable {
    /// Relative energy drifts that are tolerated, each once.
    #[schemars(schema_with = "schema::tolerances")]
    pub(super) tolerances: Vec<Number>,
    /// Numbers of steps, each once.
    #[schemars(schema_with = "schema::horizons")]
    pub(super) steps: Vec<Count>,
}

/// Settings of the study `efficiency`.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct EfficiencyTable {
    /// Errors that are tolerated, in energy and in state, each once.
    #[schemars(schema_with = "schema::tolerances")]
    pub(super) tolerances: Vec<Number>,
    /// Horizons in periods of the oscillator, each once.
    #[schemars(schema_with = "schema::horizons")]
    pub(super) periods: Vec<Count>,
}

/// Settings of the study `convergence`.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct ConvergenceTable {
    /// The systems under study, each once.
    #[schemars(schema_with = "schema::systems")]
    pub(super) systems: Vec<String>,
    /// Steps a turn at the largest time step, a multiple of 16.
    #[schemars(schema_with = "schema::coarsest")]
    pub(super) coarsest: Count,
}

/// Settings of the study `nonlinear`.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct NonlinearTable {
    /// The systems under study, each once.
    #[schemars(schema_with = "schema::systems")]
    pub(super) systems: Vec<String>,
    /// Steps a turn over the long horizon.
    #[schemars(schema_with = "schema::steps_a_turn")]
    pub(super) steps: Count,
    /// Turns of the long horizon.
    #[schemars(schema_with = "schema::turns")]
    pub(super) turns: Count,
}

/// Settings of the study `precision`.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct PrecisionTable {
    /// Time steps in s, each once.
    #[schemars(schema_with = "schema::time_steps")]
    pub(super) dt: Vec<Number>,
    /// Number of steps.
    #[schemars(schema_with = "schema::steps")]
    pub(super) steps: Count,
}

/// Settings of the study `jitter`.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct JitterTable {
    /// A file of time stamps, as `libration measure-jitter --output` writes it; none if empty.
    pub(super) time_stamps: String,
}

/// Settings of the study `throughput`.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct ThroughputTable {
    /// The implementations that are timed, each once.
    #[schemars(schema_with = "schema::implementations")]
    pub(super) implementations: Vec<String>,
    /// Numbers of trajectories, each once; the effort and the memory bound them.
    #[schemars(schema_with = "schema::horizons")]
    pub(super) counts: Vec<Count>,
    /// A file that `benches/peers.py` wrote on this machine; none if empty.
    pub(super) peers: String,
}

/// Settings of the study `rollout`.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct RolloutTable {
    /// A file that `benches/rollouts.py` wrote on this machine; none if empty.
    pub(super) peers: String,
}

/// Settings of the study `storage`.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct StorageTable {
    /// The folder in which a folder of its own is written to; that of the system for temporary files if empty.
    pub(super) folder: String,
    /// A file that `benches/storage.py` wrote on this machine; none if empty.
    pub(super) peers: String,
}

macro_rules! default_of_table {
    ($($table:ident = $key:ident),*) => {
        $(impl Default for $table {
            fn default() -> Self {
                File::default().$key
            }
        })*
    };
}

default_of_table!(
    SpringTable = oscillator,
    StartTable = start,
    SpectrumTable = spectrum,
    DriftTable = drift,
    ErrorTable = error,
    StabilityTable = stability,
    EfficiencyTable = efficiency,
    ConvergenceTable = convergence,
    NonlinearTable = nonlinear,
    PrecisionTable = precision,
    JitterTable = jitter,
    ThroughputTable = throughput,
    RolloutTable = rollout,
    StorageTable = storage
);
