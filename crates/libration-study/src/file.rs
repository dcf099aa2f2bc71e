//! What all studies share, as a TOML file.

use libration::Method;
use libration::ensemble::InstructionSet;
use libration_settings::check::named;
use libration_settings::{Fault, Number, names};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{AllSettings, Config, Effort, Spring, Start, schema};

/// The default of what all studies share, with comments.
pub(crate) const TEXT: &str = include_str!("default.toml");

/// The keys, in the order of the file.
pub(crate) const KEYS: [&str; 6] =
    ["studies", "effort", "simd", "integrators", "oscillator", "start"];

/// Configuration of `libration lab`. Units are SI.
#[derive(Deserialize, JsonSchema, Serialize)]
#[serde(default)]
#[schemars(title = "Libration configuration")]
pub(crate) struct File {
    /// The studies to run, in this order; all of them if empty.
    studies: Vec<String>,
    /// How much work a run may take.
    #[schemars(schema_with = "schema::effort")]
    effort: String,
    /// The instruction set of ensembles.
    #[schemars(schema_with = "schema::simd")]
    simd: String,
    /// The integrators under study, each once.
    #[schemars(schema_with = "schema::integrators")]
    integrators: Vec<String>,
    /// The harmonic oscillator that is simulated.
    oscillator: SpringTable,
    /// The state at time zero; `q` and `v` must not both be 0.
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

/// A state.
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
            simd: names::instruction_set(simd).into(),
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
            fault.help(names::suggest("efforts", &file.effort, Effort::ALL.map(Effort::name)))
        })?;
        let called = ("integrator", "integrators");
        let known = Method::ALL.map(Method::name);
        let integrators =
            named("integrators", called, &file.integrators, &known, Method::from_name)?;
        Ok(Config {
            studies: file.studies,
            effort,
            simd: simd(&file.simd)?,
            integrators,
            oscillator: Spring { m: file.oscillator.m.0, k: file.oscillator.k.0 },
            start: Start { q: file.start.q.0, v: file.start.v.0 },
            settings: AllSettings::default(),
        })
    }
}

fn simd(name: &str) -> Result<Option<InstructionSet>, Fault> {
    let all = || InstructionSet::ALL.map(Some).into_iter().chain([None]);
    all().find(|set| names::instruction_set(*set) == name).ok_or_else(|| {
        let fault = Fault::new("simd", format!("unknown instruction set `{name}`"));
        let known: Vec<_> = all().map(names::instruction_set).collect();
        fault.help(names::suggest("instruction sets", name, known))
    })
}
