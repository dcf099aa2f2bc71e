//! Masses and modes of a system about an equilibrium.

use libration::Scalar;
use libration::analysis::{Equilibrium, jacobian};
use libration::equations::{Degree, Dynamics};
use libration::linear::{Matrix, cholesky, eigenvalues, solve_matrix};
use libration::number::Dual;
use libration_settings::equations::EquationSystem;

use super::TemperatureError;

/// A relative difference that counts as rounding: derivatives are exact to some operations.
const ROUNDING: f64 = 1e-9;

/// A part of the square of the highest frequency, at the start or in the equilibrium, below which a square of a frequency counts as zero.
const NOTHING: f64 = 1e-12;

/// The modes of a system with a potential and constant masses about a stable equilibrium.
#[derive(Debug)]
pub(super) struct NormalModes {
    /// The equilibrium: positions.
    pub(super) equilibrium: Vec<f64>,
    /// The mass matrix.
    pub(super) mass: Matrix,
    /// The lower triangular `L` with `L Lᵀ` the inverse of the mass matrix.
    pub(super) inverse_root: Matrix,
    /// Angular frequencies of the modes in rad/s, the slowest first.
    pub(super) frequencies: Vec<f64>,
}

impl NormalModes {
    /// The modes about the equilibrium in whose valley the system starts.
    ///
    /// # Errors
    /// [`TemperatureError`]: the reason for which no temperature is stationary.
    pub(super) fn new(system: &EquationSystem) -> Result<Self, TemperatureError> {
        let (name, dynamics) = (&*system.name, system.equations.dynamics());
        let own_name = || name.to_owned();
        for degree in system.equations.degrees() {
            match degree {
                Degree::Coordinate(_) => {}
                Degree::Time => return Err(TemperatureError::Time { system: own_name() }),
                Degree::State(state) => {
                    let state = state.clone();
                    return Err(TemperatureError::FirstOrder { system: own_name(), state });
                }
            }
        }
        if !dynamics.is_positional() {
            return Err(TemperatureError::Velocity { system: own_name() });
        }
        let n = dynamics.degrees();
        let mut at = system.start();
        at[n..].fill(0.0);
        let at_start = largest_square(dynamics, &at);
        descend(dynamics, &mut at);
        let positions: Vec<usize> = (0..n).collect();
        let rest = Equilibrium::near(dynamics, &at, &positions)
            .map_err(|_| TemperatureError::NoEquilibrium { system: own_name() })?;
        let equilibrium = rest.state[..n].to_vec();
        // The energy of a system of the catalogue is that per unit mass.
        let unit_mass = system.twin.map_or(1.0, |twin| twin.actuation.mass());
        let energy = Energy { dynamics, unit_mass };
        let mass = energy.mass(&rest.state);
        let inverse = solve_matrix(&mass, &Matrix::identity(n));
        let not_positive = || TemperatureError::Mass {
            system: own_name(),
            problem: "a kinetic energy that is not positive",
        };
        let inverse = inverse.ok_or_else(not_positive)?;
        let (root, inverse_root) = (cholesky(&mass), cholesky(&inverse));
        if (0..n).any(|i| root[(i, i)] <= 0.0 || inverse_root[(i, i)] <= 0.0) {
            return Err(not_positive());
        }
        energy.check(name, &rest.state, &mass)?;
        // In the coordinates L⁻¹q each mass is 1, and the stiffness is symmetric.
        let stiffness = rest.jacobian.block((0, 0), (n, n));
        let back = solve_matrix(&inverse_root, &stiffness).ok_or_else(not_positive)?;
        let squares = eigenvalues(&(&back * &inverse_root).scaled(-1.0)).unwrap_or_default();
        let mut squares: Vec<f64> = squares.iter().map(|value| value.re).collect();
        squares.sort_by(f64::total_cmp);
        let [least, most] =
            [squares.first(), squares.last()].map(|x| x.copied().unwrap_or(f64::NAN));
        let zero = NOTHING * most.max(at_start);
        if !(least > zero && most.is_finite()) {
            // Not the negative zero.
            let (system, positions, square) = (own_name(), equilibrium, least + 0.0);
            return Err(match least.abs() <= zero {
                true => TemperatureError::NoStiffness { system, positions, square },
                false => TemperatureError::Unstable { system, positions, square },
            });
        }
        let frequencies = squares.into_iter().map(f64::sqrt).collect();
        Ok(NormalModes { equilibrium, mass, inverse_root, frequencies })
    }

    /// Whether positions descend to the equilibrium, and to no other.
    pub(super) fn is_in_valley(&self, dynamics: &Dynamics, positions: &[f64]) -> bool {
        let mut at = positions.to_vec();
        at.resize(2 * positions.len() + dynamics.inputs(), 0.0);
        descend(dynamics, &mut at);
        let far = |(x, own): (&f64, &f64)| (x - own).abs() > 1e-3 * own.abs().max(1.0);
        !at.iter().zip(&self.equilibrium).any(far)
    }

    /// The angular frequency of the fastest mode in rad/s.
    pub(super) fn fastest(&self) -> f64 {
        self.frequencies.last().copied().unwrap_or(f64::NAN)
    }
}

/// The largest size of a square of a frequency about a state; zero if there is none.
fn largest_square(dynamics: &Dynamics, at: &[f64]) -> f64 {
    let n = dynamics.degrees();
    let squares = eigenvalues(&jacobian(dynamics, at).block((0, 0), (n, n))).unwrap_or_default();
    let sizes = squares.iter().map(|value| value.re.abs()).filter(|size| size.is_finite());
    sizes.fold(0.0, f64::max)
}

/// Steps of the descent at most; Newton's method then does the rest.
const DESCENT: usize = 20_000;

/// Steps of the descent of the same length.
const SAME_LENGTH: usize = 16;

/// Moves positions down the potential, almost to the bottom of the valley, since Newton's method alone ends at any equilibrium.
///
/// By symplectic Euler steps that lose their velocity where it points up (H. Jónsson, G. Mills, K. W. Jacobsen, *Nudged elastic band
/// method for finding minimum energy paths of transitions*, 1998).
fn descend(dynamics: &Dynamics, at: &mut [f64]) {
    let n = dynamics.degrees();
    let mut accelerations = dynamics.accelerations().on::<f64>();
    let mut velocities = vec![0.0; n];
    let (mut dt, mut first) = (0.0, 0.0);
    for number in 0..DESCENT {
        if number % SAME_LENGTH == 0 {
            let stiffness = jacobian(dynamics, at).block((0, 0), (n, n)).row_sum_norm();
            dt = 0.2 / stiffness.sqrt();
        }
        let all: Vec<f64> = accelerations.run(at).collect();
        let size = all.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        first = f64::max(first, size);
        if !(dt.is_finite() && size.is_finite()) || size <= 1e-6 * first {
            return;
        }
        let up = velocities.iter().zip(&all).map(|(v, a)| v * a).sum::<f64>() < 0.0;
        for i in 0..n {
            velocities[i] = if up { 0.0 } else { velocities[i] } + dt * all[i];
            at[i] += dt * velocities[i];
        }
    }
}

/// Whether a difference is rounding beside a matrix; false of what is not a number.
fn is_rounding(difference: &Matrix, of: &Matrix) -> bool {
    difference.largest() <= ROUNDING * of.largest()
}

/// The energy of a system, from which masses follow.
struct Energy<'d> {
    dynamics: &'d Dynamics,
    unit_mass: f64,
}

impl Energy<'_> {
    /// The second derivatives of the energy by velocities.
    fn mass(&self, at: &[f64]) -> Matrix {
        let n = self.dynamics.degrees();
        let Some(energy) = self.dynamics.energy() else {
            return Matrix::identity(n).scaled(self.unit_mass);
        };
        let mut energy = energy.on::<Dual<Dual<f64>>>();
        let mut inputs: Vec<Dual<Dual<f64>>> = at.iter().map(|&x| Scalar::from_f64(x)).collect();
        let mut mass = Matrix::zeros(n, n);
        for i in 0..n {
            for j in 0..n {
                let own = inputs[n + i];
                inputs[n + i].re.du = 1.0;
                let other = inputs[n + j];
                inputs[n + j].du.re = 1.0;
                mass[(i, j)] =
                    self.unit_mass * energy.run(&inputs).next().map_or(f64::NAN, |e| e.du.du);
                inputs[n + j] = other;
                inputs[n + i] = own;
            }
        }
        mass
    }

    /// The derivatives of the energy by positions.
    fn slopes(&self, at: &[f64]) -> Option<Vec<f64>> {
        let mut energy = self.dynamics.energy()?.on::<Dual<f64>>();
        let mut inputs: Vec<Dual<f64>> = at.iter().map(|&x| Dual::constant(x)).collect();
        let slope = |i: usize| {
            inputs[i] = Dual::variable(at[i]);
            let slope = energy.run(&inputs).next().map_or(f64::NAN, |energy| energy.du);
            inputs[i] = Dual::constant(at[i]);
            self.unit_mass * slope
        };
        Some((0..self.dynamics.degrees()).map(slope).collect())
    }

    /// Checks near an equilibrium that masses are constant, and that forces are the slopes of the potential.
    fn check(&self, name: &str, rest: &[f64], mass: &Matrix) -> Result<(), TemperatureError> {
        let n = self.dynamics.degrees();
        let mut at = rest.to_vec();
        for (i, x) in at.iter_mut().take(2 * n).enumerate() {
            // Parts of the golden ratio: no symmetry holds there.
            let part = (0.618_033_988_749_895 * (1.0 + i as f64)).fract() - 0.5;
            *x += 0.1 * part * x.abs().max(1.0);
        }
        let system = || name.to_owned();
        let mut there = self.mass(&at);
        there.add_scaled(-1.0, mass);
        if !is_rounding(&there, mass) {
            let problem = "masses that depend on the state";
            return Err(TemperatureError::Mass { system: system(), problem });
        }
        let stiffness = mass * &jacobian(self.dynamics, &at).block((0, 0), (n, n));
        let mut skew = stiffness.transposed();
        skew.add_scaled(-1.0, &stiffness);
        let has_energy = self.dynamics.energy().is_some();
        let help = match has_energy {
            false => {
                "; help: without an `energy` all masses are 1: give the energy of unequal masses"
            }
            true => "",
        };
        if !is_rounding(&skew, &stiffness) {
            return Err(TemperatureError::NoPotential { system: system(), help });
        }
        let Some(slopes) = self.slopes(&at) else { return Ok(()) };
        let forces =
            mass.apply(&self.dynamics.accelerations().on::<f64>().run(&at).collect::<Vec<f64>>());
        let size = slopes.iter().chain(&forces).fold(0.0, |most: f64, x| most.max(x.abs()));
        let is_slope = |(force, slope): (&f64, &f64)| (force + slope).abs() <= ROUNDING * size;
        match forces.iter().zip(&slopes).all(is_slope) {
            true => Ok(()),
            false => Err(TemperatureError::NoPotential {
                system: system(),
                help: "; help: `energy` is not the energy of these accelerations",
            }),
        }
    }
}
