//! Published Runge–Kutta methods: their coefficients as data.

use super::Integrator;
use super::table_comparison::compared_by_name;
use crate::array::each;
use crate::{Scalar, State, System};

/// A published explicit Runge–Kutta method with its source. None is symplectic.
///
/// All of them share one step, so that a further method adds no code.
pub struct RungeKuttaTable {
    /// Name on the command line and in configurations.
    pub name: &'static str,
    /// Name in running text.
    pub title: &'static str,
    /// A description in one line.
    pub summary: &'static str,
    /// Authors, year, and place of the coefficients.
    pub source: &'static str,
    /// Classical order of consistency.
    pub order: u32,
    /// The coefficients.
    pub coefficients: RungeKuttaCoefficients,
}

/// The coefficients of an explicit method: row `i` of `a` has those of the stages before stage `i`.
///
/// Hairer, Nørsett, Wanner: Solving Ordinary Differential Equations I, 2nd ed., §II.1 and §II.14.
#[derive(Clone, Copy, Debug)]
pub enum RungeKuttaCoefficients {
    /// `Kᵢ = f(y + h Σ aᵢⱼKⱼ)`, `y' = y + h Σ bᵢKᵢ` for a state `y` with the rate `f`.
    General {
        /// `aᵢⱼ`.
        a: &'static [&'static [f64]],
        /// `bᵢ`.
        b: &'static [f64],
    },
    /// `Aᵢ = a(q + cᵢh·v + h² Σ aᵢⱼAⱼ)`, `q' = q + h·v + h² Σ b̄ᵢAᵢ`, `v' = v + h Σ bᵢAᵢ` for accelerations `a` of positions
    /// (Runge–Kutta–Nyström).
    Nystrom {
        /// `cᵢ`.
        c: &'static [f64],
        /// `aᵢⱼ`.
        a: &'static [&'static [f64]],
        /// `b̄ᵢ`.
        b_position: &'static [f64],
        /// `bᵢ`.
        b: &'static [f64],
    },
}

use RungeKuttaCoefficients::{General, Nystrom};

/// The most stages of a table.
const MOST_STAGES: usize = 17;

impl RungeKuttaCoefficients {
    /// The number of stages, each with a force evaluation.
    pub const fn stages(&self) -> usize {
        match self {
            General { b, .. } | Nystrom { b, .. } => b.len(),
        }
    }
}

impl Integrator for &'static RungeKuttaTable {
    // The rates of the stages are in memory.
    const REGISTERS: usize = 10;

    // A loop in the loop over the lanes leaves no vectors; programs of these steps have none, and are vectors.
    const BASELINE_ONLY: bool = true;

    fn evaluations(&self) -> usize {
        self.coefficients.stages()
    }

    #[inline]
    fn step<S: Scalar, const D: usize>(
        self,
        system: &impl System<S, D>,
        state: State<S, D>,
        dt: S,
    ) -> State<S, D> {
        match self.coefficients {
            General { a, b } => {
                let mut rates = [State::origin(); MOST_STAGES];
                for (i, row) in a.iter().enumerate() {
                    rates[i] = system.rate(plus_rates(state, dt, row, &rates));
                }
                plus_rates(state, dt, b, &rates)
            }
            Nystrom { c, a, b_position, b } => {
                let mut forces = [[S::zero(); D]; MOST_STAGES];
                let square = dt * dt;
                for (i, row) in a.iter().enumerate() {
                    let mut at = state.drift(dt * S::from_f64(c[i]));
                    at.q = plus_forces(at.q, square, row, &forces);
                    forces[i] = system.acceleration(&at);
                }
                State {
                    q: plus_forces(state.drift(dt).q, square, b_position, &forces),
                    v: plus_forces(state.v, dt, b, &forces),
                }
            }
        }
    }
}

/// `state + h Σ wᵢ·rateᵢ`.
fn plus_rates<S: Scalar, const D: usize>(
    state: State<S, D>,
    h: S,
    weights: &[f64],
    rates: &[State<S, D>],
) -> State<S, D> {
    let used = weights.iter().zip(rates).filter(|(weight, _)| **weight != 0.0);
    used.fold(state, |sum, (&weight, &rate)| sum.plus(h * S::from_f64(weight), rate))
}

/// `x + h Σ wᵢ·forceᵢ`.
fn plus_forces<S: Scalar, const D: usize>(
    x: [S; D],
    h: S,
    weights: &[f64],
    forces: &[[S; D]],
) -> [S; D] {
    let used = weights.iter().zip(forces).filter(|(weight, _)| **weight != 0.0);
    used.fold(x, |sum, (&weight, force)| {
        let part = h * S::from_f64(weight);
        each(|i| sum[i] + part * force[i])
    })
}

compared_by_name!(RungeKuttaTable);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Method;

    /// Two coupled oscillators whose forces depend on positions and velocities.
    struct Coupled;

    impl System<f64, 2> for Coupled {
        fn acceleration(&self, state: &State<f64, 2>) -> [f64; 2] {
            let State { q, v } = state;
            [-q[0].powi(3) - 0.1 * v[1], -q[1].sin() + 0.2 * v[0] * q[0]]
        }
    }

    #[test]
    fn a_step_of_dormand_and_prince_is_that_of_scipy() {
        // SciPy 1.17, `scipy.integrate._ivp.rk.rk_step` with the coefficients of `RK45` and of `DOP853`.
        let scipy = [
            (
                "dormand-prince-5",
                [0.9481751731644522, -0.8968115479007138, 0.07929807657114718, 0.9193103489829509],
            ),
            (
                "dormand-prince-8",
                [0.9481753762137823, -0.8968116331647569, 0.07929750654259698, 0.9193102393650392],
            ),
        ];
        let start = State { q: [0.9, -1.1], v: [0.3, 0.7] };
        for (name, wanted) in scipy {
            let method = Method::from_name(name).unwrap();
            let end = method.step(&Coupled, start, 0.25);
            for (own, wanted) in end.coordinates().zip(wanted) {
                // Sums of up to twelve terms in another order.
                assert!((own - wanted).abs() < 12.0 * f64::EPSILON, "{name}: {own}, not {wanted}");
            }
        }
    }
}
