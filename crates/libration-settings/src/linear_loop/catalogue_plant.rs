//! Systems of the catalogue, linearised at an equilibrium.

use std::collections::BTreeMap;

use libration::linear::{LinearPlant, Matrix, Signal, solve_matrix};
use libration::number::Dual;
use libration::{Model, State, System, catalog, with_system};
use serde::{Deserialize, Serialize};

use crate::{Fault, Number, suggestions, units};

const MOST_ITERATIONS: usize = 100;
const TOLERANCE: f64 = 1e-8;

/// One number, or one for each coordinate.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(untagged, expecting = "expected a number, or a list with one number for each coordinate")]
pub enum Coordinates {
    /// Of a system with one degree of freedom.
    One(Number),
    /// One for each degree of freedom.
    Each(Vec<Number>),
}

impl Coordinates {
    fn numbers(&self, key: &'static str) -> Result<Vec<f64>, Fault> {
        let numbers: Vec<f64> = match self {
            Coordinates::One(Number(x)) => vec![*x],
            Coordinates::Each(each) => each.iter().map(|x| x.0).collect(),
        };
        match numbers.iter().find(|x| !x.is_finite()) {
            Some(x) => Err(Fault::new(key, format!("{x:?} is given; expected finite numbers"))),
            None => Ok(numbers),
        }
    }
}

/// The equilibrium at which a system is linearised.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OperatingPoint {
    /// The name of the system in the catalogue.
    pub system: &'static str,
    /// The coordinates; all velocities are zero.
    pub q: Vec<f64>,
    /// The unit of the coordinates.
    pub unit: &'static str,
    /// The constant commands.
    pub command: Vec<f64>,
    /// The unit of the commands.
    pub command_unit: &'static str,
    /// The largest absolute acceleration that is left, in units of coordinates per squared unit of time.
    pub residual: f64,
}

impl OperatingPoint {
    /// The operating point in a sentence.
    pub fn sentence(&self) -> String {
        let list = |numbers: &[f64]| {
            numbers.iter().map(|&x| seven_digits(x)).collect::<Vec<_>>().join(", ")
        };
        format!(
            "The plant is the system {} linearised at q = {} {} under the constant command {} {}, where an acceleration of {:.1e} is left.",
            self.system,
            list(&self.q),
            self.unit,
            list(&self.command),
            self.command_unit,
            self.residual
        )
    }
}

/// A number with seven digits, and an exponent if it is small or large.
fn seven_digits(x: f64) -> String {
    let rounded: f64 = format!("{x:.6e}").parse().unwrap_or(x);
    format!("{rounded:?}")
}

/// The plant of a system of the catalogue, and the equilibrium at which Newton's method ends that begins `at`.
///
/// # Errors
/// [`Fault`]: an unknown system or parameter, a system that depends on time, or no equilibrium.
pub(super) fn linearise(
    name: &str,
    parameters: &BTreeMap<String, Number>,
    at: Option<&Coordinates>,
    command: Option<&Coordinates>,
) -> Result<(LinearPlant, OperatingPoint), Fault> {
    let parameters: Vec<(&str, f64)> = parameters.iter().map(|(k, v)| (&**k, v.0)).collect();
    let (system, actuation) = catalog::build(name, &parameters).map_err(|error| {
        let unknown = matches!(error, catalog::CatalogError::UnknownSystem { .. });
        let key = if unknown { "system.linear.of" } else { "system.linear.parameters" };
        Fault::new(key, format!("{error}{}", suggestions::catalog_help(&error)))
    })?;
    let entry = system.entry();
    if matches!(system, libration::AnySystem::DrivenOscillator(_)) {
        let message = format!("`{name}` depends on time, so it has no equilibrium");
        return Err(Fault::new("system.linear.of", message));
    }
    let least = *entry.dimensions.start();
    let start = match at {
        Some(at) => at.numbers("system.linear.at")?,
        None => vec![0.0; least],
    };
    let dimension = start.len();
    let forces = match command {
        Some(command) => command.numbers("system.linear.command")?,
        None => vec![0.0; dimension],
    };
    if forces.len() != dimension {
        let message = format!("`command` has {} numbers; expected {dimension}", forces.len());
        return Err(Fault::new("system.linear.command", message));
    }
    let mass = actuation.mass();
    let held: Vec<f64> = forces.iter().map(|force| force / mass).collect();
    let found =
        with_system!(system, dimension, |model, D| equilibrium::<D>(model, &start, &held), {
            return Err(Fault::new(
                "system.linear.at",
                entry.wrong_dimension(dimension).to_string(),
            ));
        });
    let Equilibrium { q, residual, jacobian } = found.map_err(|left| {
        let message = format!(
            "no equilibrium of `{name}` found: at q = {:?} an acceleration of {:.3e} is left",
            left.q, left.residual
        );
        Fault::new("system.linear.at", message)
            .help("begin `at` coordinates nearer to one, or change `command`".to_owned())
    })?;
    let n = 2 * dimension;
    let (mut a, mut b) = (Matrix::zeros(n, n), Matrix::zeros(n, dimension));
    for i in 0..dimension {
        a[(i, dimension + i)] = 1.0;
        b[(dimension + i, i)] = 1.0 / mass;
    }
    a.set_block((dimension, 0), &jacobian);
    let units = units::of(system, actuation);
    let signals = |letter: &str, unit| {
        (0..dimension).map(move |i| Signal::new(&format!("{letter}{i}"), unit)).collect::<Vec<_>>()
    };
    let mut states = signals("q", units.position);
    states.extend(signals("v", units.velocity));
    let inputs = match dimension {
        1 => vec![Signal::new(actuation.name(), units.command)],
        _ => signals(actuation.name(), units.command),
    };
    let plant = LinearPlant::new(a, b, Matrix::identity(n), Matrix::zeros(n, dimension))
        .and_then(|plant| plant.named(states.clone(), inputs, states))
        .map_err(|error| Fault::new("system.linear.of", error.to_string()))?;
    let point = OperatingPoint {
        system: entry.name,
        q,
        unit: units.position,
        command: forces,
        command_unit: units.command,
        residual,
    };
    Ok((plant, point))
}

/// A state at rest, the largest acceleration there, and the derivatives of accelerations by coordinates and velocities.
struct Equilibrium {
    q: Vec<f64>,
    residual: f64,
    jacobian: Matrix,
}

/// The equilibrium under accelerations that are `held`, by Newton's method with exact derivatives; steps are halved until they improve.
///
/// # Errors
/// The last state, if no shift of its coordinates by 10⁻⁸ of the larger of 1 and their values causes the acceleration that is left.
fn equilibrium<const D: usize>(
    model: impl Model<D>,
    start: &[f64],
    held: &[f64],
) -> Result<Equilibrium, Equilibrium> {
    let left = |q: &[f64]| -> Vec<f64> {
        let state = State { q: core::array::from_fn(|i| q[i]), v: [0.0; D] };
        let acceleration = model.on::<f64>().acceleration(&state);
        acceleration.iter().zip(held).map(|(own, held)| own + held).collect()
    };
    // Where an acceleration is not defined, nothing is at rest.
    let size = |x: &f64| if x.is_nan() { f64::INFINITY } else { x.abs() };
    let largest = |rest: &[f64]| rest.iter().map(size).fold(0.0, f64::max);
    let mut q = start.to_vec();
    let mut rest = left(&q);
    for _ in 0..MOST_ITERATIONS {
        let slopes = jacobian(model, &q).block((0, 0), (D, D));
        let mut right = Matrix::zeros(D, 1);
        (0..D).for_each(|i| right[(i, 0)] = -rest[i]);
        let Some(step) = solve_matrix(&slopes, &right) else { break };
        let size = largest(&rest);
        let improved = (0..40).find_map(|halvings| {
            let factor = 0.5_f64.powi(halvings);
            let tried: Vec<f64> = (0..D).map(|i| q[i] + factor * step[(i, 0)]).collect();
            let rest = left(&tried);
            (largest(&rest) < size).then_some((tried, rest))
        });
        let Some(better) = improved else { break };
        (q, rest) = better;
    }
    let jacobian = jacobian(model, &q);
    let shift =
        |i: usize| (0..D).map(|j| jacobian[(i, j)].abs() * q[j].abs().max(1.0)).sum::<f64>();
    let rests = (0..D).all(|i| rest[i].abs() <= TOLERANCE * shift(i));
    let found = Equilibrium { q, residual: largest(&rest), jacobian };
    if rests { Ok(found) } else { Err(found) }
}

/// The derivatives of accelerations at rest by coordinates and velocities, exact to rounding.
fn jacobian<const D: usize>(model: impl Model<D>, q: &[f64]) -> Matrix {
    let system = model.on::<Dual<f64>>();
    let mut jacobian = Matrix::zeros(D, 2 * D);
    for j in 0..2 * D {
        let along = |index: usize| if index == j { 1.0 } else { 0.0 };
        let state = State {
            q: core::array::from_fn(|i| Dual { re: q[i], du: along(i) }),
            v: core::array::from_fn(|i| Dual { re: 0.0, du: along(D + i) }),
        };
        for (i, acceleration) in system.acceleration(&state).into_iter().enumerate() {
            jacobian[(i, j)] = acceleration.du;
        }
    }
    jacobian
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pendulum(at: f64, command: f64) -> Result<(LinearPlant, OperatingPoint), Fault> {
        let parameters = BTreeMap::from([("omega2".to_owned(), Number(14.0))]);
        let [at, command] = [at, command].map(|x| Coordinates::One(Number(x)));
        linearise("pendulum", &parameters, Some(&at), Some(&command))
    }

    #[test]
    fn an_inverted_pendulum_grows_at_the_rate_of_its_small_swings() {
        let (plant, point) = pendulum(3.0, 0.0).unwrap();
        assert!((point.q[0] - core::f64::consts::PI).abs() < 1e-15);
        // The sine of the double next to π is 1.2e-16, and the cosine is −1 to rounding.
        assert!(point.residual < 4e-15, "{point:?}");
        assert!((plant.a[(1, 0)] - 14.0).abs() < 1e-14 && plant.a[(0, 1)] == 1.0);
        assert_eq!([plant.b[(0, 0)], plant.b[(1, 0)]], [0.0, 1.0]);
        assert_eq!(plant.states[0], Signal::new("q0", "rad"));
    }

    #[test]
    fn a_constant_command_moves_the_equilibrium() {
        let (plant, point) = pendulum(0.1, 7.0).unwrap();
        // sin q = 7/14, so q = 30°.
        assert!((point.q[0] - core::f64::consts::FRAC_PI_6).abs() < 1e-15);
        assert!((plant.a[(1, 0)] + 14.0 * 0.75_f64.sqrt()).abs() < 1e-14);
    }

    #[test]
    fn a_command_that_no_pendulum_holds_is_refused_with_the_acceleration_that_is_left() {
        let fault = pendulum(0.1, 15.0).unwrap_err();
        assert_eq!(fault.key, "system.linear.at");
        // At q = −90° gravity is 14 of the 15.
        assert!(fault.message.contains("an acceleration of 1.000e0 is left"), "{fault}");
        assert!(pendulum(0.0, 50.0).unwrap_err().message.contains("3.600e1 is left"));
    }

    #[test]
    fn a_force_moves_the_mass_of_an_oscillator_and_damping_is_that_of_its_velocity() {
        let given = [("m", 2.0), ("k", 8.0), ("gamma", 0.3)];
        let parameters = given.map(|(name, x)| (name.to_owned(), Number(x))).into();
        let command = Coordinates::One(Number(4.0));
        let (plant, point) =
            linearise("damped-oscillator", &parameters, None, Some(&command)).unwrap();
        assert_eq!(point.q, [0.5]);
        assert_eq!([plant.a[(1, 0)], plant.a[(1, 1)], plant.b[(1, 0)]], [-4.0, -0.3, 0.5]);
        assert_eq!(plant.inputs[0], Signal::new("force", "N"));
    }

    #[test]
    fn the_saddles_of_henon_and_heiles_are_found() {
        // q = (0, 1) with lambda 1: the accelerations are −x − 2xy and −y − x² + y².
        let at = Coordinates::Each(vec![Number(0.1), Number(0.8)]);
        let (plant, point) = linearise("henon-heiles", &BTreeMap::new(), Some(&at), None).unwrap();
        assert!(point.q[0].abs() < 1e-15 && (point.q[1] - 1.0).abs() < 1e-15, "{point:?}");
        assert!((plant.a[(2, 0)] + 3.0).abs() < 1e-14 && (plant.a[(3, 1)] - 1.0).abs() < 1e-14);
    }

    #[test]
    fn systems_without_equilibrium_are_refused() {
        for (name, key, message) in [
            ("driven-oscillator", "system.linear.of", "depends on time"),
            ("kepler", "system.linear.at", "no equilibrium of `kepler`"),
            ("pendulm", "system.linear.of", "unknown system `pendulm`"),
        ] {
            let at = Coordinates::Each(vec![Number(1.0), Number(0.5)]);
            let fault = linearise(name, &BTreeMap::new(), Some(&at), None).unwrap_err();
            assert_eq!(fault.key, key);
            assert!(fault.message.contains(message), "{fault}");
        }
    }
}
