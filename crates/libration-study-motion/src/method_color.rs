//! Colours of integrators in figures.

use libration::Method;
use libration_report::figure::Ink;

/// Returns the colour of `method`.
pub(crate) fn method_color(method: Method) -> Ink {
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
