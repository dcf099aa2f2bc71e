//! The settings that all studies share, as a TOML file.

use libration::Method;
use libration::ensemble::InstructionSet;
use libration_settings::validation::parse_names;
use libration_settings::{Fault, Number, suggestions};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{AllSettings, Config, Effort, Spring, Start, schema};

/// The default settings that all studies share, with comments.
pub(crate) const TEXT: &str = include_str!("default.toml");

/// The keys in the order of the file.
pub(crate) const KEYS: [&str; 6] =
    ["studies", "effort", "simd", "integrators", "oscillator", "start"];

/// Configuration of `libration lab`. Units are SI.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(default)]
#[schemars(title = "Libration configuration")]
pub(crate) struct File {
    /// Studies to run, in this order (empty: all).
    studies: Vec<String>,
    /// Effort of a run.
    #[schemars(schema_with = "schema::effort")]
    effort: String,
    /// Instruction set of the kernels, which changes no result.
    #[schemars(schema_with = "schema::simd")]
    simd: String,
    /// Integrators, each once, at least one.
    #[schemars(schema_with = "schema::integrators")]
    integrators: Vec<String>,
    /// The simulated harmonic oscillator.
    oscillator: SpringTable,
    /// Initial state; `q` and `v` must not both be 0.
    start: StartTable,
}

/// A mass on a spring, m q'' = -k q.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(default, deny_unknown_fields)]
struct SpringTable {
    /// Mass in kg.
    #[schemars(schema_with = "schema::spring")]
    m: Number,
    /// Stiffness in N/m.
    #[schemars(schema_with = "schema::spring")]
    k: Number,
}

/// Initial position and velocity.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(default, deny_unknown_fields)]
struct StartTable {
    /// Position in m.
    #[schemars(schema_with = "schema::coordinate")]
    q: Number,
    /// Velocity in m/s.
    #[schemars(schema_with = "schema::coordinate")]
    v: Number,
}

impl Default for File {
    fn default() -> Self {
        let Config { studies, effort, simd, integrators, .. } = Config::default();
        File {
            studies,
            effort: effort.name().into(),
            simd: libration_settings::instruction_set_name(simd).into(),
            integrators: integrators.into_iter().map(|method| method.name().into()).collect(),
            oscillator: SpringTable::default(),
            start: StartTable::default(),
        }
    }
}

impl Default for SpringTable {
    fn default() -> Self {
        let Spring { m, k } = Config::default().oscillator;
        SpringTable { m: Number(m), k: Number(k) }
    }
}

impl Default for StartTable {
    fn default() -> Self {
        let Start { q, v } = Config::default().start;
        StartTable { q: Number(q), v: Number(v) }
    }
}

impl TryFrom<File> for Config {
    type Error = Fault;

    fn try_from(file: File) -> Result<Self, Fault> {
        let effort = Effort::from_name(&file.effort).ok_or_else(|| {
            let fault = Fault::new("effort", format!("unknown effort `{}`", file.effort));
            fault.help(suggestions::suggest("efforts", &file.effort, Effort::ALL.map(Effort::name)))
        })?;
        let called = ("integrator", "integrators");
        let known = Method::ALL.map(Method::name);
        let integrators = parse_names("integrators", called, &file.integrators, &known, studied)?;
        Ok(Config {
            studies: file.studies,
            effort,
            simd: simd(&file.simd)?,
            integrators,
            system: None,
            oscillator: Spring { m: file.oscillator.m.0, k: file.oscillator.k.0 },
            start: Start { q: file.start.q.0, v: file.start.v.0 },
            settings: AllSettings::default(),
        })
    }
}

fn simd(name: &str) -> Result<Option<InstructionSet>, Fault> {
    let all = || InstructionSet::ALL.map(Some).into_iter().chain([None]);
    all().find(|set| libration_settings::instruction_set_name(*set) == name).ok_or_else(|| {
        let fault = Fault::new("simd", format!("unknown instruction set `{name}`"));
        let known: Vec<_> = all().map(libration_settings::instruction_set_name).collect();
        fault.help(suggestions::suggest("instruction sets", name, known))
    })
}

/// An integrator with code of its own. Exact polynomials of the longest published splitting methods outgrow their arithmetic.
fn studied(name: &str) -> Option<Method> {
    Method::from_name(name).filter(|method| Method::ALL.contains(method))
}
