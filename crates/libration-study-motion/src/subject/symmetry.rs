//! Symplecticity and reversibility of a step along an orbit.

use libration::analysis::Linearisation;
use libration::equations::{Dynamics, StepProgram};
use libration::number::{TwoFloat, Wide};
use libration::system::Oscillator;
use libration::{Float, Method, Scalar};

use super::Problem;
use crate::program_stepper::ProgramStepper;

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
        let dynamics = Dynamics::of::<1>(&Oscillator { omega2: 1.0 }, None);
        let step = StepProgram::of(method, &dynamics);
        let linear = Linearisation::new(&step, &dynamics, &[1.0, 0.0], 0.3);
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
    let (h, dt) = (problem.step::<TwoFloat>(steps), problem.step(steps));
    // Where units differ in size, one entry would drown the powers of the step in all others.
    let omega = Wide::from_f64(problem.omega());
    // Every third sample is enough: no symmetric point of an orbit recurs so.
    let at: Vec<_> = problem.orbit().states().iter().skip(1).step_by(3).collect();
    let mut sums = [0.0_f64; 3];
    for &at in &at {
        let mut rounded: Vec<f64> = at.iter().map(|x| x.to_f64()).collect();
        rounded.resize(at.len() + problem.dynamics.inputs(), 0.0);
        let linear = Linearisation::new(step, &problem.dynamics, &rounded, dt);
        let [there, back] = [&linear.step, &linear.back].map(|map| map.with_velocities_in(omega));
        let mut stepper = ProgramStepper::new(step, &problem.dynamics, at);
        stepper.step(h);
        let returned = stepper.step(-h);
        let missed: Vec<f64> = returned.iter().zip(at).map(|(&a, &b)| (a - b).to_f64()).collect();
        let own: Vec<f64> = at.iter().map(|x| x.to_f64()).collect();
        let defects = [
            there.symplecticity_defect().to_f64(),
            back.after(&there).distance_from_identity().to_f64(),
            size(problem, &missed) / size(problem, &own),
        ];
        // A defect of 10⁻³⁰⁰ has no square.
        sums.iter_mut().zip(defects).for_each(|(sum, x)| *sum = sum.hypot(x));
    }
    let [symplecticity, reversibility, return_error] =
        sums.map(|sum| sum / (at.len() as f64).sqrt());
    Symmetry { symplecticity, reversibility, return_error }
}

/// The length of a state, velocities in units of `2π/turn`.
fn size(problem: &Problem, state: &[f64]) -> f64 {
    let length = |x: &[f64]| x.iter().fold(0.0_f64, |sum, x| sum.hypot(*x));
    let (q, v) = state.split_at(problem.degrees());
    length(q).hypot(length(v) / problem.omega())
}
