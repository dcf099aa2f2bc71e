//! Systems, linearised at an equilibrium.

use std::collections::BTreeMap;

use libration::analysis::{ConservedSum, Equilibrium, rate_derivative};
use libration::linear::{LinearPlant, Matrix};

use super::subject::{Subject, is_file};
use super::{ConservedValue, Coordinates, OperatingPoint, OperatingValue};
use crate::equations::EquationSystem;
use crate::{Fault, Number};

/// The plant of a system of the catalogue or of the equations in a file, and the equilibrium at which Newton's method ends that begins
/// `at`.
///
/// # Errors
/// [`Fault`]: an unknown system or parameter, a system that depends on time, or no equilibrium.
pub(super) fn linearise(
    name: &str,
    parameters: &BTreeMap<String, Number>,
    at: Option<&Coordinates>,
    command: Option<&Coordinates>,
) -> Result<(LinearPlant, OperatingPoint), Fault> {
    let parameters: Vec<(String, f64)> = parameters.iter().map(|(k, v)| (k.clone(), v.0)).collect();
    match is_file(name) {
        true => {
            let subject = Subject::of_file(name, &parameters)?;
            match (at, command) {
                (None, None) => subject.linearised_near_start(),
                _ => subject.linearised(at, command),
            }
        }
        false => {
            let dimension = at.map(Coordinates::len);
            Subject::of_catalogue(name, &parameters, dimension)?.linearised(at, command)
        }
    }
}

/// The plant of a system of equations at an equilibrium: at one with the values of the sums that the motion from the start conserves, if
/// there is one. Else of those that the search finds from the start and from zero the one nearer to the start.
///
/// # Errors
/// [`Fault`]: a system that depends on time, or no equilibrium.
pub fn linearised_equations(
    system: &EquationSystem,
) -> Result<(LinearPlant, OperatingPoint), Fault> {
    Subject::of_equations(system)?.linearised_near_start()
}

impl Subject {
    /// At an equilibrium with the conserved sums of the start, or at the nearer of two others.
    fn linearised_near_start(&self) -> Result<(LinearPlant, OperatingPoint), Fault> {
        let Subject { dynamics, start, unknowns, sums, .. } = self;
        if let Some(found) = Equilibrium::with_sums(dynamics, start, unknowns, sums) {
            return self.plant_at(start, found);
        }
        let zero = Coordinates::Each(vec![Number(0.0); self.unknowns.len()]);
        let from_start = self.equilibrium(None, None);
        let from_zero = self.equilibrium(Some(&zero), None);
        let distance = |found: &Equilibrium| -> f64 {
            unknowns.iter().map(|&place| (found.state[place] - start[place]).powi(2)).sum()
        };
        let (_, found) = match (from_start, from_zero) {
            (Ok(first), Ok(second)) if distance(&second.1) < distance(&first.1) => second,
            (Err(_), Ok(second)) => second,
            (first, _) => first?,
        };
        self.plant_at(start, found)
    }

    fn linearised(
        &self,
        at: Option<&Coordinates>,
        command: Option<&Coordinates>,
    ) -> Result<(LinearPlant, OperatingPoint), Fault> {
        let (start, found) = self.equilibrium(at, command)?;
        self.plant_at(&start, found)
    }

    /// The equilibrium that a search finds, and its start.
    fn equilibrium(
        &self,
        at: Option<&Coordinates>,
        command: Option<&Coordinates>,
    ) -> Result<(Vec<f64>, Equilibrium), Fault> {
        let Subject { name, dynamics, signals, start, unknowns, mass, .. } = self;
        let (mut start, mass) = (start.clone(), *mass);
        let inputs = self.inputs();
        let set = |places: &[usize], given: Option<&Coordinates>, key, start: &mut Vec<f64>| {
            let Some(given) = given else { return Ok(()) };
            let names: Vec<&str> = places.iter().map(|&i| signals[i].name.as_str()).collect();
            let known: Vec<f64> = places.iter().map(|&i| start[i]).collect();
            let numbers = given.numbers(key, &names, &known)?;
            places.iter().zip(numbers).for_each(|(&i, x)| start[i] = x);
            Ok(())
        };
        set(unknowns, at, "system.linear.at", &mut start)?;
        set(&inputs, command, "system.linear.command", &mut start)?;
        inputs.iter().for_each(|&i| start[i] /= mass);
        let found = Equilibrium::near(dynamics, &start, unknowns);
        let found = found.map_err(|left| {
            let values: Vec<String> = unknowns
                .iter()
                .map(|&i| format!("{} = {:?}", signals[i].name, left.state[i]))
                .collect();
            let message = format!(
                "no equilibrium of `{name}` found: at {} an acceleration of {:.3e} is left",
                values.join(", "),
                left.residual
            );
            Fault::new("system.linear.at", message)
                .help("begin `at` coordinates nearer to one, or change `command`".to_owned())
        })?;
        Ok((start, found))
    }

    /// The plant at an equilibrium that was found from `start`.
    fn plant_at(
        &self,
        start: &[f64],
        found: Equilibrium,
    ) -> Result<(LinearPlant, OperatingPoint), Fault> {
        let Subject { name, dynamics, signals, unknowns, states, mass, .. } = self;
        let Equilibrium { state, residual, jacobian, continuum, undecided } = found;
        let inputs: Vec<usize> = self.inputs();
        let value = |&i: &usize, x: f64| OperatingValue {
            name: signals[i].name.clone(),
            value: x,
            unit: signals[i].unit.clone(),
        };
        let commands = inputs.iter().map(|i| value(i, mass * state[*i])).collect();
        let size = |state: &[f64]| unknowns.iter().map(|&i| state[i].abs()).fold(0.0, f64::max);
        let squares = unknowns.iter().map(|&i| (state[i] - start[i]).powi(2));
        let distance = squares.sum::<f64>().sqrt();
        let relative_distance = match size(&state).max(size(start)) {
            0.0 => 0.0,
            scale => distance / scale,
        };
        let conserved = self.sums.iter().map(|sum| ConservedValue {
            sum: self.sum_in_words(sum),
            start: sum.start,
            value: sum.at(&state),
            equal: sum.holds_at(&state),
        });
        let conserved = conserved.collect();
        let n = states.len();
        let a = Matrix::from_fn(n, n, |i, j| rate_derivative(&jacobian, states[i], states[j]));
        let b = Matrix::from_fn(n, inputs.len(), |i, j| {
            rate_derivative(&jacobian, states[i], inputs[j]) / *mass
        });
        let of = |places: &[usize]| places.iter().map(|&i| signals[i].clone()).collect::<Vec<_>>();
        let zero = Matrix::zeros(n, inputs.len());
        let plant = LinearPlant::new(a, b, Matrix::identity(n), zero)
            .and_then(|plant| plant.named(of(states), of(&inputs), of(states)))
            .map_err(|error| Fault::new("system.linear.of", error.to_string()))?;
        let plant = LinearPlant { has_first_order_states: self.has_first_order_states, ..plant };
        let states = unknowns.iter().map(|i| value(i, state[*i])).collect();
        let is_smooth = dynamics.accelerations().is_smooth();
        let point = OperatingPoint {
            system: name.clone(),
            states,
            commands,
            residual,
            distance,
            relative_distance,
            continuum,
            undecided,
            conserved,
            is_smooth,
        };
        Ok((plant, point))
    }

    /// The places of the inputs.
    fn inputs(&self) -> Vec<usize> {
        let all = 2 * self.dynamics.degrees()..self.signals.len();
        all.filter(|&i| !self.signals[i].name.is_empty()).collect()
    }

    /// A weighted sum by the names of its states.
    fn sum_in_words(&self, sum: &ConservedSum) -> String {
        let mut words = String::new();
        for (i, (place, weight)) in sum.weights.iter().enumerate() {
            let sign = match (i, *weight < 0.0) {
                (0, false) => "",
                (0, true) => "−",
                (_, false) => " + ",
                (_, true) => " − ",
            };
            let factor = match weight.abs() {
                1.0 => String::new(),
                size => format!("{} ", format!("{size:.5e}").parse().unwrap_or(size)),
            };
            words += &format!("{sign}{factor}{}", self.signals[*place].name);
        }
        words
    }
}

#[cfg(test)]
mod tests {
    use libration::linear::Signal;

    use super::*;

    fn pendulum(at: f64, command: f64) -> Result<(LinearPlant, OperatingPoint), Fault> {
        let parameters = BTreeMap::from([("omega2".to_owned(), Number(14.0))]);
        let [at, command] = [at, command].map(|x| Coordinates::One(Number(x)));
        linearise("pendulum", &parameters, Some(&at), Some(&command))
    }

    #[test]
    fn an_inverted_pendulum_grows_at_the_rate_of_its_small_swings() {
        let (plant, point) = pendulum(3.0, 0.0).unwrap();
        assert!((point.states[0].value - core::f64::consts::PI).abs() < 1e-15);
        // The sine of the double next to π is 1.2e-16, and the cosine is −1 to rounding.
        assert!(point.residual < 4e-15, "{point:?}");
        assert!((plant.a[(1, 0)] - 14.0).abs() < 1e-14 && plant.a[(0, 1)] == 1.0);
        assert_eq!([plant.b[(0, 0)], plant.b[(1, 0)]], [0.0, 1.0]);
        assert_eq!(plant.states[0], Signal::new("q", "rad"));
    }

    #[test]
    fn a_constant_command_moves_the_equilibrium() {
        let (plant, point) = pendulum(0.1, 7.0).unwrap();
        // sin q = 7/14, so q = 30°.
        assert!((point.states[0].value - core::f64::consts::FRAC_PI_6).abs() < 1e-15);
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
        assert_eq!(point.states[0].value, 0.5);
        assert_eq!([plant.a[(1, 0)], plant.a[(1, 1)], plant.b[(1, 0)]], [-4.0, -0.3, 0.5]);
        assert_eq!(plant.inputs[0], Signal::new("force", "N"));
    }

    #[test]
    fn the_saddles_of_henon_and_heiles_are_found() {
        // q = (0, 1) with lambda 1: the accelerations are −x − 2xy and −y − x² + y².
        let at = Coordinates::Each(vec![Number(0.1), Number(0.8)]);
        let (plant, point) = linearise("henon-heiles", &BTreeMap::new(), Some(&at), None).unwrap();
        assert!(
            point.states[0].value.abs() < 1e-15 && (point.states[1].value - 1.0).abs() < 1e-15,
            "{point:?}"
        );
        assert!((plant.a[(2, 0)] + 3.0).abs() < 1e-14 && (plant.a[(3, 1)] - 1.0).abs() < 1e-14);
    }

    #[test]
    fn an_energy_may_depend_on_time_where_accelerations_do_not() {
        let parse = |acceleration: &str| {
            let text = format!(
                "[system]\nname = \"a\"\ncoordinates = [\"x\"]\nacceleration.x = \"{acceleration}\"\n\
                 energy = \"x'^2/2 + 2*x^2 + 0.1*t\"\nstart = {{ x = 0.3 }}\n"
            );
            EquationSystem::parse(&text, "a.toml", &[]).unwrap()
        };
        let (plant, point) = linearised_equations(&parse("1 - 4*x")).unwrap();
        assert_eq!(point.states[0].value, 0.25);
        assert_eq!([plant.a[(1, 0)], plant.b[(1, 0)]], [-4.0, 1.0]);
        assert_eq!([plant.states.len(), plant.inputs.len()], [2, 1]);
        let fault = linearised_equations(&parse("sin(t) - 4*x")).unwrap_err();
        assert!(fault.message.contains("depends on time"), "{fault}");
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
