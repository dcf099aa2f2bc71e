//! The system of a setting, with the place at which it is linear.

use libration_analysis::{Equilibrium, jacobian, rate_derivative};
use libration_core::{Elementary, Float};
use libration_equations::{Degree, Equations, Evaluation, StepProgram};
use libration_linear::{LinearPlant, Matrix, eigenvalues};

use crate::{Setting, SettingError};

/// The most degrees of freedom that a page steps thousands of times in a frame.
pub const MOST_DEGREES: usize = 16;

/// A system of equations with its start.
pub(crate) struct Subject {
    pub(crate) equations: Equations,
    /// The places of the states among positions and velocities, in rising order.
    pub(crate) places: Vec<usize>,
    /// The names of the states.
    pub(crate) names: Vec<String>,
    /// Positions and velocities at the start.
    pub(crate) start: Vec<f64>,
    /// The places of coordinates and states of first order.
    unknowns: Vec<usize>,
}

/// A point at which a system is linearised.
#[derive(Clone)]
pub(crate) struct Point {
    /// Positions and velocities.
    pub(crate) state: Vec<f64>,
    /// Inputs.
    pub(crate) inputs: Vec<f64>,
    /// Whether the system rests there.
    pub(crate) rests: bool,
}

impl Subject {
    pub(crate) fn new(setting: &Setting) -> Result<Self, SettingError> {
        let equations = Equations::new(&setting.definitions)?;
        let d = equations.degrees().len();
        if d > MOST_DEGREES {
            let why = format!(
                "{d} degrees of freedom; expected at most {MOST_DEGREES} in a page: `libration analyze --system FILE` has no such limit"
            );
            return Err(SettingError::Subject(why));
        }
        let most = StepProgram::most_degrees(setting.integrator);
        if d > most {
            let why = format!(
                "{d} degrees of freedom; expected at most {most} with the integrator {}",
                setting.integrator.name()
            );
            return Err(SettingError::Subject(why));
        }
        let (mut places, mut unknowns) = (Vec::new(), Vec::new());
        let mut names = vec![String::new(); 2 * d];
        let mut start = vec![0.0; 2 * d];
        for (i, degree) in equations.degrees().iter().enumerate() {
            match degree {
                Degree::Coordinate(name) => {
                    places.extend([i, d + i]);
                    unknowns.push(i);
                    names[i] = name.clone();
                    names[d + i] = format!("{name}'");
                }
                Degree::State(name) => {
                    places.push(d + i);
                    unknowns.push(d + i);
                    names[d + i] = name.clone();
                }
                Degree::Time => start[d + i] = 1.0,
            }
        }
        places.sort_unstable();
        for (name, value) in &setting.start {
            let place = names.iter().position(|own| own == name).filter(|_| !name.is_empty());
            let place = place.ok_or_else(|| SettingError::Key(format!("start.{name}")))?;
            start[place] = *value;
        }
        let names = places.iter().map(|&i| names[i].clone()).collect();
        Ok(Subject { equations, places, names, start, unknowns })
    }

    /// Degrees of freedom.
    pub(crate) fn degrees(&self) -> usize {
        self.equations.degrees().len()
    }

    /// The equilibrium without commands nearer to the start, of the two that Newton's method finds from the start and from zero; the
    /// start if there is none. `parameters` are the values of parameters that vary.
    pub(crate) fn point(&self, parameters: &[f64]) -> Point {
        let mut points = self.points(parameters);
        points.swap_remove(0)
    }

    /// The same, but an equilibrium at which deviations grow by nature only if they do at both.
    pub(crate) fn calm_point(&self, parameters: &[f64]) -> Point {
        let mut points = self.points(parameters);
        let grows = |point: &Point| {
            let values = eigenvalues(&self.slopes(point)).unwrap_or_default();
            values.iter().any(|value| value.re > 1e-9 * value.norm())
        };
        let calm = points.iter().position(|point| point.rests && !grows(point));
        points.swap_remove(calm.unwrap_or(0))
    }

    /// The largest size of an eigenvalue of the equations at the start and at the equilibrium, in 1/s.
    pub(crate) fn fastest_rate(&self) -> f64 {
        let inputs = vec![0.0; self.equations.inputs().len()];
        let start = Point { state: self.start.clone(), inputs, rests: false };
        fastest(&self.slopes(&start)).max(fastest(&self.slopes(&self.calm_point(&[]))))
    }

    /// Equilibria, the nearer to the start first; the start if there are none.
    fn points(&self, parameters: &[f64]) -> Vec<Point> {
        let mut inputs = vec![0.0; self.equations.inputs().len()];
        inputs.extend(parameters);
        let d = self.degrees();
        let depends_on_time = self.equations.degrees().iter().enumerate().any(|(i, degree)| {
            let mut used = self.equations.dynamics().accelerations().inputs_in_use();
            *degree == Degree::Time && used.any(|input| input == i)
        });
        let search = |from: Vec<f64>| {
            let at = [from, inputs.clone()].concat();
            Equilibrium::by_newton(self.equations.dynamics(), &at, &self.unknowns).ok()
        };
        // Velocities are zero at rest, other than those of states of first order and of time.
        let mut at_rest = self.start.clone();
        for &place in self.places.iter().filter(|&place| !self.unknowns.contains(place)) {
            at_rest[place] = 0.0;
        }
        let mut zero = at_rest.clone();
        self.unknowns.iter().for_each(|&place| zero[place] = 0.0);
        let found = if depends_on_time { [None, None] } else { [search(at_rest), search(zero)] };
        let distance = |found: &Equilibrium| -> f64 {
            self.unknowns.iter().map(|&i| (found.state[i] - self.start[i]).powi(2)).sum()
        };
        let mut found: Vec<Equilibrium> = found.into_iter().flatten().collect();
        found.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        if found.is_empty() {
            return vec![Point { state: self.start.clone(), inputs, rests: false }];
        }
        let point = |found: Equilibrium| Point {
            state: found.state[..2 * d].to_vec(),
            inputs: inputs.clone(),
            rests: true,
        };
        found.into_iter().map(point).collect()
    }

    /// The plant near a point, with all states measured.
    pub(crate) fn plant(&self, point: &Point) -> Result<LinearPlant, SettingError> {
        let at = [point.state.clone(), point.inputs.clone()].concat();
        let slopes = jacobian(self.equations.dynamics(), &at);
        let (n, m, d) = (self.places.len(), self.equations.inputs().len(), self.degrees());
        let a =
            Matrix::from_fn(n, n, |i, j| rate_derivative(&slopes, self.places[i], self.places[j]));
        let b = Matrix::from_fn(n, m, |i, j| rate_derivative(&slopes, self.places[i], 2 * d + j));
        LinearPlant::new(a, b, Matrix::identity(n), Matrix::zeros(n, m))
            .map_err(|error| SettingError::Subject(error.to_string()))
    }

    /// A point in words.
    pub(crate) fn describe(&self, point: &Point) -> String {
        let states = self.names.iter().zip(&self.places);
        let states = states.filter(|(_, place)| !point.rests || self.unknowns.contains(place));
        let value = |x: f64| {
            let text = format!("{:.4}", x + 0.0);
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        };
        let values: Vec<String> = states
            .map(|(name, &place)| format!("{name} = {}", value(point.state[place])))
            .collect();
        format!("{} {}", if point.rests { "equilibrium" } else { "start" }, values.join(", "))
    }

    /// The derivatives of the rates of the states by the states near a point.
    pub(crate) fn slopes(&self, point: &Point) -> Matrix {
        let at = [point.state.clone(), point.inputs.clone()].concat();
        let slopes = jacobian(self.equations.dynamics(), &at);
        let n = self.places.len();
        Matrix::from_fn(n, n, |i, j| rate_derivative(&slopes, self.places[i], self.places[j]))
    }

    /// The energy of positions and velocities under no command; none if the system has no energy.
    pub(crate) fn energy(&self) -> Option<impl FnMut(&[f64]) -> f64> {
        let mut energy = self.equations.dynamics().energy()?.on::<f64>();
        Some(move |state: &[f64]| energy.run(state).next().unwrap_or(f64::NAN))
    }

    /// A factor of the deviations that are small for this state.
    pub(crate) fn scale(&self, point: &Point) -> f64 {
        self.unknowns.iter().map(|&i| point.state[i].abs()).fold(1.0, f64::max)
    }
}

/// The largest size of an eigenvalue.
pub(crate) fn fastest(matrix: &Matrix) -> f64 {
    let values = eigenvalues(matrix).unwrap_or_default();
    values.iter().map(|value| value.norm()).fold(0.0, f64::max)
}

/// A step, ready to run.
pub(crate) struct Stepper<'p, S> {
    program: Evaluation<'p, S>,
    inputs: Vec<S>,
    states: usize,
}

impl<'p, S: Elementary> Stepper<'p, S> {
    /// A step of a system with `states` positions and velocities.
    pub(crate) fn new(step: &'p StepProgram, states: usize) -> Self {
        Stepper { program: step.program().on::<S>(), inputs: Vec::new(), states }
    }

    /// Moves positions and velocities by a step of `dt` seconds under constant inputs.
    pub(crate) fn step(&mut self, state: &mut [S], inputs: &[S], dt: f64) {
        self.inputs.clear();
        self.inputs.extend_from_slice(&state[..self.states]);
        self.inputs.extend_from_slice(inputs);
        self.inputs.push(S::from_f64(dt));
        state.iter_mut().zip(self.program.run(&self.inputs)).for_each(|(x, new)| *x = new);
    }
}

/// Whether all numbers are finite.
pub(crate) fn is_finite(state: &[f64]) -> bool {
    state.iter().all(|x| Float::is_finite(*x))
}
