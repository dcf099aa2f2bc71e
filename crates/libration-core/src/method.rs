//! The integrators as a value, for callers that choose one at run time.

use crate::integrator::{RungeKuttaCoefficients, RungeKuttaTable, SplittingTable};

/// Every built-in integrator.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Method {
    /// [`ExplicitEuler`](crate::integrator::ExplicitEuler).
    ExplicitEuler,
    /// [`SymplecticEuler`](crate::integrator::SymplecticEuler).
    SymplecticEuler,
    /// [`SymplecticEulerDriftFirst`](crate::integrator::SymplecticEulerDriftFirst).
    SymplecticEulerDriftFirst,
    /// [`VelocityVerlet`](crate::integrator::VelocityVerlet).
    VelocityVerlet,
    /// [`TextbookVerlet`](crate::integrator::TextbookVerlet).
    TextbookVerlet,
    /// [`Leapfrog`](crate::integrator::Leapfrog).
    Leapfrog,
    /// [`Rk4`](crate::integrator::Rk4).
    Rk4,
    /// [`YOSHIDA4`](crate::integrator::YOSHIDA4).
    Yoshida4,
    /// [`SUZUKI4`](crate::integrator::SUZUKI4).
    Suzuki4,
    /// One of the [published splitting methods](SplittingTable::ALL).
    Splitting(&'static SplittingTable),
    /// One of the [published Runge–Kutta methods](RungeKuttaTable::ALL).
    RungeKutta(&'static RungeKuttaTable),
}

/// Names `$m` the integrator behind a [`Method`] and evaluates `$body` once for its type.
///
/// The choice happens here, outside every loop; inside `$body` the integrator is static.
#[macro_export]
macro_rules! with_method {
    ($method:expr, |$m:ident| $body:expr) => {{
        use $crate::{Method, integrator};
        match Method::clone(&$method) {
            Method::ExplicitEuler => {
                let $m = integrator::ExplicitEuler;
                $body
            }
            Method::SymplecticEuler => {
                let $m = integrator::SymplecticEuler;
                $body
            }
            Method::SymplecticEulerDriftFirst => {
                let $m = integrator::SymplecticEulerDriftFirst;
                $body
            }
            Method::VelocityVerlet => {
                let $m = integrator::VelocityVerlet;
                $body
            }
            Method::TextbookVerlet => {
                let $m = integrator::TextbookVerlet;
                $body
            }
            Method::Leapfrog => {
                let $m = integrator::Leapfrog;
                $body
            }
            Method::Rk4 => {
                let $m = integrator::Rk4;
                $body
            }
            Method::Yoshida4 => {
                let $m = integrator::YOSHIDA4;
                $body
            }
            Method::Suzuki4 => {
                let $m = integrator::SUZUKI4;
                $body
            }
            Method::Splitting(table) => {
                let $m = integrator::MethodTable::Splitting(table);
                $body
            }
            Method::RungeKutta(table) => {
                let $m = integrator::MethodTable::RungeKutta(table);
                $body
            }
        }
    }};
}

impl Method {
    /// Those with code of their own, by rising order; [`Method::all`] has the others, too.
    pub const ALL: [Method; 9] = [
        Method::ExplicitEuler,
        Method::SymplecticEuler,
        Method::SymplecticEulerDriftFirst,
        Method::VelocityVerlet,
        Method::TextbookVerlet,
        Method::Leapfrog,
        Method::Rk4,
        Method::Yoshida4,
        Method::Suzuki4,
    ];

    /// Name on the command line and in configurations.
    pub const fn name(self) -> &'static str {
        match self {
            Method::ExplicitEuler => "explicit-euler",
            Method::SymplecticEuler => "symplectic-euler",
            Method::SymplecticEulerDriftFirst => "symplectic-euler-drift-first",
            Method::VelocityVerlet => "velocity-verlet",
            Method::TextbookVerlet => "textbook-verlet",
            Method::Leapfrog => "leapfrog",
            Method::Rk4 => "rk4",
            Method::Yoshida4 => "yoshida4",
            Method::Suzuki4 => "suzuki4",
            Method::Splitting(table) => table.name,
            Method::RungeKutta(table) => table.name,
        }
    }

    /// Name in running text.
    pub const fn title(self) -> &'static str {
        match self {
            Method::ExplicitEuler => "explicit Euler",
            Method::SymplecticEuler => "symplectic Euler",
            Method::SymplecticEulerDriftFirst => "symplectic Euler, drift first",
            Method::VelocityVerlet => "velocity Verlet",
            Method::TextbookVerlet => "textbook Verlet",
            Method::Leapfrog => "leapfrog",
            Method::Rk4 => "RK4",
            Method::Yoshida4 => "Yoshida 4",
            Method::Suzuki4 => "Suzuki 4",
            Method::Splitting(table) => table.title,
            Method::RungeKutta(table) => table.title,
        }
    }

    /// A description in one line.
    pub const fn summary(self) -> &'static str {
        match self {
            Method::ExplicitEuler => "order 1; unstable for every undamped oscillator",
            Method::SymplecticEuler => "order 1; symplectic; kick then drift",
            Method::SymplecticEulerDriftFirst => "order 1; symplectic; drift then kick",
            Method::VelocityVerlet => "order 2; symplectic, time-reversible; kick, drift, kick",
            Method::TextbookVerlet => {
                "velocity Verlet in textbook form; its rounding is biased; differs from velocity-verlet if forces depend on velocities"
            }
            Method::Leapfrog => "order 2; symplectic, time-reversible; drift, kick, drift",
            Method::Rk4 => "order 4; classical Runge-Kutta; not symplectic",
            Method::Yoshida4 => "order 4; symplectic, time-reversible; three Verlet substeps",
            Method::Suzuki4 => "order 4; symplectic, time-reversible; five Verlet substeps",
            Method::Splitting(table) => table.summary,
            Method::RungeKutta(table) => table.summary,
        }
    }

    /// Classical order of consistency.
    pub const fn order(self) -> u32 {
        match self {
            Method::ExplicitEuler | Method::SymplecticEuler | Method::SymplecticEulerDriftFirst => {
                1
            }
            Method::VelocityVerlet | Method::TextbookVerlet | Method::Leapfrog => 2,
            Method::Rk4 | Method::Yoshida4 | Method::Suzuki4 => 4,
            Method::Splitting(table) => table.order,
            Method::RungeKutta(table) => table.order,
        }
    }

    /// The published methods whose coefficients are tables: splitting methods, then Runge–Kutta methods.
    pub fn tables() -> impl Iterator<Item = Method> {
        let splitting = SplittingTable::ALL.into_iter().flatten().map(Method::Splitting);
        splitting.chain(RungeKuttaTable::ALL.into_iter().flatten().map(Method::RungeKutta))
    }

    /// The [most efficient](SplittingTable::most_efficient) published splitting methods.
    pub fn most_efficient_tables() -> impl Iterator<Item = Method> {
        SplittingTable::most_efficient().map(Method::Splitting)
    }

    /// Whether it is a table whose order supposes that forces depend on positions alone.
    pub const fn supposes_positional_forces(self) -> bool {
        match self {
            Method::Splitting(_) => true,
            Method::RungeKutta(table) => {
                matches!(table.coefficients, RungeKuttaCoefficients::Nystrom { .. })
            }
            _ => false,
        }
    }

    /// A warning about this method on a system whose forces depend on velocities, in a sentence; none if it keeps its properties there.
    pub fn velocity_caveat(self, system: &str) -> Option<String> {
        (self == Method::TextbookVerlet).then(|| {
            format!(
                "the force of `{system}` depends on the velocity, and `{}` takes it at the end of a step with the velocity at its \
                 beginning: there it is not `{}` with other rounding, but another method with other errors and limits of stability",
                self.name(),
                Method::VelocityVerlet.name()
            )
        })
    }

    /// The order of a table where forces depend on positions alone, or anywhere: a fact about its coefficients. None for other methods, and
    /// for tables that suppose other forces.
    pub const fn certified_order(self, is_positional: bool) -> Option<u32> {
        match self {
            Method::Splitting(_) | Method::RungeKutta(_)
                if is_positional || !self.supposes_positional_forces() =>
            {
                Some(self.order())
            }
            _ => None,
        }
    }

    /// All of them: those with code of their own, then the tables.
    pub fn all() -> impl Iterator<Item = Method> {
        Method::ALL.into_iter().chain(Method::tables())
    }

    /// The method of that name, if there is one.
    pub fn from_name(name: &str) -> Option<Method> {
        Method::all().find(|method| method.name() == name)
    }
}
