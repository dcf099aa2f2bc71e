//! What makes a configuration a sound one.

use std::fmt;
use std::ops::RangeInclusive;
use std::path::Path;

use libration::catalog::Allowed;
use libration::ensemble::EnsembleError;
use libration::{Hamiltonian, State};

use super::limits::{self, within};
use super::{Config, Spring, Start, Throughput, names};
use crate::bench::{Peer, PeerRow, Peers, RolloutPeer, StoragePeer};
use crate::{studies, wakeups};

/// A value of a configuration that is not allowed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// Where it stands, as in `drift.dt`.
    pub key: &'static str,
    /// Which element of the array, counted from zero.
    pub index: Option<usize>,
    /// What is wrong, and what is allowed.
    pub message: String,
    /// What could be done about it.
    pub help: Option<String>,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)?;
        self.help.iter().try_for_each(|help| write!(f, "; {help}"))
    }
}

impl std::error::Error for Fault {}

impl Fault {
    pub(crate) fn new(key: &'static str, message: impl Into<String>) -> Self {
        Fault { key, index: None, message: message.into(), help: None }
    }

    pub(crate) fn at(key: &'static str, index: usize, message: impl Into<String>) -> Self {
        Fault { key, index: Some(index), message: message.into(), help: None }
    }

    pub(crate) fn help(mut self, help: String) -> Self {
        self.help = Some(help);
        self
    }
}

impl Config {
    /// Checks every value; the order of time steps is free.
    ///
    /// # Errors
    /// The first value that is not allowed.
    pub fn check(&self) -> Result<(), Fault> {
        self.check_names()?;
        self.oscillator.check()?;
        self.start.check(self.oscillator)?;
        number("spectrum.dt", limits::TIME_STEP, self.spectrum.dt)?;
        list("drift.dt", "time step", limits::TIME_STEP, &self.drift.dt)?;
        steps("drift.steps", self.drift.steps.into())?;
        number("error.dt", limits::TIME_STEP, self.error.dt)?;
        steps("error.steps", self.error.steps.into())?;
        list("stability.tolerances", "tolerance", limits::TOLERANCE, &self.stability.tolerances)?;
        counts("stability.steps", &self.stability.steps)?;
        list("efficiency.tolerances", "tolerance", limits::TOLERANCE, &self.efficiency.tolerances)?;
        counts("efficiency.periods", &self.efficiency.periods)?;
        check_systems("convergence.systems", &self.convergence.systems)?;
        coarsest("convergence.coarsest", self.convergence.coarsest.into())?;
        check_systems("nonlinear.systems", &self.nonlinear.systems)?;
        steps_a_turn("nonlinear.steps", self.nonlinear.steps.into())?;
        turns("nonlinear.turns", self.nonlinear.turns.into())?;
        list("precision.dt", "time step", limits::TIME_STEP, &self.precision.dt)?;
        steps("precision.steps", self.precision.steps.into())?;
        if let Some(asked) = self.simd.filter(|set| !set.is_available()) {
            let message = EnsembleError::Instructions { asked }.to_string();
            return Err(Fault::new("simd", message));
        }
        self.throughput.check()?;
        time_stamps("jitter.time_stamps", self.jitter.time_stamps.as_deref())?;
        peers::<RolloutPeer>("rollout.peers", self.rollout.peers.as_deref())?;
        folder("storage.folder", self.storage.folder.as_deref())?;
        peers::<StoragePeer>("storage.peers", self.storage.peers.as_deref())
    }

    fn check_names(&self) -> Result<(), Fault> {
        let known = || studies::ALL.iter().map(|study| study.name());
        for (i, name) in self.studies.iter().enumerate() {
            if !known().any(|study| study == name) {
                let fault = Fault::at("studies", i, format!("unknown study `{name}`"));
                let known: Vec<_> = known().collect();
                return Err(fault.help(names::suggest("studies", name, known)));
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
}

impl Spring {
    fn check(self) -> Result<(), Fault> {
        number("oscillator.m", limits::SPRING, self.m)?;
        number("oscillator.k", limits::SPRING, self.k)?;
        let omega2 = self.system().omega2;
        if Allowed::Positive.admits(omega2) {
            return Ok(());
        }
        let (m, k) = (self.m, self.k);
        Err(Fault::new(
            "oscillator.k",
            format!(
                "omega2 = k/m = {k:?}/{m:?} is {omega2:?}, but it must be {}",
                Allowed::Positive
            ),
        ))
    }
}

impl Start {
    fn check(self, spring: Spring) -> Result<(), Fault> {
        number("start.q", limits::COORDINATE, self.q)?;
        number("start.v", limits::COORDINATE, self.v)?;
        if self.q == 0.0 && self.v == 0.0 {
            let rest = "`start.q` and `start.v` are both 0, where nothing moves; one must not be 0";
            return Err(Fault::new("start.q", rest));
        }
        let energy = spring.system().energy(&State { q: [self.q], v: [self.v] });
        if energy.is_normal() {
            return Ok(());
        }
        let (q, v) = (self.q, self.v);
        let message = format!(
            "the energy at `start.q` = {q:?}, `start.v` = {v:?} is {energy:?} J/kg, but it must be \
             finite and large enough for all digits of an f64"
        );
        Err(Fault::new("start.q", message))
    }
}

impl Throughput {
    fn check(&self) -> Result<(), Fault> {
        let key = "throughput.implementations";
        if self.implementations.is_empty() {
            return Err(Fault::new(key, format!("`{key}` must name at least one")));
        }
        for (i, one) in self.implementations.iter().enumerate() {
            if self.implementations[..i].contains(one) {
                let message = format!("the implementation `{}` is named twice", one.name());
                return Err(Fault::at(key, i, message));
            }
        }
        counts("throughput.counts", &self.counts)?;
        peers::<Peer>("throughput.peers", self.peers.as_deref())
    }
}

/// A file of peers is read before any work.
fn peers<R: PeerRow>(key: &'static str, path: Option<&Path>) -> Result<(), Fault> {
    match path.map(Peers::<R>::read) {
        Some(Err(message)) => Err(Fault::new(key, message)),
        _ => Ok(()),
    }
}

/// A file of time stamps is there, and is the record of a clock.
fn time_stamps(key: &'static str, path: Option<&Path>) -> Result<(), Fault> {
    let Some(path) = path else { return Ok(()) };
    let wrong = |why| Fault::new(key, format!("cannot use `{}`: {why}", path.display()));
    wakeups::time_stamps(path).map(|_| ()).map_err(wrong)
}

/// A folder is there before any work.
fn folder(key: &'static str, path: Option<&Path>) -> Result<(), Fault> {
    match path.filter(|path| !path.is_dir()) {
        Some(path) => {
            let message = format!("`{key}` is `{}`, but it must be a folder", path.display());
            Err(Fault::new(key, message))
        }
        None => Ok(()),
    }
}

fn check_systems(key: &'static str, systems: &[String]) -> Result<(), Fault> {
    if systems.is_empty() {
        return Err(Fault::new(key, format!("`{key}` must name at least one system")));
    }
    for (i, name) in systems.iter().enumerate() {
        if !studies::SYSTEMS.contains(&name.as_str()) {
            let fault = Fault::at(key, i, format!("no system `{name}` can be studied"));
            return Err(fault.help(names::suggest("systems", name, studies::SYSTEMS)));
        }
        if systems[..i].contains(name) {
            return Err(Fault::at(key, i, format!("the system `{name}` is named twice")));
        }
    }
    Ok(())
}

fn number(key: &'static str, allowed: Allowed, value: f64) -> Result<(), Fault> {
    within(allowed, key, value).map(drop).map_err(|message| Fault::new(key, message))
}

pub(super) fn steps(key: &'static str, value: i128) -> Result<u64, Fault> {
    limits::steps(key, value).map_err(|message| Fault::new(key, message))
}

/// Numbers of which there must be one at least, and each once.
fn list(key: &'static str, what: &str, allowed: Allowed, values: &[f64]) -> Result<(), Fault> {
    if values.is_empty() {
        return Err(Fault::new(key, format!("`{key}` must hold at least one {what}")));
    }
    for (i, &value) in values.iter().enumerate() {
        let fault = |message| Fault::at(key, i, message);
        within(allowed, key, value).map_err(fault)?;
        if values[..i].contains(&value) {
            return Err(fault(format!("the {what} {value:?} stands in `{key}` twice")));
        }
    }
    Ok(())
}

/// Horizons, of which there must be one at least, and each once.
fn counts(key: &'static str, values: &[u64]) -> Result<(), Fault> {
    if values.is_empty() {
        return Err(Fault::new(key, format!("`{key}` must hold at least one number")));
    }
    for (i, &value) in values.iter().enumerate() {
        count(key, i, value.into())?;
        if values[..i].contains(&value) {
            return Err(Fault::at(key, i, format!("{value} stands in `{key}` twice")));
        }
    }
    Ok(())
}

/// The `i`-th number of a list of horizons.
pub(super) fn count(key: &'static str, i: usize, value: i128) -> Result<u64, Fault> {
    limits::steps(key, value).map_err(|message| Fault::at(key, i, message))
}

pub(super) fn coarsest(key: &'static str, value: i128) -> Result<u64, Fault> {
    let multiple = limits::COARSEST_UNIT;
    match u64::try_from(value) {
        Ok(steps) if limits::COARSEST.contains(&steps) && steps.is_multiple_of(multiple) => {
            Ok(steps)
        }
        _ => {
            let (low, high) = (limits::COARSEST.start(), limits::COARSEST.end());
            let allowed = format!("a multiple of {multiple} from {low} to {high}");
            Err(Fault::new(key, format!("`{key}` is {value}, but it must be {allowed}")))
        }
    }
}

pub(super) fn steps_a_turn(key: &'static str, value: i128) -> Result<u64, Fault> {
    count_in(key, limits::STEPS_A_TURN, value)
}

pub(super) fn turns(key: &'static str, value: i128) -> Result<u64, Fault> {
    count_in(key, limits::TURNS, value)
}

fn count_in(key: &'static str, allowed: RangeInclusive<u64>, value: i128) -> Result<u64, Fault> {
    let (low, high) = (allowed.start(), allowed.end());
    u64::try_from(value).ok().filter(|count| allowed.contains(count)).ok_or_else(|| {
        Fault::new(key, format!("`{key}` is {value}, but it must be {low} to {high}"))
    })
}
