//! Systems of equations.

use super::definitions::ENERGY;
use super::program::ValueId;
use super::program_builder::ProgramBuilder;
use super::resolver::Resolver;
use super::{Definitions, Dynamics, EquationError};

/// A system `q̈ = a(q, v, u)` by its equations.
///
/// A state of first order is the velocity of a coordinate that nothing depends on, and its rate the acceleration. Time, where an
/// equation needs it, is the last coordinate, with velocity 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Equations {
    degrees: Vec<Degree>,
    inputs: Vec<String>,
    dynamics: Dynamics,
}

/// A degree of freedom.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Degree {
    /// A coordinate with an acceleration.
    Coordinate(String),
    /// A state of first order.
    State(String),
    /// Time.
    Time,
}

impl Equations {
    /// The system of these definitions.
    ///
    /// # Errors
    /// [`EquationError`]: the first definition that is wrong.
    pub fn new(definitions: &Definitions) -> Result<Self, EquationError> {
        let Definitions { coordinates, rates, parts, parameters, varied, inputs, .. } = definitions;
        definitions.check()?;
        let expressions = definitions.parse()?;
        let is_time = |(name, primes): (&str, usize)| name == "t" && primes == 0;
        let needs_time = expressions.iter().any(|own| own.expression.names().any(is_time));
        let mut degrees: Vec<Degree> =
            coordinates.iter().cloned().map(Degree::Coordinate).collect();
        degrees.extend(rates.iter().map(|(name, _)| Degree::State(name.clone())));
        if needs_time {
            degrees.push(Degree::Time);
        }
        let mut builder = ProgramBuilder::default();
        let (positions, velocities) =
            (builder.inputs(degrees.len()), builder.inputs(degrees.len()));
        let (commands, drawn) = (builder.inputs(inputs.len()), builder.inputs(varied.len()));
        let time = degrees.iter().position(|degree| *degree == Degree::Time).map(|i| positions[i]);
        let mut resolver = Resolver::new(builder);
        define_parameters(&mut resolver, parameters);
        define_states(&mut resolver, &degrees, (&positions, &velocities), str::to_owned);
        define_values(&mut resolver, inputs, &commands);
        define_values(&mut resolver, varied, &drawn);
        if let Some(time) = time {
            resolver.define("t", 0, time);
        }
        for own in expressions {
            resolver.define_expression(own);
        }
        let mut outputs = Vec::with_capacity(degrees.len());
        for degree in &degrees {
            outputs.push(match degree {
                Degree::Coordinate(name) => {
                    resolver.resolve(name, 2, (&format!("acceleration.{name}"), None))?
                }
                Degree::State(name) => {
                    resolver.resolve(name, 1, (&format!("rate.{name}"), None))?
                }
                Degree::Time => resolver.builder.constant(0.0),
            });
        }
        // A part that nothing needs must be right, too.
        for (name, _) in parts {
            resolver.resolve(name, 0, (&format!("let.{name}"), None))?;
        }
        let energy = definitions.energy.as_ref();
        let energy = energy.map(|_| resolver.resolve(ENERGY, 0, ("energy", None))).transpose()?;
        let builder = resolver.builder;
        let energy = energy.map(|energy| builder.clone().finish(&[energy]));
        let accelerations = builder.finish(&outputs);
        let dynamics =
            Dynamics::new(degrees.len(), inputs.len() + varied.len(), accelerations, energy);
        Ok(Equations { degrees, inputs: inputs.clone(), dynamics })
    }

    /// The degrees of freedom, in the order of the state.
    pub fn degrees(&self) -> &[Degree] {
        &self.degrees
    }

    /// The names of the inputs, of which the [dynamics](Equations::dynamics) have one more for each parameter that varies.
    pub fn inputs(&self) -> &[String] {
        &self.inputs
    }

    /// The accelerations and the energy.
    pub fn dynamics(&self) -> &Dynamics {
        &self.dynamics
    }

    /// The largest degree of the accelerations as polynomials of positions and velocities; none if one is no polynomial.
    pub fn polynomial_degree(&self) -> Option<u32> {
        let states = 2 * self.degrees.len();
        let degrees = self.dynamics.accelerations().polynomial_degrees(|input| input < states);
        degrees.into_iter().try_fold(0, |most, degree| Some(most.max(degree?)))
    }
}

/// Gives parameters, and π, their values.
pub(crate) fn define_parameters(resolver: &mut Resolver, parameters: &[(String, f64)]) {
    let pi = resolver.builder.constant(core::f64::consts::PI);
    resolver.define("pi", 0, pi);
    for (name, value) in parameters {
        let value = resolver.builder.constant(*value);
        resolver.define(name, 0, value);
    }
}

/// Gives coordinates, velocities and states of first order their values, by names that follow from their own.
pub(crate) fn define_states(
    resolver: &mut Resolver,
    degrees: &[Degree],
    (positions, velocities): (&[ValueId], &[ValueId]),
    name_of: impl Fn(&str) -> String,
) {
    for ((degree, &position), &velocity) in degrees.iter().zip(positions).zip(velocities) {
        match degree {
            Degree::Coordinate(name) => {
                resolver.define(&name_of(name), 0, position);
                resolver.define(&name_of(name), 1, velocity);
            }
            Degree::State(name) => resolver.define(&name_of(name), 0, velocity),
            Degree::Time => {}
        }
    }
}

/// Gives names their values.
pub(crate) fn define_values(resolver: &mut Resolver, names: &[String], values: &[ValueId]) {
    for (name, &value) in names.iter().zip(values) {
        resolver.define(name, 0, value);
    }
}
