//! The oscillator of the laboratory and its initial state.

use libration::catalog::Allowed;
use libration::system::Oscillator;
use libration::{AnySystem, Hamiltonian, State};
use libration_settings::validation::check_number;
use libration_settings::{Coordinates, Fault, StartTable, SystemTables, limits};

use crate::Config;

/// How to study other systems, in messages.
const OTHER_SYSTEMS: &str = "`libration lab --system FILE` studies a system by its equations; `libration list --examples` has examples";

/// A mass on a spring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spring {
    /// Mass in kg, positive.
    pub m: f64,
    /// Stiffness in N/m, positive.
    pub k: f64,
}

impl Spring {
    /// Returns the equivalent oscillator.
    pub fn system(self) -> Oscillator<f64> {
        Oscillator::from_mass_and_stiffness(self.m, self.k)
    }

    /// Returns the natural angular frequency `ω = √(k/m)` in rad/s.
    pub fn omega(self) -> f64 {
        self.system().omega2.sqrt()
    }

    /// Returns the tables of a file with this oscillator.
    pub(crate) fn tables(self) -> SystemTables {
        SystemTables::of("oscillator", &[("m", self.m), ("k", self.k)])
    }

    /// Returns the oscillator of a file: `omega2` is that of a mass of 1 kg.
    ///
    /// # Errors
    /// If there is another system or several, or for a value that is not allowed.
    pub(crate) fn from_tables(tables: &SystemTables) -> Result<Self, Fault> {
        let (system, _) = tables.build(OTHER_SYSTEMS)?;
        let AnySystem::Oscillator(Oscillator { omega2 }) = system else {
            let name = system.name();
            let message = format!("[system.{name}] is given; expected [system.oscillator]");
            let fault = Fault::new(format!("system.{name}"), message);
            return Err(fault.help(OTHER_SYSTEMS.to_owned()));
        };
        let given = |name: &str| Some(tables.catalogued.get("oscillator")?.get(name)?.0);
        if given("omega2").is_some() {
            check_number("system.oscillator.omega2", limits::SPRING, omega2)?;
        }
        Ok(Spring { m: given("m").unwrap_or(1.0), k: given("k").unwrap_or(omega2) })
    }

    pub(crate) fn check(self) -> Result<(), Fault> {
        check_number("system.oscillator.m", limits::SPRING, self.m)?;
        check_number("system.oscillator.k", limits::SPRING, self.k)?;
        let omega2 = self.system().omega2;
        if Allowed::Positive.admits(omega2) {
            return Ok(());
        }
        let (m, k) = (self.m, self.k);
        Err(Fault::new(
            "system.oscillator.k",
            format!(
                "omega2 = k/m = {k:?}/{m:?} is {omega2:?}, but it must be {}",
                Allowed::Positive
            ),
        ))
    }
}

/// Initial state; not the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// Position in m.
    pub q: f64,
    /// Velocity in m/s.
    pub v: f64,
}

impl Start {
    /// Returns the table of a file with this start.
    pub(crate) fn table(self) -> StartTable {
        let coordinate = |x: f64| Some(Coordinates::new(&[x]));
        StartTable { q: coordinate(self.q), v: coordinate(self.v) }
    }

    /// Returns the start of a file; a missing key has its default.
    ///
    /// # Errors
    /// If there are several coordinates.
    pub(crate) fn from_table(table: StartTable) -> Result<Self, Fault> {
        let Start { q, v } = Config::default().start;
        let one = |key: &'static str, given: Option<Coordinates>, default: f64| {
            let Some(given) = given else { return Ok(default) };
            match given.list()[..] {
                [one] => Ok(one),
                ref all => {
                    let count = all.len();
                    let message = format!("`{key}` has {count} numbers; expected one");
                    Err(Fault::new(key, message))
                }
            }
        };
        Ok(Start { q: one("start.q", table.q, q)?, v: one("start.v", table.v, v)? })
    }

    pub(crate) fn check(self, spring: Spring) -> Result<(), Fault> {
        check_number("start.q", limits::COORDINATE, self.q)?;
        check_number("start.v", limits::COORDINATE, self.v)?;
        if self.q == 0.0 && self.v == 0.0 {
            let rest = "`start.q` and `start.v` are both 0; expected at least one that is not 0";
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
