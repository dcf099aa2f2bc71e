//! The configuration of the laboratory.

use std::collections::BTreeMap;

use libration::Method;
use libration::ensemble::{EnsembleError, InstructionSet};
use libration_settings::{Fault, suggestions};
use serde::ser::{Error, SerializeMap};
use serde::{Serialize, Serializer};

use crate::{AllSettings, Effort, Settings, Spring, Start};

/// A configuration: shared settings, and the [`Settings`] of each study.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// Names of the studies to run; if empty, all that do not measure the machine.
    pub studies: Vec<String>,
    /// Effort of a run.
    pub effort: Effort,
    /// Instruction set of the kernels; the widest of the processor if none.
    pub simd: Option<InstructionSet>,
    /// Integrators, each once.
    pub integrators: Vec<Method>,
    /// The name of the system of equations under study, in place of oscillator and start; none without one.
    pub system: Option<String>,
    /// The simulated oscillator.
    pub oscillator: Spring,
    /// Initial state of trajectories.
    pub start: Start,
    /// The settings of each study; [`get`](Config::get) and [`with`](Config::with) read and replace them.
    pub settings: AllSettings,
}

/// The settings of the source report (§4.3, §9.1), with default settings of the studies.
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
            system: None,
            oscillator: Spring { m: 1.0, k: 10.0 },
            start: Start { q: 1.0, v: 0.0 },
            settings: AllSettings::default(),
        }
    }
}

impl Config {
    /// Returns the default configuration with an effort and an instruction set.
    pub fn new(effort: Effort, simd: Option<InstructionSet>) -> Self {
        Config { effort, simd, ..Config::default() }
    }

    /// Returns the settings of a study, or their defaults.
    pub fn get<S: Settings>(&self) -> S {
        self.settings.get()
    }

    /// Returns the configuration with other settings of a study.
    #[must_use]
    pub fn with<S: Settings>(mut self, settings: S) -> Self {
        self.settings.put(Box::new(settings));
        self
    }

    /// Checks every value against the names of all studies. Lists may have any order.
    pub(crate) fn check(&self, known: &[&str]) -> Result<(), Fault> {
        self.check_names(known)?;
        self.oscillator.check()?;
        self.start.check(self.oscillator)?;
        if let Some(requested) = self.simd.filter(|set| !set.is_available()) {
            let message = EnsembleError::Instructions { requested }.to_string();
            return Err(Fault::new("simd", message));
        }
        self.settings.check()
    }

    fn check_names(&self, known: &[&str]) -> Result<(), Fault> {
        for (i, name) in self.studies.iter().enumerate() {
            if !known.contains(&name.as_str()) {
                let fault = Fault::at("studies", i, format!("unknown study `{name}`"));
                return Err(fault.help(suggestions::suggest(
                    "studies",
                    name,
                    known.iter().copied(),
                )));
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

    /// Returns the configuration with its lists sorted.
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
        map.serialize_entry("simd", libration_settings::instruction_set_name(self.simd))?;
        let integrators: Vec<_> = self.integrators.iter().map(|method| method.name()).collect();
        map.serialize_entry("integrators", &integrators)?;
        match &self.system {
            Some(name) => {
                map.serialize_entry("system", &BTreeMap::from([("equations", name)]))?;
            }
            None => {
                map.serialize_entry("system", &self.oscillator.tables())?;
                map.serialize_entry("start", &self.start.table())?;
            }
        }
        for (name, value) in self.settings.values() {
            let mut value = value.map_err(S::Error::custom)?;
            if self.system.is_some() {
                // The systems of the catalogue that the study would have taken.
                value.as_object_mut().and_then(|table| table.remove("systems"));
            }
            map.serialize_entry(name, &value)?;
        }
        map.end()
    }
}
