//! How long a step is.

use crate::Float;
use crate::analysis::Jitter;
use crate::random::{Address, Purpose};

/// Gives every step of every trajectory its length.
///
/// No step is negative: where noise would make it so, it is of length zero, since a clock does not go back.
pub trait Clock<T>: Copy + Send + Sync {
    /// Seconds from `step` to the next, of `trajectory`.
    fn dt(&self, trajectory: u64, step: u64) -> T;
}

/// Every step is as long as the others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fixed<T>(pub T);

impl<T: Float> Clock<T> for Fixed<T> {
    #[inline(always)]
    fn dt(&self, _: u64, _: u64) -> T {
        self.0
    }
}

/// Steps of `Δt(1 + ε)`, with another `ε` for every step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jittered {
    /// The mean step in seconds.
    pub dt: f64,
    /// The law of `ε`.
    pub law: Jitter,
    /// Of the run.
    pub seed: u64,
}

impl<T: Float> Clock<T> for Jittered {
    #[inline(always)]
    fn dt(&self, trajectory: u64, step: u64) -> T {
        let place = Address { seed: self.seed, trajectory, step, purpose: Purpose::StepTime };
        T::from_f64(longer(self.dt, draw(self.law, place)))
    }
}

/// Steps of `Δt(1 + δ)`, with another `δ` for every trajectory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Skewed {
    /// The mean step in seconds.
    pub dt: f64,
    /// The law of `δ`.
    pub law: Jitter,
    /// Of the run.
    pub seed: u64,
}

impl<T: Float> Clock<T> for Skewed {
    #[inline(always)]
    fn dt(&self, trajectory: u64, _: u64) -> T {
        let place = Address { seed: self.seed, trajectory, step: 0, purpose: Purpose::ClockRate };
        T::from_f64(longer(self.dt, draw(self.law, place)))
    }
}

/// `Δt(1 + ε)`, but not below zero.
fn longer(dt: f64, epsilon: f64) -> f64 {
    (dt * (1.0 + epsilon)).max(0.0)
}

/// A draw from `law`.
fn draw(law: Jitter, place: Address) -> f64 {
    match law {
        Jitter::Gaussian(rms) => rms * place.gaussian()[0],
        // The width of a uniform law is √12 of its deviations.
        Jitter::Uniform(rms) => rms * 12.0_f64.sqrt() * (place.uniform()[0] - 0.5),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_step_is_negative_however_wild_the_noise() {
        let clock = Jittered { dt: 0.1, law: Jitter::Gaussian(3.0), seed: 1 };
        let steps: Vec<f64> = (0..1000).map(|step| clock.dt(0, step)).collect();
        assert!(steps.iter().all(|&dt| dt >= 0.0));
        // ε < −1 is a third of all draws at three deviations.
        let none = steps.iter().filter(|&&dt| dt == 0.0).count();
        assert!((300..450).contains(&none), "{none}");
    }

    #[test]
    fn a_skewed_clock_keeps_its_rate_and_a_jittered_one_does_not() {
        let law = Jitter::Uniform(0.1);
        let (skewed, jittered) =
            (Skewed { dt: 1.0, law, seed: 9 }, Jittered { dt: 1.0, law, seed: 9 });
        let of = |clock: &dyn Fn(u64, u64) -> f64| [clock(0, 0), clock(0, 1), clock(1, 0)];
        let [here, later, other] = of(&|n, step| skewed.dt(n, step));
        assert!(here == later && here != other);
        let [here, later, other] = of(&|n, step| jittered.dt(n, step));
        assert!(here != later && here != other);
        assert!((0..1000).all(|n| {
            let dt: f64 = skewed.dt(n, 0);
            (dt - 1.0).abs() <= 0.1 * 3.0_f64.sqrt()
        }));
    }
}
