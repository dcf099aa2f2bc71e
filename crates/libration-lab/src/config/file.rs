//! The configuration as a TOML file.

use std::path::PathBuf;

use libration::Method;
use libration::ensemble::InstructionSet;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::locate::Document;
use super::tables::{
    ConvergenceTable, DriftTable, EfficiencyTable, ErrorTable, JitterTable, NonlinearTable,
    PrecisionTable, RolloutTable, SpectrumTable, SpringTable, StabilityTable, StartTable,
    StorageTable, ThroughputTable,
};
use super::value::{Count, Number};
use super::{
    Config, ConfigError, Convergence, Drift, Efficiency, Error, Fault, Jitter, Nonlinear,
    Precision, Rollout, Spectrum, Spring, Stability, Start, Storage, Throughput, check, names,
    schema,
};
use crate::Effort;
use crate::bench::Implementation;

/// The default configuration with comments, ready to edit.
pub const DEFAULT: &str = include_str!("default.toml");

/// Configuration of `libration lab`. Units are SI.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(default, deny_unknown_fields)]
#[schemars(title = "Libration configuration")]
pub(super) struct File {
    /// The studies to run, in this order; all of them if empty.
    #[schemars(schema_with = "schema::studies")]
    pub(super) studies: Vec<String>,
    /// How much work a run may take.
    #[schemars(schema_with = "schema::effort")]
    pub(super) effort: String,
    /// The instruction set of ensembles.
    #[schemars(schema_with = "schema::simd")]
    pub(super) simd: String,
    /// The integrators under study, each once.
    #[schemars(schema_with = "schema::integrators")]
    pub(super) integrators: Vec<String>,
    /// The harmonic oscillator that is simulated.
    pub(super) oscillator: SpringTable,
    /// The state at time zero; `q` and `v` must not both be 0.
    pub(super) start: StartTable,
    /// The study of update matrices, eigenvalues and stability regions.
    pub(super) spectrum: SpectrumTable,
    /// The study of energy drift.
    pub(super) drift: DriftTable,
    /// The study of the error against the exact solution.
    pub(super) error: ErrorTable,
    /// The study of the largest stable time step.
    pub(super) stability: StabilityTable,
    /// The study of cost against stability and accuracy.
    pub(super) efficiency: EfficiencyTable,
    /// The study of orders.
    pub(super) convergence: ConvergenceTable,
    /// The study of nonlinear systems.
    pub(super) nonlinear: NonlinearTable,
    /// The study of float types.
    pub(super) precision: PrecisionTable,
    /// The study of uneven clocks.
    pub(super) jitter: JitterTable,
    /// The study of speed.
    pub(super) throughput: ThroughputTable,
    /// The study of rollouts.
    pub(super) rollout: RolloutTable,
    /// The study of what is kept.
    pub(super) storage: StorageTable,
}

/// Reads a configuration; keys that are not given take their defaults.
///
/// # Errors
/// What is wrong with `text`, and where; `file_name` is only shown.
pub fn parse(text: &str, file_name: &str) -> Result<Config, ConfigError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let document = Document::parse(text, file_name)?;
    let file: File = toml::from_str(text).map_err(|error| document.explain(&error))?;
    let config = Config::try_from(file).map_err(|fault| document.locate(fault))?;
    config.check().map_err(|fault| document.locate(fault))?;
    Ok(config.sorted())
}

/// Reads a configuration from the bytes of a file.
///
/// # Errors
/// As [`parse`], and if the bytes are not UTF-8.
pub fn parse_bytes(bytes: &[u8], file_name: &str) -> Result<Config, ConfigError> {
    let error = match std::str::from_utf8(bytes) {
        Ok(text) => return parse(text, file_name),
        Err(error) => error,
    };
    // Up to the bad byte, the shown text and the file are the same.
    let text = String::from_utf8_lossy(bytes);
    let start = error.valid_up_to();
    let skipped = if text.starts_with('\u{feff}') { '\u{feff}'.len_utf8() } else { 0 };
    let span = start - skipped..start - skipped + char::REPLACEMENT_CHARACTER.len_utf8();
    let byte = bytes.get(start).copied().unwrap_or_default();
    let message = format!("the file is not UTF-8: byte 0x{byte:02X} cannot stand here");
    let help = match bytes {
        [0xFF, 0xFE, ..] | [0xFE, 0xFF, ..] => "this looks like UTF-16; save the file as UTF-8",
        _ => "save the file as UTF-8",
    };
    Err(ConfigError::new(file_name, &text[skipped..], span, message, Some(help.into())))
}

impl Default for File {
    fn default() -> Self {
        let config = Config::default();
        let Config {
            studies, effort, simd, integrators, oscillator, start, spectrum, drift, ..
        } = config;
        let Config {
            error,
            stability,
            efficiency,
            convergence,
            nonlinear,
            precision,
            jitter,
            throughput,
            rollout,
            storage,
            ..
        } = config;
        let numbers = |list: Vec<f64>| list.into_iter().map(Number).collect();
        let counts = |list: Vec<u64>| list.into_iter().map(|n| Count(n.into())).collect();
        File {
            studies,
            effort: effort.name().into(),
            simd: names::instruction_set(simd).into(),
            integrators: integrators.into_iter().map(|m| m.name().into()).collect(),
            oscillator: SpringTable { m: Number(oscillator.m), k: Number(oscillator.k) },
            start: StartTable { q: Number(start.q), v: Number(start.v) },
            spectrum: SpectrumTable { dt: Number(spectrum.dt) },
            drift: DriftTable {
                dt: drift.dt.into_iter().map(Number).collect(),
                steps: Count(drift.steps.into()),
            },
            error: ErrorTable { dt: Number(error.dt), steps: Count(error.steps.into()) },
            stability: StabilityTable {
                tolerances: numbers(stability.tolerances),
                steps: counts(stability.steps),
            },
            efficiency: EfficiencyTable {
                tolerances: numbers(efficiency.tolerances),
                periods: counts(efficiency.periods),
            },
            convergence: ConvergenceTable {
                systems: convergence.systems,
                coarsest: Count(convergence.coarsest.into()),
            },
            nonlinear: NonlinearTable {
                systems: nonlinear.systems,
                steps: Count(nonlinear.steps.into()),
                turns: Count(nonlinear.turns.into()),
            },
            precision: PrecisionTable {
                dt: numbers(precision.dt),
                steps: Count(precision.steps.into()),
            },
            jitter: JitterTable { time_stamps: path_of(jitter.time_stamps) },
            throughput: ThroughputTable {
                implementations: names_of(&throughput.implementations),
                counts: counts(throughput.counts),
                peers: path_of(throughput.peers),
            },
            rollout: RolloutTable { peers: path_of(rollout.peers) },
            storage: StorageTable {
                folder: path_of(storage.folder),
                peers: path_of(storage.peers),
            },
        }
    }
}

impl TryFrom<File> for Config {
    type Error = Fault;

    fn try_from(file: File) -> Result<Self, Fault> {
        let File {
            studies,
            effort,
            simd: set,
            integrators,
            oscillator,
            start,
            spectrum,
            drift,
            ..
        } = file;
        let File {
            error,
            stability,
            efficiency,
            convergence,
            nonlinear,
            precision,
            jitter,
            throughput,
            rollout,
            storage,
            ..
        } = file;
        let effort = Effort::from_name(&effort).ok_or_else(|| {
            let fault = Fault::new("effort", format!("unknown effort `{effort}`"));
            fault.help(names::suggest("efforts", &effort, Effort::ALL.map(Effort::name)))
        })?;
        let method = |(i, name): (usize, &String)| {
            Method::from_name(name).ok_or_else(|| {
                let fault = Fault::at("integrators", i, format!("unknown integrator `{name}`"));
                fault.help(names::suggest("integrators", name, Method::ALL.map(Method::name)))
            })
        };
        let steps = check::steps("drift.steps", drift.steps.0)?;
        let numbers = |list: Vec<Number>| list.into_iter().map(|Number(x)| x).collect();
        let counts = |key, list: Vec<Count>| -> Result<Vec<u64>, Fault> {
            list.into_iter().enumerate().map(|(i, n)| check::count(key, i, n.0)).collect()
        };
        let coarsest = check::coarsest("convergence.coarsest", convergence.coarsest.0)?;
        let steps_a_turn = check::steps_a_turn("nonlinear.steps", nonlinear.steps.0)?;
        let turns = check::turns("nonlinear.turns", nonlinear.turns.0)?;
        Ok(Config {
            studies,
            effort,
            simd: simd(&set)?,
            integrators: integrators.iter().enumerate().map(method).collect::<Result<_, _>>()?,
            oscillator: Spring { m: oscillator.m.0, k: oscillator.k.0 },
            start: Start { q: start.q.0, v: start.v.0 },
            spectrum: Spectrum { dt: spectrum.dt.0 },
            drift: Drift { dt: numbers(drift.dt), steps },
            error: Error { dt: error.dt.0, steps: check::steps("error.steps", error.steps.0)? },
            stability: Stability {
                tolerances: numbers(stability.tolerances),
                steps: counts("stability.steps", stability.steps)?,
            },
            efficiency: Efficiency {
                tolerances: numbers(efficiency.tolerances),
                periods: counts("efficiency.periods", efficiency.periods)?,
            },
            convergence: Convergence { systems: convergence.systems, coarsest },
            nonlinear: Nonlinear { systems: nonlinear.systems, steps: steps_a_turn, turns },
            precision: Precision {
                dt: numbers(precision.dt),
                steps: check::steps("precision.steps", precision.steps.0)?,
            },
            jitter: Jitter { time_stamps: path(jitter.time_stamps) },
            throughput: Throughput {
                implementations: implementations(&throughput.implementations)?,
                counts: counts("throughput.counts", throughput.counts)?,
                peers: path(throughput.peers),
            },
            rollout: Rollout { peers: path(rollout.peers) },
            storage: Storage { folder: path(storage.folder), peers: path(storage.peers) },
        })
    }
}

/// A path as it stands in a file; empty if there is none.
fn path_of(path: Option<PathBuf>) -> String {
    path.map_or_else(String::new, |path| path.display().to_string())
}

fn path(text: String) -> Option<PathBuf> {
    Some(text).filter(|text| !text.is_empty()).map(PathBuf::from)
}

fn names_of(implementations: &[Implementation]) -> Vec<String> {
    implementations.iter().map(|one| one.name().into()).collect()
}

fn implementations(names: &[String]) -> Result<Vec<Implementation>, Fault> {
    let key = "throughput.implementations";
    let one = |(i, name): (usize, &String)| {
        Implementation::from_name(name).ok_or_else(|| {
            let fault = Fault::at(key, i, format!("unknown implementation `{name}`"));
            let known = Implementation::ALL.map(Implementation::name);
            fault.help(names::suggest("implementations", name, known))
        })
    };
    names.iter().enumerate().map(one).collect()
}

fn simd(name: &str) -> Result<Option<InstructionSet>, Fault> {
    let all = || InstructionSet::ALL.map(Some).into_iter().chain([None]);
    all().find(|set| names::instruction_set(*set) == name).ok_or_else(|| {
        let fault = Fault::new("simd", format!("unknown instruction set `{name}`"));
        let known: Vec<_> = all().map(names::instruction_set).collect();
        fault.help(names::suggest("instruction sets", name, known))
    })
}
