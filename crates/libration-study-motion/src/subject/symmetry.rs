//! Symplecticity and reversibility of a step along an orbit.

use libration::analysis::{Linearisation, UpdateMatrix};
use libration::number::{TwoFloat, Wide};
use libration::system::Oscillator;
use libration::{Elementary, Float, Integrator, Method, Model, Scalar, State};

use super::Problem;

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
pub(super) fn measure<M: Model<D>, const D: usize>(
    problem: &Problem<M, D>,
    method: Method,
    steps: u64,
) -> Symmetry {
    let dt = problem.step::<f64>(steps);
    let system = problem.model.on::<TwoFloat>();
    let (h, one) = (TwoFloat::from_f64(dt), TwoFloat::one());
    let omega = std::f64::consts::TAU / problem.turn;
    // Every third sample is enough: no symmetric point of an orbit recurs so.
    let at: Vec<_> = problem.orbit().states().iter().skip(1).step_by(3).collect();
    let mut sums = [0.0_f64; 3];
    for &&at in &at {
        let rounded = at.map(Float::to_f64);
        let linear = Linearisation::new(method, problem.model, &rounded, dt);
        let (step, back) = (in_turns(&linear.step, omega), in_turns(&linear.back, omega));
        let there = method.step(&system, at, h);
        let missed = method.step(&system, there, -h).plus(-one, at);
        let defects = [
            step.symplecticity_defect().to_f64(),
            back.after(&step).distance_from_identity().to_f64(),
            size(&missed, omega) / size(&at, omega),
        ];
        // A defect of 10⁻³⁰⁰ has no square.
        sums.iter_mut().zip(defects).for_each(|(sum, x)| *sum = sum.hypot(x));
    }
    let [symplecticity, reversibility, return_error] =
        sums.map(|sum| sum / (at.len() as f64).sqrt());
    Symmetry { symplecticity, reversibility, return_error }
}

/// The matrix with velocities in units of `omega`: where units differ in size, one entry would
/// drown the powers of the step in all others.
fn in_turns<const D: usize>(m: &UpdateMatrix<Wide, D>, omega: f64) -> UpdateMatrix<Wide, D> {
    let (omega, inverse) = (Wide::from_f64(omega), Wide::from_f64(omega).recip());
    UpdateMatrix::from_map(|e| {
        let image = m.apply(&State { q: e.q, v: e.v.map(|v| v * omega) });
        State { q: image.q, v: image.v.map(|v| v * inverse) }
    })
}

/// The length of a state, velocities in units of `omega`.
fn size<const D: usize>(state: &State<TwoFloat, D>, omega: f64) -> f64 {
    let length = |x: [TwoFloat; D]| x.iter().fold(0.0_f64, |sum, x| sum.hypot(x.to_f64()));
    length(state.q).hypot(length(state.v) / omega)
}
