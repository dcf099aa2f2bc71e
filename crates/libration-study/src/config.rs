//! The configuration: every number that studies take from outside.

use libration::Method;
use libration::ensemble::{EnsembleError, InstructionSet};
use libration_settings::{Fault, names};
use serde::ser::{Error, SerializeMap};
use serde::{Serialize, Serializer};

use crate::{AllSettings, Effort, Settings, Spring, Start};

/// A configuration: what all studies share, and the [`Settings`] of each.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// The studies to run, by name; all of them if empty.
    pub studies: Vec<String>,
    /// How much work a run may take.
    pub effort: Effort,
    /// The instruction set of ensembles; the widest that there is if none.
    pub simd: Option<InstructionSet>,
    /// The integrators under study, each once.
    pub integrators: Vec<Method>,
    /// The oscillator that is simulated.
    pub oscillator: Spring,
    /// Where trajectories start.
    pub start: Start,
    /// The settings of each study; [`get`](Config::get) and [`with`](Config::with) read and replace them.
    pub settings: AllSettings,
}

/// The setting of the source report (§4.3, §9.1), with no settings of studies but their defaults.
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
            settings: AllSettings::default(),
        }
    }
}

impl Config {
    /// The default configuration with another effort and instruction set.
    pub fn new(effort: Effort, simd: Option<InstructionSet>) -> Self {
        Config { effort, simd, ..Config::default() }
    }

    /// The settings of a study; their defaults if this configuration has none.
    pub fn get<S: Settings>(&self) -> S {
        self.settings.get()
    }

    /// The same configuration with other settings of a study.
    #[must_use]
    pub fn with<S: Settings>(mut self, settings: S) -> Self {
        self.settings.put(Box::new(settings));
        self
    }

    /// Checks every value, with the names of the studies that there are; the order of lists is free.
    pub(crate) fn check(&self, known: &[&str]) -> Result<(), Fault> {
        self.check_names(known)?;
        self.oscillator.check()?;
        self.start.check(self.oscillator)?;
        if let Some(asked) = self.simd.filter(|set| !set.is_available()) {
            let message = EnsembleError::Instructions { asked }.to_string();
            return Err(Fault::new("simd", message));
        }
        self.settings.check()
    }

    fn check_names(&self, known: &[&str]) -> Result<(), Fault> {
        for (i, name) in self.studies.iter().enumerate() {
            if !known.contains(&name.as_str()) {
                let fault = Fault::at("studies", i, format!("unknown study `{name}`"));
                return Err(fault.help(names::suggest("studies", name, known.iter().copied())));
            }
            if self.studies[..i].contains(name) {
                return Err(Fault::at("studies", i, format!("the study `{name}` is named twice")));
            }
        }
        if self.integrators.is_empty() {
            return Err(Fault::new("integrators", "`integrators` must name at least one"));
        }
        for (i, method) in self.integrators.iter().enumerate() {
            if self.integrators[..i].contains(method) {
                let message = format!("the integrator `{}` is named twice", method.name());
                return Err(Fault::at("integrators", i, message));
            }
        }
        Ok(())
    }

    /// The same configuration with its lists rising.
    pub(crate) fn sorted(mut self) -> Self {
        self.settings.sort();
        self
    }
}

impl Serialize for Config {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("studies", &self.studies)?;
        map.serialize_entry("effort", &self.effort)?;
        map.serialize_entry("simd", names::instruction_set(self.simd))?;
        let integrators: Vec<_> = self.integrators.iter().map(|method| method.name()).collect();
        map.serialize_entry("integrators", &integrators)?;
        map.serialize_entry("oscillator", &self.oscillator)?;
        map.serialize_entry("start", &self.start)?;
        for (name, value) in self.settings.values() {
            map.serialize_entry(name, &value.map_err(S::Error::custom)?)?;
        }
        map.end()
    }
}
