//! One colour and one dash per integrator, in every figure.

use libration::Method;
use libration_report::figure::Ink;

/// The role in which `method` is drawn.
pub(crate) fn ink(method: Method) -> Ink {
    match method {
        Method::ExplicitEuler => Ink::ExplicitEuler,
        Method::SymplecticEuler => Ink::SymplecticEuler,
        Method::SymplecticEulerDriftFirst => Ink::Accent(1),
        Method::VelocityVerlet => Ink::VelocityVerlet,
        Method::TextbookVerlet => Ink::TextbookVerlet,
        Method::Leapfrog => Ink::Leapfrog,
        Method::Rk4 => Ink::Rk4,
        Method::Yoshida4 => Ink::Yoshida4,
        Method::Suzuki4 => Ink::Accent(2),
    }
}
