//! The oscillator of the laboratory and its initial state.

use libration::catalog::Allowed;
use libration::system::Oscillator;
use libration::{Hamiltonian, State};
use libration_settings::validation::check_number;
use libration_settings::{Fault, limits};
use serde::Serialize;

/// A mass on a spring.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
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

    pub(crate) fn check(self) -> Result<(), Fault> {
        check_number("oscillator.m", limits::SPRING, self.m)?;
        check_number("oscillator.k", limits::SPRING, self.k)?;
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

/// Initial state; not the origin.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Start {
    /// Position in m.
    pub q: f64,
    /// Velocity in m/s.
    pub v: f64,
}

impl Start {
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
