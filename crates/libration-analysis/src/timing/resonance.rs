//! Correlated step times and parametric resonance.

use core::f64::consts::SQRT_2;

use libration_core::control::Feedback;
use libration_core::number::Wide;
use libration_core::{Elementary, Scalar};

use super::Plant;
use crate::{Spectrum, UpdateMatrix};

/// Step times `Δt(1 + ε)` whose `ε` remembers the one before: `εₙ₊₁ = φ·εₙ + √(1 − φ²)·ξₙ` with white noise `ξ`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepNoise {
    rms: f64,
    memory: f64,
}

impl StepNoise {
    /// Without memory, of this standard deviation.
    pub fn white(rms: f64) -> Self {
        StepNoise { rms, memory: 0.0 }
    }

    /// Of this standard deviation and with this `φ`, the correlation of one `ε` with the next; none unless that is
    /// between −1 and 1, and the deviation a number of at least 0.
    pub fn autoregressive(rms: f64, memory: f64) -> Option<Self> {
        (memory.abs() < 1.0 && rms >= 0.0 && rms.is_finite()).then_some(StepNoise { rms, memory })
    }

    /// The power spectrum `Σₖ E[εₙεₙ₊ₖ]·cos kψ` at `ψ` radians per step; its mean over all angles is the variance.
    pub fn spectrum(self, angle: f64) -> f64 {
        let StepNoise { rms, memory } = self;
        rms * rms * (1.0 - memory * memory) / (1.0 - 2.0 * memory * angle.cos() + memory * memory)
    }
}

/// The response of a rotating step to a change of its length.
#[derive(Clone, Copy, Debug)]
pub struct Resonance {
    /// The angle `θ` of the mean step, in `(0, π)` rad.
    pub angle: Wide,
    /// `a`: a step longer by the share `ε` changes `ln |y|` by up to `a·ε`, with the sine of twice the angle of the
    /// state, beside what it changes of areas.
    pub coupling: Wide,
    /// The growth of `ln |y|` in a step of mean length.
    pub rate: Wide,
    /// The second derivative of `½·ln det M` with respect to `ε`.
    pub bend: Wide,
}

/// The share of a step over which differences are taken, as a power of two: what is left out is its square.
const OFF: i64 = -300;

impl Plant<'_> {
    /// How the loop that `feedback` closes at once takes to changes of its step times. None where the step of mean
    /// length does not turn the state.
    pub fn resonance(&self, feedback: Feedback) -> Option<Resonance> {
        let off = Wide::one().scaled(OFF);
        let at = |epsilon: Wide| self.closed(feedback, self.dt * (Wide::one() + epsilon));
        let [short, mean, long] = [-off, Wide::ZERO, off].map(at);
        let spectrum = Spectrum::new(&mean);
        let sine = (spectrum.determinant - (mean.trace() * mean.trace()).scaled(-2)).sqrt();
        // The root has no value where the eigenvalues are real.
        if sine.is_nan() || sine.is_zero() {
            return None;
        }
        let slope = divided(&long.plus(-Wide::one(), &short), off.scaled(1));
        // M = r·cos θ + r·sin θ·J with J² = −1. In coordinates in which J is a quarter turn, a part of the slope commutes
        // with it, and has the determinant x² + y²; the rest, a reflection, has −(a·r)².
        let half = mean.trace().scaled(-1);
        let turn = divided(&mean.plus(-half, &UpdateMatrix::identity()), sine);
        let (x, y) = (slope.trace().scaled(-1), slope.after(&turn).trace().scaled(-1));
        let reflected = (x * x + y * y - slope.determinant()) / spectrum.determinant;
        let [before, now, after] = [short, mean, long].map(|m| m.determinant().ln().scaled(-1));
        Some(Resonance {
            angle: spectrum.angle(),
            // What vanishes may come out below zero.
            coupling: if reflected.is_negative() { Wide::ZERO } else { reflected.sqrt() },
            rate: now,
            bend: (before + after - now.scaled(1)) / (off * off),
        })
    }
}

impl Resonance {
    /// The Lyapunov exponent per step under weak noise: but for the fourth power of its standard deviation `σ`,
    /// `½·E[ln det M] + ½·a²·S(2θ)` with the spectrum `S` of the noise. Of noise, that is, counts what has twice the
    /// angle of a step. Noise that is slow and strong also blurs the phase of the state, and widens the resonance: the
    /// formula is for `σ` far below `θ·(1 − |φ|)`.
    ///
    /// After L. Arnold, G. Papanicolaou, V. Wihstutz, *Asymptotic analysis of the Lyapunov exponent and rotation number
    /// of the random oscillator and applications*, SIAM Journal on Applied Mathematics 46, 1986, there in continuous
    /// time.
    pub fn weak_growth(&self, noise: StepNoise) -> f64 {
        let [coupling, angle] = [self.coupling, self.angle].map(Wide::to_f64);
        self.mean_rate(noise.rms) + 0.5 * coupling * coupling * noise.spectrum(2.0 * angle)
    }

    /// The growth of `ln |y|` in a step under `εₙ = √2·σ·cos(2θn + φ)` with `σ = rms`, parametric resonance: but for
    /// the third power of `σ`, `½·E[ln det M] + a·σ/√2`.
    ///
    /// At a quarter turn a step, `θ = π/2`, such noise but changes its sign, and the phase `φ` counts.
    pub fn resonance_growth(&self, rms: f64) -> f64 {
        self.mean_rate(rms) + self.coupling.to_f64() * rms / SQRT_2
    }

    /// `½·E[ln det M]`, to the second power of `rms`.
    fn mean_rate(&self, rms: f64) -> f64 {
        self.rate.to_f64() + 0.5 * self.bend.to_f64() * rms * rms
    }
}

fn divided(matrix: &UpdateMatrix<Wide>, by: Wide) -> UpdateMatrix<Wide> {
    matrix.map(|x| x / by)
}

#[cfg(test)]
mod tests {
    use libration_core::control::Jitter;
    use libration_core::integrator::{Rk4, SymplecticEuler, VelocityVerlet};
    use libration_core::random::{Address, Purpose};
    use libration_core::system::Oscillator;
    use libration_core::{Integrator, State};

    use super::super::sample::textbook;
    use super::*;

    const FREE: Feedback = Feedback { position: 0.0, velocity: 0.0 };

    fn of(
        integrator: impl Integrator + 'static,
        omega2: f64,
        dt: f64,
    ) -> (Plant<'static>, Resonance) {
        let plant = Plant::new(integrator, Oscillator { omega2 }, State::origin(), dt);
        let resonance = plant.resonance(FREE).unwrap();
        (plant, resonance)
    }

    #[test]
    fn couplings_are_those_of_theory_and_vanish_where_steps_commute() {
        for z in [0.01, 0.1, 1.0, 1.9] {
            let plants = textbook(Oscillator { omega2: 1.0 }, z);
            let of = |i: usize| {
                let (_, plant): &(_, Plant<'_>) = &plants[i];
                plant.resonance(FREE).unwrap()
            };
            let turn = (1.0 - z * z / 4.0).sqrt();
            for (i, wanted) in [(1, z * z / 2.0 / turn), (2, z * z * z / 4.0 / turn)] {
                let Resonance { coupling, angle, rate, bend } = of(i);
                assert!((coupling.to_f64() / wanted - 1.0).abs() < 1e-13, "{i} {z}");
                assert!((angle.to_f64() - (1.0 - z * z / 2.0).acos()).abs() < 1e-13, "{i} {z}");
                assert!(rate.abs().to_f64() < 1e-300 && bend.abs().to_f64() < 1e-120, "{i} {z}");
            }
            // Functions of one matrix: all of their steps commute. Left over is the root of 2^(2·OFF).
            for i in [0, 3, 4] {
                assert!(of(i).coupling.to_f64() < 1e-85, "{i} {z}");
            }
        }
    }

    #[test]
    fn a_loop_that_does_not_turn_has_no_resonance() {
        let plant = Plant::new(Rk4, Oscillator { omega2: 1.0 }, State::origin(), 0.1);
        assert!(plant.resonance(Feedback { position: 0.0, velocity: 5.0 }).is_none());
    }

    #[test]
    fn white_noise_grows_as_the_transfer_operator_says_but_for_its_fourth_power() {
        for feedback in [FREE, Feedback { position: 4.0, velocity: 0.3 }] {
            for (name, plant) in textbook(Oscillator { omega2: 10.0 }, 0.2) {
                let resonance = plant.resonance(feedback).unwrap();
                let error = |rms: f64| {
                    let exact = plant.lyapunov_exponent(feedback, Jitter::Uniform(rms)).unwrap();
                    exact - resonance.weak_growth(StepNoise::white(rms))
                };
                let [large, small] = [0.1, 0.05].map(error);
                // Half the noise, a sixteenth of the error; 15.6 to 16.1 were found. Exact steps alone do not grow at all.
                let fourth = (15.0..17.0).contains(&(large / small));
                assert!(fourth || large.abs() < 1e-15, "{name} {feedback:?}: {large:e} {small:e}");
            }
        }
    }

    /// The growth of `ln |y|` per step between `steps` and twice as many, in floats.
    fn simulated(
        integrator: impl Integrator,
        omega2: f64,
        dt: f64,
        steps: u64,
        mut noise: impl FnMut(u64) -> f64,
    ) -> f64 {
        let system = Oscillator { omega2 };
        let mut state = State { q: [1.0], v: [0.3] };
        let (mut logarithm, mut begin) = (0.0, 0.0);
        for n in 0..2 * steps {
            if n == steps {
                begin = logarithm;
            }
            state = integrator.step(&system, state, dt * (1.0 + noise(n)));
            if n % 64 == 63 {
                let size = (omega2 * state.q[0] * state.q[0] + state.v[0] * state.v[0]).sqrt();
                logarithm += size.ln();
                state = state.map(|x| x / size);
            }
        }
        (logarithm - begin) / steps as f64
    }

    #[test]
    fn noise_with_memory_grows_in_simulation_as_its_spectrum_at_twice_the_angle_says() {
        const STEPS: u64 = 1 << 21;
        const RMS: f64 = 0.05;
        let (_, resonance) = of(SymplecticEuler, 1.44, 1.0);
        let growth = |memory: f64| {
            let mut now = 0.0;
            let found = simulated(SymplecticEuler, 1.44, 1.0, STEPS, |step| {
                let place = Address { seed: 5, trajectory: 0, step, purpose: Purpose::StepTime };
                now = memory * now + (1.0 - memory * memory).sqrt() * RMS * place.gaussian()[0];
                now
            });
            let wanted = resonance.weak_growth(StepNoise::autoregressive(RMS, memory).unwrap());
            // ln |y| is a random walk of variance γ a step.
            let error = (wanted / STEPS as f64).sqrt();
            assert!(
                (found - wanted).abs() < 3.0 * error,
                "{memory}: {found:e} {wanted:e} {error:e}"
            );
            wanted
        };
        let [likewise, white, contrary] = [0.5, 0.0, -0.5].map(growth);
        // At this angle cos 2θ = −0.84: noise that alternates acts most, by more than the errors by far.
        assert!(contrary > 1.8 * white && white > 2.7 * likewise, "{likewise} {white} {contrary}");
    }

    #[test]
    fn memory_is_a_correlation() {
        assert!(StepNoise::autoregressive(0.1, 1.0).is_none());
        assert!(StepNoise::autoregressive(0.1, f64::NAN).is_none());
        assert_eq!(StepNoise::autoregressive(0.1, 0.0), Some(StepNoise::white(0.1)));
        let noise = StepNoise::autoregressive(0.1, -0.7).unwrap();
        // The mean over angles is the variance; 64 of them leave 0.7⁶⁴.
        let angles = (0..64).map(|i| core::f64::consts::TAU * f64::from(i) / 64.0);
        let mean = angles.map(|angle| noise.spectrum(angle)).sum::<f64>() / 64.0;
        assert!((mean / 0.01 - 1.0).abs() < 1e-9, "{mean}");
    }

    #[test]
    fn noise_at_twice_the_angle_is_parametric_resonance() {
        let (_, resonance) = of(VelocityVerlet, 10.0, 0.1);
        let rate = 2.0 * resonance.angle.to_f64();
        let found = simulated(VelocityVerlet, 10.0, 0.1, 1 << 17, |n| {
            SQRT_2 * 0.05 * (rate * n as f64).cos()
        });
        let wanted = resonance.resonance_growth(0.05);
        // The next term is smaller by the square of the noise, 0.0025.
        assert!((found / wanted - 1.0).abs() < 0.0025, "{found:e} {wanted:e}");
        assert!(wanted > 1000.0 * resonance.weak_growth(StepNoise::white(0.05)));
    }

    #[test]
    fn a_periodic_product_grows_as_the_resonance_but_for_the_third_power() {
        // θ = π/8: eight steps to a period of the noise. 2 − z² = 2·cos θ.
        let theta = core::f64::consts::PI / 8.0;
        let z2 = 2.0 - 2.0 * theta.cos();
        let error = |plant: &Plant<'_>, resonance: &Resonance, rms: f64| {
            let ratio = |n: u32| 1.0 + SQRT_2 * rms * (2.0 * theta * f64::from(n) + 0.4).cos();
            let ratios: Vec<f64> = (0..8).map(ratio).collect();
            plant.periodic_radius(FREE, &ratios).ln().to_f64() - resonance.resonance_growth(rms)
        };
        let euler = of(SymplecticEuler, z2, 1.0);
        let verlet = of(VelocityVerlet, z2, 1.0);
        for (plant, resonance) in [euler, verlet] {
            let [large, small] = [0.02, 0.01].map(|rms| error(&plant, &resonance, rms));
            // Half the noise, an eighth of the error; and the error is small beside the growth.
            assert!((7.9..8.1).contains(&(large / small)), "{large:e} {small:e}");
            assert!(small.abs() < 1e-4 * resonance.resonance_growth(0.01), "{small:e}");
        }
    }
}
