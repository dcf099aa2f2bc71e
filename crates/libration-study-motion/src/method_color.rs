//! Colours of integrators in figures.

use libration::Method;
use libration_report::figure::Role;

/// Returns the colour of `method`.
pub(crate) fn method_color(method: Method) -> Role {
    match method {
        Method::ExplicitEuler => Role::ExplicitEuler,
        Method::SymplecticEuler => Role::SymplecticEuler,
        Method::SymplecticEulerDriftFirst => Role::Accent(1),
        Method::VelocityVerlet => Role::VelocityVerlet,
        Method::TextbookVerlet => Role::TextbookVerlet,
        Method::Leapfrog => Role::Leapfrog,
        Method::Rk4 => Role::Rk4,
        Method::Yoshida4 => Role::Yoshida4,
        Method::Suzuki4 => Role::Accent(2),
        Method::Splitting(_) | Method::RungeKutta(_) => Role::Accent(3),
    }
}
