//! Clock skew: loss of phase coherence of an ensemble.

use libration_core::control::Jitter;
use libration_core::number::Wide;
use libration_core::{Elementary, Scalar, State};
use libration_linear::Averages;

use super::Plant;

impl Plant<'_> {
    /// After how many steps the mean over an ensemble, whose time steps are `Δt(1 + δ)` with one `δ` after `law` for
    /// each trajectory, has fallen to 1/e. None where nothing oscillates, or where all steps are alike.
    ///
    /// A trajectory is ahead by the angle `n·θ'·δ` after `n` steps, where `θ' = Δt·dθ/dΔt` with the angle `θ` of a step;
    /// the mean is the characteristic function of the law at `n·θ'`.
    pub fn dephasing_steps(&self, law: Jitter) -> Option<Wide> {
        // A difference over 2⁻³⁰⁰ of a step has 300 good bits and more.
        let off = Wide::one().scaled(-300);
        let later = self.angle(self.dt * (Wide::one() + off))?;
        let slope = ((later - self.angle(self.dt)?) / off).abs();
        let (rms, at) = match law {
            Jitter::Gaussian(rms) => (rms, Wide::from_f64(2.0).sqrt()),
            Jitter::Uniform(rms) => (rms, sinc_root() / Wide::from_f64(3.0).sqrt()),
        };
        let speed = slope * Wide::from_f64(rms);
        (!speed.is_zero()).then(|| at / speed)
    }

    /// The mean over such an ensemble, all of it from `state`, after so many steps: right as long as no two trajectories that are a
    /// deviation apart are out of phase by more than 4096 rad. A rate below zero is zero.
    pub fn asynchronous_mean(
        &self,
        state: &State<f64, 1>,
        law: Jitter,
        steps: u64,
    ) -> State<f64, 1> {
        let start = state.map(Wide::from_f64);
        let sum = law.nodes(steps as f64 * self.turn(law)).into_iter().fold(
            State::origin(),
            |sum, (weight, delta)| {
                let dt = self.dt * (Wide::one() + Wide::from_f64(delta));
                let mut moved = start;
                let (mut power, mut left) = ((self.step)(dt).phi, steps);
                while left > 0 {
                    if left % 2 == 1 {
                        moved = power.apply(&moved);
                    }
                    power = power.after(&power);
                    left /= 2;
                }
                sum.plus(Wide::from_f64(weight), moved)
            },
        );
        sum.map(Wide::to_f64)
    }

    /// By how many radians a step turns the further, where its length is a standard deviation of `law` more.
    pub(super) fn turn(&self, law: Jitter) -> f64 {
        // Of the plant alone: the integrator's own is nearly that, and what damps only makes it less.
        let rate = self.generator.determinant().abs().sqrt();
        (rate * self.dt).to_f64() * law.rms()
    }

    /// The angle by which a step of `dt` seconds turns, if it turns.
    fn angle(&self, dt: Wide) -> Option<Wide> {
        let phi = (self.step)(dt).phi;
        let half = phi.trace().scaled(-1);
        let rest = phi.determinant() - half * half;
        (!rest.is_negative() && !rest.is_zero()).then(|| rest.sqrt().atan2(half))
    }
}

/// The first `x` with `sin x = x/e`.
fn sinc_root() -> Wide {
    let share = Wide::one().exp().recip();
    let mut x = Wide::from_f64(2.199);
    // Newton's iteration, from eleven good bits on.
    for _ in 0..8 {
        let (sine, cosine) = x.sin_cos();
        x = x - (sine - share * x) / (cosine - share);
    }
    x
}
