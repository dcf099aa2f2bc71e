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
