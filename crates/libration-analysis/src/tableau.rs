//! The tableau of a step: the weights of its force evaluations.

use core::cell::RefCell;

use libration_core::number::{Poly, Ratio};
use libration_core::{Integrator, Scalar, State, System};

/// The coefficients of an integrator on `q̈ = a(q)`, by running one step on formal symbols.
///
/// ```text
/// Qᵢ = q + cᵢΔt·v + Δt² Σⱼ aᵢⱼ·a(Qⱼ)
/// q' = q + c·Δt·v + Δt² Σ b̄ᵢ·a(Qᵢ),   v' = v + Δt Σ bᵢ·a(Qᵢ)
/// ```
///
/// Hairer, Nørsett, Wanner: Solving Ordinary Differential Equations I, 2nd ed., §II.14.
#[derive(Clone, Debug, PartialEq)]
pub struct Tableau {
    /// `cᵢ`, one for each evaluation of the force.
    pub c: Vec<Ratio>,
    /// `aᵢⱼ` with `j < i`.
    pub a: Vec<Vec<Ratio>>,
    /// The weights of forces in the velocity at which a force is evaluated, with `j < i`.
    pub a_velocity: Vec<Vec<Ratio>>,
    /// `b̄ᵢ`.
    pub b_position: Vec<Ratio>,
    /// `bᵢ`.
    pub b: Vec<Ratio>,
    /// `c`, one up to the rounding of weights.
    pub time: Ratio,
}

/// A [`Tableau`] of the sizes of coefficients.
pub(crate) struct SizesOfTableau {
    pub(crate) c: Vec<f64>,
    pub(crate) a: Vec<Vec<f64>>,
    pub(crate) b_position: Vec<f64>,
    pub(crate) b: Vec<f64>,
}

/// A factor of a splitting method, in the order of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Letter {
    /// `v += w·Δt·a(q)`.
    Kick(Ratio),
    /// `q += w·Δt·v`.
    Drift(Ratio),
}

/// A sum of symbols: positions, velocities and 37 forces.
type Symbol = Poly<40>;

/// Powers of the unknown stand for symbols: `q`, `v`, then the forces in turn. With `Δt = 1` a step
/// only multiplies symbols by constants, so they never mix.
const POSITION: usize = 1;
const VELOCITY: usize = 2;
const FIRST_FORCE: usize = 3;

/// A system whose force is a new symbol at each evaluation.
struct Symbols {
    arguments: RefCell<Vec<State<Symbol, 1>>>,
}

impl System<Symbol, 1> for Symbols {
    fn acceleration(&self, state: &State<Symbol, 1>) -> [Symbol; 1] {
        let mut arguments = self.arguments.borrow_mut();
        arguments.push(*state);
        [symbol(FIRST_FORCE + arguments.len() - 1)]
    }
}

fn symbol(k: usize) -> Symbol {
    Symbol::monomial(Ratio::ONE, k)
}

impl Tableau {
    /// The tableau of `integrator`; none if it evaluates the force more than 37 times a step.
    pub fn new(integrator: impl Integrator) -> Option<Self> {
        let symbols = Symbols { arguments: RefCell::default() };
        let start = State { q: [symbol(POSITION)], v: [symbol(VELOCITY)] };
        let State { q: [q], v: [v] } = integrator.step(&symbols, start, Symbol::one());
        let arguments = symbols.arguments.into_inner();
        let forces = |p: &Symbol, n: usize| -> Vec<Ratio> {
            (0..n).map(|j| p.coefficient(FIRST_FORCE + j)).collect()
        };
        let n = arguments.len();
        (q.is_valid() && v.is_valid()).then(|| Tableau {
            c: arguments.iter().map(|at| at.q[0].coefficient(VELOCITY)).collect(),
            a: arguments.iter().enumerate().map(|(i, at)| forces(&at.q[0], i)).collect(),
            a_velocity: arguments.iter().enumerate().map(|(i, at)| forces(&at.v[0], i)).collect(),
            b_position: forces(&q, n),
            b: forces(&v, n),
            time: q.coefficient(VELOCITY),
        })
    }

    /// The tableau with the sizes of the rounded coefficients that it is made of: for a Runge–Kutta method those of its velocities, else its
    /// own.
    pub(crate) fn of_sizes(&self) -> SizesOfTableau {
        let sizes = |all: &[Ratio]| all.iter().map(|x| x.to_f64().abs()).collect::<Vec<_>>();
        let rows = |all: &[Vec<Ratio>]| all.iter().map(|row| sizes(row)).collect::<Vec<_>>();
        let b = sizes(&self.b);
        if !self.is_runge_kutta() {
            let (c, a, b_position) = (sizes(&self.c), rows(&self.a), sizes(&self.b_position));
            return SizesOfTableau { c, a, b_position, b };
        }
        let velocities = rows(&self.a_velocity);
        let moved = |weights: &[f64]| -> Vec<f64> {
            let mut all = vec![0.0; b.len()];
            for (weight, row) in weights.iter().zip(&velocities) {
                all.iter_mut().zip(row).for_each(|(sum, x)| *sum += weight * x);
            }
            all
        };
        SizesOfTableau {
            c: velocities.iter().map(|row| row.iter().sum()).collect(),
            a: velocities.iter().map(|row| moved(row)).collect(),
            b_position: moved(&b),
            b,
        }
    }

    /// Whether it is a Runge–Kutta method: positions move by the velocities of its stages as velocities move by their forces, up to the
    /// rounding of both to `f64`.
    pub fn is_runge_kutta(&self) -> bool {
        let moves_alike = |weights: &[Ratio], c: Ratio, a: &[Ratio]| {
            let sum: f64 = weights.iter().map(|w| w.to_f64()).sum();
            let mut moved = vec![0.0; self.b.len()];
            for (weight, row) in weights.iter().zip(&self.a_velocity) {
                let products = row.iter().map(|a| weight.to_f64() * a.to_f64());
                moved.iter_mut().zip(products).for_each(|(sum, x)| *sum += x);
            }
            let size = 1.0 + weights.iter().map(|w| w.to_f64().abs()).sum::<f64>();
            let near = |x: f64, y: f64| (x - y).abs() <= 64.0 * f64::EPSILON * size * size;
            let a = |j: usize| a.get(j).map_or(0.0, |a| a.to_f64());
            near(sum, c.to_f64()) && moved.iter().enumerate().all(|(j, &x)| near(x, a(j)))
        };
        let mut stages = self.a_velocity.iter().zip(self.c.iter().zip(&self.a));
        stages.all(|(weights, (&c, a))| moves_alike(weights, c, a))
            && moves_alike(&self.b, self.time, &self.b_position)
    }

    /// The word of kicks and drifts that the step is, if it is one: where each force acts for `bᵢ`
    /// of the step at the time `cᵢ`, and whatever follows moves with the velocity it leaves.
    pub fn word(&self) -> Option<Vec<Letter>> {
        let lever = |i: usize, time: Ratio| self.b[i] * (time - self.c[i]);
        let inner = self
            .a
            .iter()
            .enumerate()
            .all(|(i, row)| row.iter().enumerate().all(|(j, &a)| a == lever(j, self.c[i])));
        let outer = (0..self.b.len()).all(|i| self.b_position[i] == lever(i, self.time));
        let mut time = Ratio::ZERO;
        let mut word = Vec::new();
        for (&b, &c) in self.b.iter().zip(&self.c) {
            word.extend([Letter::Drift(c - time), Letter::Kick(b)]);
            time = c;
        }
        word.push(Letter::Drift(self.time - time));
        word.retain(|letter| !letter.weight().is_zero());
        (inner && outer).then_some(word)
    }
}

impl Letter {
    /// The fraction of the step for which it acts.
    pub fn weight(self) -> Ratio {
        match self {
            Letter::Kick(w) | Letter::Drift(w) => w,
        }
    }
}

#[cfg(test)]
mod tests {
    use libration_core::integrator::{
        ExplicitEuler, Rk4, SymplecticEuler, TextbookVerlet, VelocityVerlet,
    };

    use super::*;

    #[test]
    fn verlet_is_kick_drift_kick_however_it_is_written() {
        let half = Letter::Kick(Ratio::new(1, 2));
        let word = Some(vec![half, Letter::Drift(Ratio::ONE), half]);
        assert_eq!(Tableau::new(VelocityVerlet).unwrap().word(), word);
        assert_eq!(Tableau::new(TextbookVerlet).unwrap().word(), word);
    }

    #[test]
    fn only_splitting_methods_are_words() {
        let euler = Tableau::new(SymplecticEuler).unwrap().word().unwrap();
        assert_eq!(euler, [Letter::Kick(Ratio::ONE), Letter::Drift(Ratio::ONE)]);
        assert_eq!(Tableau::new(ExplicitEuler).unwrap().word(), None);
        assert_eq!(Tableau::new(Rk4).unwrap().word(), None);
    }

    #[test]
    fn the_tableau_of_rk4_is_that_of_the_textbook() {
        let rk4 = Tableau::new(Rk4).unwrap();
        let [half, sixth, third] = [(1, 2), (1, 6), (1, 3)].map(|(n, d)| Ratio::new(n, d));
        assert_eq!(rk4.c, [Ratio::ZERO, half, half, Ratio::ONE]);
        assert_eq!(rk4.b, [sixth, third, third, sixth]);
        assert_eq!(rk4.b_position, [sixth, sixth, sixth, Ratio::ZERO]);
        assert_eq!(rk4.a[2], [Ratio::new(1, 4), Ratio::ZERO]);
    }
}
