//! Exact steps of a linear system.

use super::Integrator;
use crate::{Model, Scalar, State, System};

/// The flow of a linear system, also under a held command: the exact sampled-data step.
///
/// Its Taylor series, with as many terms as `f64` can tell, over as many equal parts of the step as it converges well
/// in. A constant in the acceleration, such as a command, is in the series too, so that loops under zero-order hold
/// move without error over whole steps and over parts of them. What is left is rounding, of some units in the last place
/// for each part; steps of other lengths, as jitter makes them, may be five times as long as those it was made for.
///
/// For a system that is not linear it has no order.
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

    /// A description in one line.
    pub const SUMMARY: &'static str =
        "Steps of a linear system without error, also under a held command";

    /// The most radians, or powers of e, by which a step may turn or shrink the state.
    pub const MOST_ANGLE: f64 = 32_768.0;

    /// Exact steps of about `dt` seconds; none of a system that is not [linear](Model::LINEAR), nor where a step goes
    /// further than [`Exact::MOST_ANGLE`].
    pub fn new<const D: usize>(model: impl Model<D>, dt: f64) -> Option<Self> {
        Exact::of_angle(Self::angle(model, dt)?)
    }

    /// Exact steps that turn or shrink the state by so many radians or powers of e; none beyond [`Exact::MOST_ANGLE`].
    pub fn of_angle(angle: f64) -> Option<Self> {
        let parts = (angle / PART).ceil().max(1.0);
        (angle <= Self::MOST_ANGLE).then_some(Exact { parts: parts as i32 })
    }

    /// By how many radians, or powers of e, a step of `dt` seconds turns or shrinks the state, or by some per cent less;
    /// none of a system that is not [linear](Model::LINEAR).
    pub fn angle<const D: usize>(model: impl Model<D>, dt: f64) -> Option<f64> {
        fn rate_of<const D: usize, M: Model<D>>(model: M) -> Option<f64> {
            let system = model.on::<f64>();
            let rate = |state: &[f64]| {
                let state = State {
                    q: core::array::from_fn::<_, D, _>(|i| state[i]),
                    v: core::array::from_fn(|i| state[D + i]),
                };
                system.rate(state).coordinates().collect()
            };
            M::LINEAR.then(|| Exact::fastest(2 * D, rate))
        }
        Some(rate_of(model)? * dt.abs())
    }

    /// The largest absolute eigenvalue of the rate of so many positions and velocities, which must be linear, in 1/s, by powers: too large
    /// by some per cent.
    pub fn fastest(states: usize, mut rate: impl FnMut(&[f64]) -> Vec<f64>) -> f64 {
        let mut growth = |i: usize| {
            let mut state: Vec<f64> = (0..states).map(|j| f64::from(u8::from(i == j))).collect();
            let mut logarithm = 0.0;
            for _ in 0..POWERS {
                state = rate(&state);
                let size = state.iter().fold(0.0, |size: f64, x| size.max(x.abs()));
                if size == 0.0 {
                    return f64::NEG_INFINITY;
                }
                logarithm += size.ln();
                state.iter_mut().for_each(|x| *x /= size);
            }
            logarithm
        };
        let largest = (0..states).map(&mut growth).fold(f64::NEG_INFINITY, f64::max);
        (largest / f64::from(POWERS)).exp()
    }

    /// The step of a part of this step, and how many parts it has.
    pub fn parts(self) -> (Exact, i32) {
        (Exact { parts: 1 }, self.parts)
    }
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
                for (rate, constant) in rate.v.iter_mut().zip(&constant) {
                    *rate = *rate - *constant;
                }
                sum = first.plus(part.ratio(1, k), rate);
            }
            state = state.plus(part, sum);
        }
        state
    }
}
