//! The symmetries of a step along an orbit: areas, and time.

use libration::analysis::Linearisation;
use libration::number::TwoFloat;
use libration::system::Oscillator;
use libration::{Float, Method, Model, Scalar, State, with_method};

use super::Problem;

/// Defects of this size are rounding: 1024 bits carry a step to 2⁻¹⁰²⁰, and their products and
/// sums to far below 2⁻⁹⁰⁰.
pub(crate) const ROUNDING: f64 = 1.2e-271;

/// How far a step is from keeping areas and from being undone by its reverse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Symmetry {
    /// `‖MᵀJM − J‖` of the Jacobian `M` of the step.
    pub symplecticity: f64,
    /// `‖M(−Δt)·M(Δt) − 1‖` of the Jacobians.
    pub reversibility: f64,
    /// `|Φ(−Δt)∘Φ(Δt)(y) − y|` in double-double, relative to the largest coordinate of `y`.
    pub return_error: f64,
}

impl Symmetry {
    /// Which of the defects vanish for `method`, read off its step on the oscillator: symplectic,
    /// and reversible. What holds there for every ω holds for every force that depends on
    /// position alone, since the step is the same word of kicks and drifts.
    pub(crate) fn of_method(method: Method) -> (bool, bool) {
        let oscillator = Oscillator { omega2: 1.0 };
        let anywhere = State { q: [1.0], v: [0.0] };
        let linear = with_method!(method, |m| Linearisation::new(m, oscillator, &anywhere, 0.3));
        let vanishes = |defect: f64| defect < ROUNDING;
        (
            vanishes(linear.step.symplecticity_defect().to_f64()),
            vanishes(linear.reversibility_defect().to_f64()),
        )
    }
}

/// The root of the mean square of each defect along the orbit.
pub(super) fn measure<M: Model<D>, const D: usize>(
    problem: &Problem<M, D>,
    method: Method,
    steps: u64,
) -> Symmetry {
    let dt = problem.step::<f64>(steps);
    let system = problem.model.on::<TwoFloat>();
    let h = TwoFloat::from_f64(dt);
    // Every third sample is enough: no symmetric point of an orbit recurs so.
    let at: Vec<_> = problem.orbit().states().iter().skip(1).step_by(3).collect();
    let mut sums = [0.0_f64; 3];
    for &&at in &at {
        let rounded = at.map(Float::to_f64);
        let defects = with_method!(method, |m| {
            let linear = Linearisation::new(m, problem.model, &rounded, dt);
            let there = libration::Integrator::step(m, &system, at, h);
            let back = libration::Integrator::step(m, &system, there, -h);
            let missed = back.plus(-TwoFloat::one(), at);
            let missed: f64 = missed.coordinates().map(|x| x.to_f64().powi(2)).sum();
            [
                linear.step.symplecticity_defect().to_f64(),
                linear.reversibility_defect().to_f64(),
                missed.sqrt() / super::flow::size(&at),
            ]
        });
        // A defect of 10⁻³⁰⁰ has no square.
        sums.iter_mut().zip(defects).for_each(|(sum, x)| *sum = sum.hypot(x));
    }
    let [symplecticity, reversibility, return_error] =
        sums.map(|sum| sum / (at.len() as f64).sqrt());
    Symmetry { symplecticity, reversibility, return_error }
}
