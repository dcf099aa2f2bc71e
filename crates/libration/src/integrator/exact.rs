//! Steps of a linear system without error.

use super::Integrator;
use crate::{Model, Scalar, State, System};

/// The flow of a linear system, also under a command that is held: the exact sampled-data step.
///
/// Its Taylor series, with as many terms as `f64` can tell, over as many equal parts of the step as it converges well
/// in. A constant in the acceleration, such as a command, is in the series too, so that loops under zero-order hold
/// move without error over whole steps and over parts of them. What is left is rounding, of some units in the last place
/// for each part; steps of other lengths, as jitter makes them, may be five times as long as those it was made for.
///
/// Of a system that is not linear this is no method of any order.
///
/// C. Moler, C. Van Loan: Nineteen Dubious Ways to Compute the Exponential of a Matrix, Twenty-Five Years Later, SIAM
/// Review 45, 2003, methods 1 and 3.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Exact {
    parts: i32,
}

/// Terms of the series: where a part is an angle of ½ the first that is left out is 2·10⁻³³ of the state, and 6·10⁻¹⁶
/// where it is five times as long.
const TERMS: i32 = 24;

/// The angle in radians, or the logarithm of a decay, that a part may span.
const PART: f64 = 0.5;

/// Times that the generator is applied to find how fast it is: enough that no scale of positions against velocities
/// matters.
const POWERS: u32 = 64;

impl Exact {
    /// Name on the command line.
    pub const NAME: &'static str = "exact";

    /// What it is, in a line.
    pub const SUMMARY: &'static str =
        "Steps of a linear system without error, also under a held command";

    /// The most radians, or powers of e, by which a step may turn or shrink the state.
    pub const MOST_ANGLE: f64 = 32_768.0;

    /// Exact steps of about `dt` seconds; none of a system that is not [linear](Model::LINEAR), nor where a step goes
    /// further than [`Exact::MOST_ANGLE`].
    pub fn new<const D: usize>(model: impl Model<D>, dt: f64) -> Option<Self> {
        let angle = Self::angle(model, dt)?;
        let parts = (angle / PART).ceil().max(1.0);
        (angle <= Self::MOST_ANGLE).then_some(Exact { parts: parts as i32 })
    }

    /// By how many radians, or powers of e, a step of `dt` seconds turns or shrinks the state, or by some per cent less;
    /// none of a system that is not [linear](Model::LINEAR).
    pub fn angle<const D: usize>(model: impl Model<D>, dt: f64) -> Option<f64> {
        Some(rate(model)? * dt.abs())
    }
}

/// The largest absolute eigenvalue of the generator, in 1/s, by its powers: too large by some per cent.
fn rate<const D: usize, M: Model<D>>(model: M) -> Option<f64> {
    if !M::LINEAR {
        return None;
    }
    let system = model.on::<f64>();
    let unit = |i: usize| State {
        q: core::array::from_fn(|j| f64::from(u8::from(i == j))),
        v: core::array::from_fn(|j| f64::from(u8::from(i == j + D))),
    };
    let growth = |mut state: State<f64, D>| {
        let mut logarithm = 0.0;
        for _ in 0..POWERS {
            state = system.rate(state);
            let size = state.coordinates().fold(0.0, |size: f64, x| size.max(x.abs()));
            if size == 0.0 {
                return f64::NEG_INFINITY;
            }
            logarithm += size.ln();
            state = state.map(|x| x / size);
        }
        logarithm
    };
    let largest = (0..2 * D).map(|i| growth(unit(i))).fold(f64::NEG_INFINITY, f64::max);
    Some((largest / f64::from(POWERS)).exp())
}

impl Integrator for Exact {
    const REGISTERS: usize = 16;

    #[inline(always)]
    fn step<S: Scalar, const D: usize>(
        self,
        system: &impl System<S, D>,
        state: State<S, D>,
        dt: S,
    ) -> State<S, D> {
        let part = dt.ratio(1, self.parts);
        let constant = system.acceleration(&State::origin());
        let mut state = state;
        for _ in 0..self.parts {
            let first = system.rate(state);
            // Σ (h^(k−1)/k!) L^(k−1) of the rate, from the last term on; L is the rate without its constant.
            let mut sum = first;
            for k in (2..=TERMS).rev() {
                let mut rate = system.rate(sum);
                for (rate, constant) in rate.v.iter_mut().zip(constant) {
                    *rate = *rate - constant;
                }
                sum = first.plus(part.ratio(1, k), rate);
            }
            state = state.plus(part, sum);
        }
        state
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::HeldStep;
    use crate::number::Wide;
    use crate::system::{DampedOscillator, Held, HenonHeiles, Oscillator};

    /// Of a step under a command, against the exponential of its matrix in 1024 bits.
    fn error(model: impl Model<1>, dt: f64) -> f64 {
        let exact = HeldStep::exact(model, &State::origin(), Wide::from_f64(dt));
        let (start, command) = (State { q: [0.7], v: [-1.3] }, 2.5);
        let held = Held { system: model.on::<f64>(), command: [command] };
        let found = Exact::new(model, dt).unwrap().step(&held, start, dt);
        let moved = exact.phi.apply(&start.map(Wide::from_f64));
        let wanted = moved.plus(Wide::from_f64(command), exact.gamma).map(|x| x.to_f64());
        let size = wanted.coordinates().fold(0.0, |size: f64, x| size.max(x.abs()));
        let off = found.coordinates().zip(wanted.coordinates()).map(|(a, b)| (a - b).abs());
        off.fold(0.0, f64::max) / size
    }

    #[test]
    fn a_step_under_a_command_is_that_of_the_matrix_exponential() {
        for dt in [1e-6, 1e-3, 0.1, 0.4, 3.0, 50.0] {
            for omega2 in [0.0_f64, 1e-4, 10.0, 400.0] {
                // Each part rounds by a few units, all of them to one side at worst.
                let parts = 1.0 + 2.0 * dt * omega2.sqrt() / PART;
                let bound = 8.0 * f64::EPSILON * parts;
                let oscillator = error(Oscillator { omega2 }, dt);
                assert!(oscillator < bound, "ω² = {omega2}, Δt = {dt}: {oscillator:e}");
                if omega2 * dt <= 100.0 {
                    let damped = error(DampedOscillator { omega2, gamma: 0.3 }, dt);
                    assert!(damped < bound, "damped, ω² = {omega2}, Δt = {dt}: {damped:e}");
                }
            }
        }
    }

    #[test]
    fn a_step_five_times_as_long_as_foreseen_is_still_exact() {
        let (model, dt) = (Oscillator { omega2: 10.0 }, 0.1);
        let start = State { q: [1.0], v: [0.0] };
        let step = Exact::new::<1>(model, dt).unwrap().step(&model, start, 5.0 * dt);
        let turn = 10.0_f64.sqrt() * 5.0 * dt;
        assert!((step.q[0] - turn.cos()).abs() < 4.0 * f64::EPSILON);
    }

    #[test]
    fn a_nonlinear_system_and_a_step_that_is_far_too_long_have_none() {
        assert_eq!(Exact::new::<2>(HenonHeiles { lambda: 1.0 }, 0.1), None);
        assert_eq!(Exact::new::<1>(Oscillator { omega2: 1.0 }, 4e4), None);
    }
}
