//! Systems of the catalogue by their equations.

use libration::catalog::Actuation;
use libration::equations::{Definitions, EquationError, Equations};
use libration::integrator::Exact;
use libration::{AnySystem, CatalogError, Method};
use thiserror::Error;

use super::{EquationSystem, Twin, named_states};
use crate::units;

/// Error of the start of a system of the catalogue.
#[derive(Debug, Error)]
pub enum StartError {
    /// The system does not exist in this dimension.
    #[error(transparent)]
    Dimension(#[from] CatalogError),
    /// The rate of a time coordinate is not 1.
    #[error(
        "--v ends in {rate}, but the second coordinate of {system} is time, so its rate must be 1"
    )]
    Rate {
        /// The velocity of that coordinate.
        rate: f64,
        /// The system.
        system: &'static str,
    },
    /// The equations are wrong, which those of the catalogue are not.
    #[error(transparent)]
    Equations(#[from] EquationError),
}

impl EquationSystem {
    /// A system of the catalogue, from positions and velocities of equal number; the catalogue supplies missing ones, which repeat in
    /// further dimensions.
    ///
    /// # Errors
    /// [`StartError`].
    pub fn of_catalogue(
        (system, actuation): (AnySystem, Actuation),
        q: Option<&[f64]>,
        v: Option<&[f64]>,
    ) -> Result<Self, StartError> {
        let entry = system.entry();
        let dimension = q.or(v).map_or(*entry.dimensions.start(), <[f64]>::len);
        if !entry.dimensions.contains(&dimension) {
            return Err(entry.wrong_dimension(dimension).into());
        }
        let start = |given: Option<&[f64]>, known: &[f64]| -> Vec<f64> {
            let repeated = || known.iter().copied().cycle().take(dimension).collect();
            given.map_or_else(repeated, <[f64]>::to_vec)
        };
        let (q, v) = (start(q, entry.q), start(v, entry.v));
        if let (AnySystem::DrivenOscillator(_), &[_, rate]) = (system, v.as_slice())
            && rate != 1.0
        {
            return Err(StartError::Rate { rate, system: entry.name });
        }
        let definitions = Definitions::of_catalogue_in(system, actuation, q.len());
        let equations = Equations::new(&definitions)?;
        let own = units::of(system, actuation);
        let states = named_states(&equations, (&q, &v), &|_| own.position.to_owned(), own.time);
        let unit = |name: &str| {
            let known = entry.parameters.iter().find(|parameter| parameter.name == name);
            known.map_or("", |parameter| parameter.unit).to_owned()
        };
        Ok(EquationSystem {
            name: system.name().to_owned(),
            description: entry.summary.to_owned(),
            states,
            units: definitions.parameters.iter().map(|(name, _)| unit(name)).collect(),
            input_units: Vec::new(),
            energy_unit: own.energy.to_owned(),
            time_unit: own.time.to_owned(),
            equations,
            definitions,
            q,
            v,
            task: None,
            twin: Some(Twin { system, actuation }),
        })
    }

    /// Why steps of an integrator lose their order on this system; none if they do not.
    pub fn caveat(&self, method: Method) -> Option<String> {
        let depends_on_velocity = match self.twin {
            Some(Twin { system, .. }) => system.is_damped(),
            None => !self.equations.dynamics().is_positional(),
        };
        if !depends_on_velocity {
            return None;
        }
        let of_tables = method.supposes_positional_forces().then(|| {
            format!(
                "a force of `{}` depends on a velocity, which `{}` does not suppose: its errors are those of order 1; `rk4` keeps its order",
                self.name,
                method.name()
            )
        });
        of_tables.or_else(|| method.velocity_caveat(&self.name))
    }

    /// Whether all accelerations are linear in positions and velocities.
    pub fn is_linear(&self) -> bool {
        self.equations.polynomial_degree().is_some_and(|degree| degree <= 1)
    }

    /// The largest absolute eigenvalue of a linear system, in 1/s, by which it has [exact](Exact::of_angle) steps; none of others.
    pub fn fastest_rate(&self) -> Option<f64> {
        if !self.is_linear() {
            return None;
        }
        let dynamics = self.equations.dynamics();
        let degrees = dynamics.degrees();
        let mut accelerations = dynamics.accelerations().on::<f64>();
        let constant: Vec<f64> = accelerations.run(&[]).collect();
        Some(Exact::fastest(2 * degrees, |state| {
            let rates = accelerations.run(state).zip(&constant).map(|(a, constant)| a - constant);
            state[degrees..].iter().copied().chain(rates).collect()
        }))
    }
}
