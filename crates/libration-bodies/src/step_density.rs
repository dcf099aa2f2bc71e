//! The density of steps of bodies whose steps follow their encounters.

use super::bodies::Bodies;
use super::direct_sum::axes;

/// Steps are as long as `dt·ω₀/ω`, where `ω² = Σ G(mᵢ + mⱼ)/rᵢⱼ³` is the sum of the squared frequencies of all pairs and `ω₀` that of the
/// start. The density `ω/ω₀` follows an equation of motion of its own, so that a step back undoes a step: E. Hairer, G. Söderlind, *SIAM
/// Journal on Scientific Computing* 26, 2005.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StepDensity {
    /// Half a step before the state.
    value: f64,
    dt: f64,
}

impl StepDensity {
    /// At the start. None if no pair attracts.
    pub(crate) fn new(bodies: &Bodies, dt: f64) -> Option<Self> {
        let rate = rate(bodies, bodies.positions(), bodies.velocities())?;
        Some(StepDensity { value: 1.0 - 0.5 * dt * rate, dt })
    }

    /// The length of the next step. None if the density is not positive: the steps are too long.
    pub(crate) fn next_length(
        &mut self,
        bodies: &Bodies,
        positions: &[f64],
        velocities: &[f64],
    ) -> Option<f64> {
        self.value += self.dt * rate(bodies, positions, velocities)?;
        (self.value > 0.0).then(|| self.dt / self.value)
    }
}

/// The rate of change of the logarithm of `ω` along the motion.
fn rate(bodies: &Bodies, positions: &[f64], velocities: &[f64]) -> Option<f64> {
    let (q, v, gm) = (axes(positions), axes(velocities), bodies.strengths());
    let softening = bodies.softening_length() * bodies.softening_length();
    let (mut sum, mut change) = (0.0, 0.0);
    for j in 1..gm.len() {
        for i in 0..j {
            let (mut square, mut product) = (softening, 0.0);
            for axis in 0..3 {
                let offset = q[axis][j] - q[axis][i];
                square += offset * offset;
                product += offset * (v[axis][j] - v[axis][i]);
            }
            let frequency = (gm[i] + gm[j]) / (square * square.sqrt());
            sum += frequency;
            change -= 3.0 * frequency * product / square;
        }
    }
    let rate = 0.5 * change / sum;
    rate.is_finite().then_some(rate)
}
