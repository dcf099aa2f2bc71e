//! The settings that all studies share, as a TOML file.

use libration::Method;
use libration::ensemble::InstructionSet;
use libration_settings::validation::parse_names;
use libration_settings::{Fault, StartTable, SystemTables, suggestions};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{AllSettings, Config, Effort, Spring, Start, schema};

/// The default settings that all studies share, with comments.
pub(crate) const TEXT: &str = include_str!("default.toml");

/// The keys in the order of the file.
pub(crate) const KEYS: [&str; 6] = ["studies", "effort", "simd", "integrators", "system", "start"];

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
    #[schemars(schema_with = "schema::system")]
    system: SystemTables,
    /// Initial state; `q` and `v` must not both be 0.
    #[schemars(schema_with = "schema::start")]
    start: StartTable,
}

impl Default for File {
    fn default() -> Self {
        let Config { studies, effort, simd, integrators, oscillator, start, .. } =
            Config::default();
        File {
            studies,
            effort: effort.name().into(),
            simd: libration_settings::instruction_set_name(simd).into(),
            integrators: integrators.into_iter().map(|method| method.name().into()).collect(),
            system: oscillator.tables(),
            start: start.table(),
        }
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
            oscillator: Spring::from_tables(&file.system)?,
            start: Start::from_table(file.start)?,
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
