//! The systems as a value, for callers that choose one at run time.

mod actuation;
mod entries;
mod entry;
mod error;

use crate::system::{
    DampedOscillator, DrivenOscillator, Duffing, HenonHeiles, Kepler, Oscillator, Pendulum,
};
use crate::{Method, Model};

pub use actuation::Actuation;
pub use entry::{Allowed, Entry, Parameter};
pub use error::CatalogError;

/// Every built-in system, in the order in which they are listed to a reader.
pub const ENTRIES: [&Entry; 7] = [
    &entries::OSCILLATOR,
    &entries::DAMPED_OSCILLATOR,
    &entries::DRIVEN_OSCILLATOR,
    &entries::PENDULUM,
    &entries::DUFFING,
    &entries::KEPLER,
    &entries::HENON_HEILES,
];

/// One of the built-in systems with its parameters.
///
/// [`with_system!`](crate::with_system) turns it back into the concrete [`Model`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AnySystem {
    /// [`Oscillator`], in 1 to 8 dimensions.
    Oscillator(Oscillator<f64>),
    /// [`DampedOscillator`].
    DampedOscillator(DampedOscillator<f64>),
    /// [`DrivenOscillator`].
    DrivenOscillator(DrivenOscillator<f64>),
    /// [`Pendulum`].
    Pendulum(Pendulum<f64>),
    /// [`Duffing`].
    Duffing(Duffing<f64>),
    /// [`Kepler`].
    Kepler(Kepler<f64>),
    /// [`HenonHeiles`].
    HenonHeiles(HenonHeiles<f64>),
}

/// Names `$model` the [`Model`] behind an [`AnySystem`] and `$d` its dimension, and evaluates
/// `$body` for that type; a system that does not exist in that dimension yields `$mismatch`.
///
/// The choice happens here, outside every loop; inside `$body` the system is static and `$d` is
/// a constant. An oscillator is a `Model<D>` for every `D`, so a generic function that `$body`
/// calls is told which: by a `State<_, D>` among its arguments, or as `f::<D>(model)`.
///
/// ```
/// use libration::{AnySystem, CatalogError, Model, with_system};
///
/// fn coordinates<const D: usize>(_: impl Model<D>) -> usize {
///     2 * D
/// }
///
/// # fn main() -> Result<(), CatalogError> {
/// let system = AnySystem::build("oscillator", &[("k", 4.0)])?;
/// let run = |dimension: usize| {
///     with_system!(system, dimension, |model, D| Ok(coordinates::<D>(model)), {
///         Err(system.entry().wrong_dimension(dimension))
///     })
/// };
/// assert_eq!(run(3)?, 6);
/// assert!(run(9).is_err());
/// # Ok(())
/// # }
/// ```
#[macro_export]
macro_rules! with_system {
    (@match $system:expr, $dimension:expr, $model:ident, $d:ident, $body:expr, $mismatch:expr;
     $($variant:ident($n:literal))*) => {
        match ($system, $dimension) {
            $(($crate::AnySystem::$variant($model), $n) => {
                #[allow(dead_code)]
                const $d: usize = $n;
                $body
            })*
            _ => $mismatch,
        }
    };
    ($system:expr, $dimension:expr, |$model:ident, $d:ident| $body:expr, $mismatch:expr $(,)?) => {
        $crate::with_system!(@match $system, $dimension, $model, $d, $body, $mismatch;
            Oscillator(1) Oscillator(2) Oscillator(3) Oscillator(4)
            Oscillator(5) Oscillator(6) Oscillator(7) Oscillator(8)
            DampedOscillator(1) DrivenOscillator(2)
            Pendulum(1) Duffing(1) Kepler(2) HenonHeiles(2))
    };
}

/// The entry of that name.
///
/// # Errors
///
/// [`CatalogError::UnknownSystem`].
pub fn find(name: &str) -> Result<&'static Entry, CatalogError> {
    ENTRIES
        .into_iter()
        .find(|entry| entry.name == name)
        .ok_or_else(|| CatalogError::UnknownSystem { name: name.to_owned() })
}

/// The system of that name, and the quantity of its commands; parameters that are not given take their
/// defaults.
///
/// # Errors
///
/// A [`CatalogError`] if the system or a parameter is unknown, if a parameter is given twice or its value
/// is not allowed, if `omega2` is given together with `m` or `k`, or `m` without `k`.
pub fn build(
    name: &str,
    parameters: &[(impl AsRef<str>, f64)],
) -> Result<(AnySystem, Actuation), CatalogError> {
    let entry = find(name)?;
    let values = entry.resolve(parameters)?;
    Ok(((entry.build)(&values)?, entries::actuation(&values)))
}

impl AnySystem {
    /// The system of that name, whatever its commands are: [`build`] without the [`Actuation`].
    ///
    /// # Errors
    ///
    /// As for [`build`].
    pub fn build(
        name: &str,
        parameters: &[(impl AsRef<str>, f64)],
    ) -> Result<AnySystem, CatalogError> {
        build(name, parameters).map(|(system, _)| system)
    }

    /// The entry of this system in the catalogue.
    pub const fn entry(self) -> &'static Entry {
        match self {
            AnySystem::Oscillator(_) => &entries::OSCILLATOR,
            AnySystem::DampedOscillator(_) => &entries::DAMPED_OSCILLATOR,
            AnySystem::DrivenOscillator(_) => &entries::DRIVEN_OSCILLATOR,
            AnySystem::Pendulum(_) => &entries::PENDULUM,
            AnySystem::Duffing(_) => &entries::DUFFING,
            AnySystem::Kepler(_) => &entries::KEPLER,
            AnySystem::HenonHeiles(_) => &entries::HENON_HEILES,
        }
    }

    /// Name on the command line and in configurations.
    pub const fn name(self) -> &'static str {
        self.entry().name
    }

    /// The values that determine the system, by the names that [`AnySystem::build`] takes.
    ///
    /// A mass and a stiffness appear as the `omega2` that they made.
    pub fn parameters(self) -> Vec<(&'static str, f64)> {
        match self {
            AnySystem::Oscillator(s) => vec![("omega2", s.omega2)],
            AnySystem::DampedOscillator(s) => vec![("omega2", s.omega2), ("gamma", s.gamma)],
            AnySystem::DrivenOscillator(s) => vec![
                ("omega2", s.omega2),
                ("gamma", s.gamma),
                ("amplitude", s.amplitude),
                ("drive", s.drive),
            ],
            AnySystem::Pendulum(s) => vec![("omega2", s.omega2)],
            AnySystem::Duffing(s) => vec![("alpha", s.alpha), ("beta", s.beta)],
            AnySystem::Kepler(s) => vec![("mu", s.mu)],
            AnySystem::HenonHeiles(s) => vec![("lambda", s.lambda)],
        }
    }

    /// Whether the force depends on the velocity.
    pub fn is_damped(self) -> bool {
        match self {
            AnySystem::DampedOscillator(s) => s.gamma != 0.0,
            AnySystem::DrivenOscillator(s) => s.gamma != 0.0,
            AnySystem::Oscillator(_)
            | AnySystem::Pendulum(_)
            | AnySystem::Duffing(_)
            | AnySystem::Kepler(_)
            | AnySystem::HenonHeiles(_) => false,
        }
    }

    /// A warning about `method` on this system, in a sentence; none if the method keeps its properties.
    pub fn caveat(self, method: Method) -> Option<String> {
        self.is_damped().then(|| method.velocity_caveat(self.name())).flatten()
    }

    /// Whether the acceleration is linear in `(q, v)`: [`Model::LINEAR`].
    pub fn is_linear(self) -> bool {
        fn linear<const D: usize, M: Model<D>>(_: M) -> bool {
            M::LINEAR
        }
        let dimension = *self.entry().dimensions.start();
        with_system!(self, dimension, |model, D| linear::<D, _>(model), false)
    }

    /// Whether the exact solution conserves the energy with these parameters.
    pub fn conserves_energy(self) -> bool {
        match self {
            AnySystem::DrivenOscillator(s) => s.amplitude == 0.0 && !self.is_damped(),
            _ => !self.is_damped(),
        }
    }
}
