//! Symplecticity and reversibility of a step along an orbit.

use libration::analysis::Linearisation;
use libration::equations::StepProgram;
use libration::number::{Dual, TwoFloat, Wide};
use libration::system::Oscillator;
use libration::{Elementary, Float, Method, Scalar, State};

use super::Problem;
use libration_analyze::program_stepper::ProgramStepper;

/// Defects of this size are rounding: 1024 bits carry a step to 2⁻¹⁰²⁰, and their products and
/// sums to far below 2⁻⁹⁰⁰.
pub(crate) const ROUNDING: f64 = 1.2e-271;

/// How far a step is from keeping areas and from being undone by its reverse, with velocities in
/// units of `2π/turn`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Symmetry {
    /// `‖MᵀJM − J‖` of the Jacobian `M` of the step.
    pub symplecticity: f64,
    /// `‖M(−Δt)·M(Δt) − 1‖` of the Jacobians.
    pub reversibility: f64,
    /// `|Φ(−Δt)∘Φ(Δt)(y) − y|` in double-double, relative to the length of `y`.
    pub return_error: f64,
}

impl Symmetry {
    /// Which of the defects vanish for `method`, read off its step on the oscillator: symplectic,
    /// and reversible. What holds there for every ω holds for every force that depends on
    /// position alone, since the step is the same word of kicks and drifts.
    pub(crate) fn of_method(method: Method) -> (bool, bool) {
        let oscillator = Oscillator { omega2: 1.0 };
        let anywhere = State { q: [1.0], v: [0.0] };
        let linear = Linearisation::new(method, oscillator, &anywhere, 0.3);
        let vanishes = |defect: f64| defect < ROUNDING;
        (
            vanishes(linear.step.symplecticity_defect().to_f64()),
            vanishes(linear.reversibility_defect().to_f64()),
        )
    }
}

/// The root of the mean square of each defect along the orbit.
pub(super) fn measure(problem: &Problem, method: Method, steps: u64) -> Symmetry {
    let step = &*problem.step_program(method);
    let (h, dt) = (problem.step::<TwoFloat>(steps), Wide::from_f64(problem.step(steps)));
    // Every third sample is enough: no symmetric point of an orbit recurs so.
    let at: Vec<_> = problem.orbit().states().iter().skip(1).step_by(3).collect();
    let mut sums = [0.0_f64; 3];
    for &at in &at {
        let rounded: Vec<Wide> = at.iter().map(|x| Wide::from_f64(x.to_f64())).collect();
        let mut stepper = ProgramStepper::new(step, &problem.dynamics, &rounded);
        let end = stepper.step(dt).to_vec();
        let there = StepJacobian::new(problem, step, &rounded, dt);
        let back = StepJacobian::new(problem, step, &end, -dt);
        let mut stepper = ProgramStepper::new(step, &problem.dynamics, at);
        stepper.step(h);
        let returned = stepper.step(-h);
        let missed: Vec<f64> = returned.iter().zip(at).map(|(&a, &b)| (a - b).to_f64()).collect();
        let own: Vec<f64> = at.iter().map(|x| x.to_f64()).collect();
        let defects = [
            there.symplecticity_defect(),
            back.distance_from_inverse(&there),
            size(problem, &missed) / size(problem, &own),
        ];
        // A defect of 10⁻³⁰⁰ has no square.
        sums.iter_mut().zip(defects).for_each(|(sum, x)| *sum = sum.hypot(x));
    }
    let [symplecticity, reversibility, return_error] =
        sums.map(|sum| sum / (at.len() as f64).sqrt());
    Symmetry { symplecticity, reversibility, return_error }
}

/// The Jacobian of a step in 1024 bits, with velocities in units of `2π/turn`: where units differ in size, one entry would
/// drown the powers of the step in all others.
struct StepJacobian {
    /// The derivatives of positions and velocities by each of them.
    columns: Vec<Vec<Wide>>,
}

impl StepJacobian {
    fn new(problem: &Problem, step: &StepProgram, at: &[Wide], dt: Wide) -> Self {
        let degrees = problem.degrees();
        let omega = Wide::from_f64(problem.omega());
        let unit = |i: usize| if i < degrees { Wide::one() } else { omega };
        let inverses: Vec<Wide> = (0..at.len()).map(|i| unit(i).recip()).collect();
        let column = |j: usize| {
            let seeded = |(i, &re): (usize, &Wide)| Dual {
                re,
                du: if i == j { unit(j) } else { Wide::zero() },
            };
            let start: Vec<Dual<Wide>> = at.iter().enumerate().map(seeded).collect();
            let mut stepper = ProgramStepper::new(step, &problem.dynamics, &start);
            let end = stepper.step(Dual::constant(dt));
            end.iter().zip(&inverses).map(|(x, &inverse)| x.du * inverse).collect()
        };
        StepJacobian { columns: (0..at.len()).map(column).collect() }
    }

    /// The Frobenius norm of `MᵀJM − J`, whose entries are the symplectic forms of pairs of columns.
    fn symplecticity_defect(&self) -> f64 {
        let degrees = self.columns.len() / 2;
        let form = |a: &[Wide], b: &[Wide]| {
            (0..degrees)
                .fold(Wide::zero(), |sum, i| sum + (a[i] * b[degrees + i] - a[degrees + i] * b[i]))
        };
        let canonical = |i: usize, j: usize| match (i + degrees == j, j + degrees == i) {
            (true, _) => Wide::one(),
            (_, true) => -Wide::one(),
            _ => Wide::zero(),
        };
        self.norm(|i, j| form(&self.columns[i], &self.columns[j]) - canonical(i, j))
    }

    /// The Frobenius norm of this matrix times another, less the identity.
    fn distance_from_inverse(&self, other: &StepJacobian) -> f64 {
        let identity = |i: usize, j: usize| if i == j { Wide::one() } else { Wide::zero() };
        let product = |i: usize, j: usize| {
            let terms = self.columns.iter().zip(&other.columns[j]);
            terms.fold(Wide::zero(), |sum, (column, &x)| sum + column[i] * x)
        };
        self.norm(|i, j| product(i, j) - identity(i, j))
    }

    /// The Frobenius norm of a matrix of this size.
    fn norm(&self, entry: impl Fn(usize, usize) -> Wide) -> f64 {
        let n = self.columns.len();
        let entries = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
        let sum = entries.fold(Wide::zero(), |sum, (i, j)| {
            let entry = entry(i, j);
            sum + entry * entry
        });
        sum.sqrt().to_f64()
    }
}

/// The length of a state, velocities in units of `2π/turn`.
fn size(problem: &Problem, state: &[f64]) -> f64 {
    let length = |x: &[f64]| x.iter().fold(0.0_f64, |sum, x| sum.hypot(*x));
    let (q, v) = state.split_at(problem.degrees());
    length(q).hypot(length(v) / problem.omega())
}
