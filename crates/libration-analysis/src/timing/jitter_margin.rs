//! The jitter margin of a loop.

use libration_core::control::{Feedback, Jitter};

use super::Plant;
use crate::Spectrum;

/// The largest jitter for which second moments stay bounded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum JitterMargin {
    /// No margin: the loop is unstable or marginal without jitter.
    Unstable,
    /// The largest standard deviation of `ε`.
    Rms(f64),
    /// Beyond this one, the largest that is tried: there steps begin to be negative.
    Beyond(f64),
}

/// Standard deviations that are tried one by one, before the first that is unstable is narrowed down.
const TRIED: u32 = 64;

impl Plant<'_> {
    /// The smallest standard deviation of a law, [`Jitter::Gaussian`] or [`Jitter::Uniform`], at which the loop that
    /// `feedback` closes at once is unstable in the mean square: where the radius of [`Plant::mean_square`] is 1.
    ///
    /// The map of second moments takes definite forms to definite forms, so its radius is an eigenvalue (M. G. Krein,
    /// M. A. Rutman, American Mathematical Society Translations 26, 1950), and passes 1 where `det(1 − E[M ⊗ M])`
    /// vanishes. A loop may be stable again under stronger jitter; between two that are tried, 1/64 of the largest
    /// apart, that is not seen.
    pub fn jitter_margin(&self, feedback: Feedback, law: fn(f64) -> Jitter) -> JitterMargin {
        let excess = Spectrum::new(&self.closed(feedback, self.dt)).radius_minus_one();
        if !excess.is_negative() {
            return JitterMargin::Unstable;
        }
        let squares = self.squares(feedback);
        let stable = |rms: f64| squares.below_the_edge(law(rms));
        let largest = law(1.0).largest_rms();
        let tried = |i: u32| largest * f64::from(i) / f64::from(TRIED);
        let Some(first) = (1..=TRIED).find(|&i| !stable(tried(i))) else {
            return JitterMargin::Beyond(largest);
        };
        let (mut low, mut high) = (tried(first - 1), tried(first));
        loop {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                return JitterMargin::Rms(low);
            }
            if stable(middle) { low = middle } else { high = middle }
        }
    }
}

#[cfg(test)]
mod tests {
    use libration_batch::ensemble::{All, Execution, Loops, Setup};
    use libration_core::State;
    use libration_core::control::clock::Jittered;
    use libration_core::control::controller::StateFeedback;
    use libration_core::integrator::VelocityVerlet;
    use libration_core::system::{BaselineOnly, Oscillator};

    use super::super::sample::{ORIGIN, textbook};
    use super::*;

    const MODEL: Oscillator<f64> = Oscillator { omega2: 10.0 };

    fn verlet() -> (Plant<'static>, Feedback) {
        let plant = Plant::new(VelocityVerlet, MODEL, ORIGIN, 0.3);
        (plant, Feedback { position: 10.0, velocity: 2.0 })
    }

    #[test]
    fn at_the_margin_the_radius_is_one_and_below_it_is_less() {
        let feedback = Feedback { position: 20.0, velocity: 4.0 };
        let mut found = 0;
        for (name, plant) in textbook(MODEL, 0.3) {
            let squares = plant.squares(feedback);
            for law in [Jitter::Gaussian, Jitter::Uniform] {
                let JitterMargin::Rms(margin) = plant.jitter_margin(feedback, law) else {
                    continue;
                };
                found += 1;
                let radius = |rms| squares.mean(law(rms)).radius.to_f64();
                // The margin is the float below the edge, and the radius rises by less than 10 for each unit of it.
                assert!((radius(margin) - 1.0).abs() < 1e-15, "{name} {margin}");
                let shares = [0.25, 0.5, 0.9, 0.999].map(|share| radius(share * margin));
                assert!(shares.iter().all(|&radius| radius < 1.0), "{name} {shares:?}");
                assert!(radius(1.001 * margin) > 1.0, "{name} {margin}");
            }
        }
        // Velocity Verlet, RK4 and exact steps; in the others the loop is unstable without jitter.
        assert_eq!(found, 6);
    }

    #[test]
    fn a_loop_without_a_margin_says_why() {
        // Undamped steps that keep areas are on the edge; explicit Euler is beyond.
        for (name, plant) in textbook(MODEL, 0.1).into_iter().take(3) {
            let margin = plant.jitter_margin(Feedback::default(), Jitter::Gaussian);
            assert_eq!(margin, JitterMargin::Unstable, "{name}");
        }
        // RK4 damps by itself, and steps of RK4 alone commute: no jitter that makes sense undoes it.
        let damped = Plant::new(libration_core::integrator::Rk4, MODEL, ORIGIN, 0.1);
        let margin = damped.jitter_margin(Feedback::default(), Jitter::Uniform);
        assert_eq!(margin, JitterMargin::Beyond(1.0 / 3.0_f64.sqrt()));
    }

    #[test]
    fn simulated_second_moments_grow_above_the_margin_and_fall_below() {
        const COUNT: usize = 20_000;
        let (plant, feedback) = verlet();
        let JitterMargin::Rms(margin) = plant.jitter_margin(feedback, Jitter::Uniform) else {
            panic!("there is a margin");
        };
        let start = State { q: [1.0], v: [0.5] };
        for share in [0.7, 1.5] {
            let law = Jitter::Uniform(share * margin);
            let setup = Setup::new(All(BaselineOnly(MODEL)), VelocityVerlet)
                .controller(StateFeedback::to_origin(feedback))
                .clock(Jittered(law));
            let starts = vec![start; COUNT];
            let mut all = Loops::new(setup, 0.3, 7, [0.0], &starts, Execution::serial()).unwrap();
            let sums = [40, 80].map(|_| {
                all.advance(40).unwrap();
                let squares = all.trajectories().v(0).iter().map(|v| v * v);
                squares.fold([0.0; 2], |[sum, fourth], v2| [sum + v2, fourth + v2 * v2])
            });
            let theory = plant.mean_square(feedback, law);
            let mut means = [0.0; 2];
            for (i, [sum, squares]) in sums.into_iter().enumerate() {
                let count = COUNT as f64;
                let mean = sum / count;
                let error = ((squares / count - mean * mean) / count).sqrt();
                let [.., wanted] = theory.moments(&start, 40 * (i as u64 + 1));
                assert!((mean - wanted).abs() < 3.0 * error, "{share}: {mean} ± {error}, {wanted}");
                means[i] = mean;
            }
            assert_eq!(means[1] > means[0], share > 1.0, "{share}: {means:?}");
        }
    }
}
