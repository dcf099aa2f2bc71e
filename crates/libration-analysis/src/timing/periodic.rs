//! Periodic step times.

use libration_core::Scalar;
use libration_core::control::Feedback;
use libration_core::number::Wide;

use super::Plant;
use crate::{Spectrum, UpdateMatrix};

/// Steps of Newton's iteration for a root: from 40 good bits each doubles them, up to 1024.
const NEWTON: usize = 5;

impl Plant<'_> {
    /// The growth per step of the loop that `feedback` closes at once where steps of `Δt·ratio` follow each other
    /// over and over: the spectral radius of the product of a period, to the power of one over its length (G. Floquet,
    /// Annales scientifiques de l'École Normale Supérieure 12, 1883).
    ///
    /// It is 1 of no steps, and has no value where a ratio is not finite.
    pub fn periodic_radius(&self, feedback: Feedback, ratios: &[f64]) -> Wide {
        let step = |&ratio: &f64| self.closed(feedback, self.dt * Wide::from_f64(ratio));
        let period = ratios.iter().map(step);
        let product = period.fold(UpdateMatrix::identity(), |product, step| step.after(&product));
        root(Spectrum::new(&product).radius(), ratios.len() as u64)
    }
}

/// The `n`-th root of a non-negative number; 1 for `n = 0`.
fn root(x: Wide, n: u64) -> Wide {
    if n == 0 {
        return Wide::one();
    }
    let Some(exponent) = x.exponent() else { return x };
    // A power of two goes out, so that the rest is within the range of floats.
    let out = exponent / n as i64;
    let x = x.scaled(-out * n as i64);
    let order = Wide::from_f64(n as f64);
    let mut root = Wide::from_f64((x.ln() / order).to_f64().exp());
    for _ in 0..NEWTON {
        root = root - (root - x / root.powi(n - 1)) / order;
    }
    root.scaled(out)
}

#[cfg(test)]
mod tests {
    use libration_core::system::Oscillator;

    use super::super::sample::{all, textbook};
    use super::*;

    const MODEL: Oscillator<f64> = Oscillator { omega2: 10.0 };

    #[test]
    fn a_root_to_the_power_of_its_order_is_the_number() {
        for n in [1_u64, 2, 7, 1000] {
            for x in [Wide::from_f64(3.0), Wide::from_f64(1e-9), Wide::from_f64(2.5).powi(4000)] {
                let rest = root(x, n).powi(n) / x - Wide::one();
                // 1000 rounding errors of 2⁻¹⁰²³.
                assert!(rest.abs().to_f64() < 1e-300, "{n} {rest}");
            }
        }
        assert!(root(Wide::ZERO, 3).is_zero());
        assert_eq!(root(Wide::from_f64(5.0), 0).to_f64(), 1.0);
    }

    #[test]
    fn steps_that_are_all_alike_grow_by_the_radius_of_one() {
        let feedback = Feedback { position: 4.0, velocity: 0.3 };
        for (name, plant) in all(MODEL, 0.1) {
            let one = Spectrum::new(&plant.closed(feedback, plant.dt)).radius();
            for period in [1, 2, 5] {
                let found = plant.periodic_radius(feedback, &vec![1.0; period]);
                assert!((found - one).abs().to_f64() < 1e-290, "{name} {period}");
            }
        }
    }

    #[test]
    fn exact_steps_of_any_lengths_only_turn_and_those_of_symplectic_methods_grow_at_the_resonance()
    {
        // θ = π/2 at z² = 2: lengths that alternate excite twice the angle.
        let plants = textbook(Oscillator { omega2: 2.0 }, 1.0);
        let excess = |i: usize| {
            let (_, plant): &(_, Plant<'_>) = &plants[i];
            plant.periodic_radius(Feedback::default(), &[1.05, 0.95]).to_f64() - 1.0
        };
        // By hand for symplectic Euler: with z² = 2r², r = 1.05 and 0.95, the trace of the product.
        let matrix = |r: f64| [[1.0 - 2.0 * r * r, r], [-2.0 * r, 1.0]];
        let ([[a, b], [c, d]], [[e, f], [g, h]]) = (matrix(0.95), matrix(1.05));
        let trace = a * e + b * g + c * f + d * h;
        let radius = trace.abs() / 2.0 + (trace * trace / 4.0 - 1.0).sqrt();
        assert!((excess(1) - (radius.sqrt() - 1.0)).abs() < 1e-14, "{} {radius}", excess(1));
        assert!(excess(1) > 0.04 && excess(2) > 0.02, "{} {}", excess(1), excess(2));
        // Both are turns about the same centre.
        assert!(excess(4).abs() < 1e-15, "{}", excess(4));
    }
}
