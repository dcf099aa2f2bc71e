//! The error of orbits of a step relative to the exact oscillator.

use core::f64::consts::{PI, TAU};

use libration_core::number::Wide;
use libration_core::system::Oscillator;
use libration_core::{Elementary, Scalar};

use super::{EnergyBand, LargestStep, Spectrum, SymbolicStep, UpdateMatrix};

/// The error of a step on the oscillator after many of them, in closed form.
///
/// In units in which the exact solution is a rotation `R`, the step is `ρ·S·R(θ)·S⁻¹`: it grows by
/// `ρ`, turns by `θ` in place of `z`, and turns along an ellipse of axes `κ : 1` in place of a circle.
/// With `α = (κ + 1/κ)/2`, `β = (κ − 1/κ)/2`, `φ = nθ` and `ψ = nz`,
/// `‖Mⁿ − R(ψ)‖₂ = √((ρⁿcos φ − cos ψ)² + (ρⁿα·sin φ − sin ψ)²) + ρⁿβ|sin φ|`: a `2 × 2` matrix is a
/// scaled rotation plus a scaled reflection, and its norm the sum of their sizes.
#[derive(Clone, Copy, Debug)]
pub struct OrbitError {
    /// `ln ρ`: growth of amplitudes a step.
    pub growth: f64,
    /// `θ − z`: phase error of a step, in rad.
    pub phase: f64,
    /// `ln κ`: how far from a circle orbits are.
    pub ellipse: f64,
}

impl OrbitError {
    /// The slip of a step at `z = ωΔt`; none where it does not turn, or no form is definite, or `z` is
    /// not positive and finite.
    pub fn new(step: &SymbolicStep, z: f64) -> Option<Self> {
        if !(z > 0.0 && z.is_finite()) {
            return None;
        }
        let z = Wide::from_f64(z);
        let matrix: UpdateMatrix<Wide> = step.matrix.map(|p| p.eval_wide(z));
        let band = EnergyBand::new(Oscillator { omega2: 1.0 }, &matrix)?;
        let spectrum = Spectrum::new(&matrix);
        Some(OrbitError {
            growth: 0.5 * ln_one_plus(spectrum.determinant_minus_one()),
            phase: (spectrum.turn(z) - z).to_f64(),
            ellipse: 0.5 * band.worst_drift_after(0).ln_1p(),
        })
    }

    /// The largest `‖Mⁿ − R(nz)‖₂` within `steps` steps, over all phases: the trajectory error of the
    /// worst start relative to its amplitude, bounded for every orbit and nearly reached by long ones.
    pub fn worst_error_within(&self, steps: u64) -> f64 {
        // The error rises with growth and slip until the slip is half a turn. Where the orbit
        // decays, the largest error may have been earlier.
        const EARLIER: u32 = 64;
        let at = |n: f64| {
            let slip = (n * self.phase.abs()).min(PI);
            self.largest_over_phases(slip, (n * self.growth).exp_m1())
        };
        let n = steps as f64;
        if self.growth >= 0.0 {
            return at(n);
        }
        let until = n.min(PI / self.phase.abs());
        let part = until / f64::from(EARLIER);
        let earlier = (1..=EARLIER).map(|i| f64::from(i) * part);
        let near = earlier.fold(until, |best, m| if at(m) > at(best) { m } else { best });
        at(n).max(at(largest_near(at, near - part, (near + part).min(until))))
    }

    /// The error for a slip in rad and the relative growth `ρⁿ − 1`.
    fn largest_over_phases(&self, slip: f64, grown: f64) -> f64 {
        // Beyond this the exact orbit is nothing beside the other, and squares overflow.
        if grown > 1e150 {
            return grown;
        }
        let (size, beta) = (1.0 + grown, self.ellipse.sinh().abs());
        // α − 1 = cosh ln κ − 1
        let stretched = 2.0 * (0.5 * self.ellipse).sinh().powi(2);
        let error = |phi: f64| {
            let (sin, cos) = (Elementary::sin(phi), Elementary::cos(phi));
            // Differences of nearly equal sines, by the half angle.
            let half = Elementary::sin(0.5 * slip);
            let middle = phi - 0.5 * slip;
            let re = grown * cos - 2.0 * Elementary::sin(middle) * half;
            let im = (grown + size * stretched) * sin + 2.0 * Elementary::cos(middle) * half;
            (re * re + im * im).sqrt() + size * beta * sin.abs()
        };
        // On a circle all phases are alike.
        if beta == 0.0 {
            return error(0.0);
        }
        const PHASES: u32 = 720;
        let part = TAU / f64::from(PHASES);
        let phases = (0..PHASES).map(|i| f64::from(i) * part);
        let best = phases.fold(0.0, |best, phi| if error(phi) > error(best) { phi } else { best });
        error(best).max(error(largest_near(error, best - part, best + part)))
    }
}

/// `ln(1 + x)`, also where `x` is beyond the range of `f64`.
fn ln_one_plus(x: Wide) -> f64 {
    let small = x.to_f64();
    if small < 1e300 { small.ln_1p() } else { x.ln().to_f64() }
}

/// Where `f` is largest between `low` and `high`, with a single maximum there: by thirds.
fn largest_near(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    for _ in 0..60 {
        let third = (high - low) / 3.0;
        if f(low + third) < f(high - third) { low += third } else { high -= third }
    }
    0.5 * (low + high)
}

impl SymbolicStep {
    /// The largest `z` up to which the trajectory error of the worst start stays below `tolerance`
    /// for `steps` steps, and for every smaller `z` that was tried.
    ///
    /// There is no closed form: the error of [`OrbitError`] is followed upwards from `z = 10⁻¹⁰⁰`, in steps of
    /// 2 % where a method may have an end of stability, and the first crossing is bisected to 12
    /// digits. Within a window the phase error of the methods at hand rises monotonically.
    pub fn largest_step_for_error(&self, tolerance: f64, steps: u64) -> LargestStep {
        let meets = |z: f64| {
            OrbitError::new(self, z).is_some_and(|slip| slip.worst_error_within(steps) <= tolerance)
        };
        // Below all structure and beyond it the error is a power of the step.
        let stride = |z: f64| if (1e-4..1e2).contains(&z) { 1.02 } else { 2.0 };
        let mut low = 1e-100;
        if !meets(low) {
            return LargestStep::Limit(Wide::ZERO);
        }
        while meets(low * stride(low)) {
            low *= stride(low);
            if low > 1e100 {
                return LargestStep::Unlimited;
            }
        }
        let mut high = low * stride(low);
        while high - low > 1e-12 * high {
            let middle = 0.5 * (low + high);
            if meets(middle) { low = middle } else { high = middle }
        }
        LargestStep::Limit(Wide::from_f64(low))
    }
}

#[cfg(test)]
mod tests {
    use libration_core::{Method, with_method};

    use super::*;

    /// `‖Mⁿ − R(nz)‖₂` from the powers of the matrix itself, the largest within `steps`.
    fn by_powers(step: &SymbolicStep, z: f64, steps: u64) -> f64 {
        let matrix = step.matrix.map(|p| p.eval_f64(z));
        let mut power = UpdateMatrix::<f64>::identity();
        let mut worst = 0.0_f64;
        for n in 1..=steps {
            power = matrix.after(&power);
            let (sin, cos) = (n as f64 * z).sin_cos();
            let exact = [[cos, sin], [-sin, cos]];
            let d = |i: usize, j: usize| power.entry(i, j) - exact[i][j];
            let (re, im) = ((d(0, 0) + d(1, 1)) / 2.0, (d(0, 1) - d(1, 0)) / 2.0);
            let (p, q) = ((d(0, 0) - d(1, 1)) / 2.0, (d(0, 1) + d(1, 0)) / 2.0);
            worst = worst.max(re.hypot(im) + p.hypot(q));
        }
        worst
    }

    #[test]
    fn the_closed_form_of_the_error_is_that_of_the_powers() {
        for method in Method::ALL {
            let step = with_method!(method, |m| SymbolicStep::new(m)).unwrap();
            for (z, steps) in [(0.1, 3_000), (0.05, 20_000)] {
                let closed = OrbitError::new(&step, z).unwrap().worst_error_within(steps);
                let powers = by_powers(&step, z, steps);
                // The worst phase comes round every half turn, while the slip rises.
                let late = 1.1 * PI / (z * steps as f64);
                assert!(powers <= closed * (1.0 + 1e-5) + 1e-9, "{} {z}", method.name());
                assert!(powers >= closed * (1.0 - late), "{}: {powers} {closed}", method.name());
            }
        }
    }

    #[test]
    fn beyond_half_a_turn_the_phase_error_is_still_that_of_the_polynomials() {
        let step = SymbolicStep::new(libration_core::integrator::Rk4).unwrap();
        for z in [2.3_f64, 2.44, 2.46, 2.7] {
            // RK4 turns by the argument of 1 + iz − z²/2 − iz³/6 + z⁴/24.
            let (re, im) = (1.0 - z * z / 2.0 + z.powi(4) / 24.0, z - z.powi(3) / 6.0);
            let turned = f64::atan2(im, re).rem_euclid(TAU);
            let phase = OrbitError::new(&step, z).unwrap().phase;
            assert!((phase - (turned - z)).abs() < 1e-14, "{z}: {phase}, not {}", turned - z);
        }
    }

    #[test]
    fn steps_that_no_run_survives_and_tolerances_that_all_meet_are_told_apart() {
        let euler = SymbolicStep::new(libration_core::integrator::ExplicitEuler).unwrap();
        // After one step the error is z for small z: √(1 + z²)·(…) ≈ z²/2 along, z − z away.
        let z = euler.largest_step_for_error(1e-20, 1).to_f64();
        assert!((z * z / 2.0 / 1e-20 - 1.0).abs() < 1e-9, "{z}");
        // After 10¹² steps it is half the growth of n·z² in ln.
        let z = euler.largest_step_for_error(1e-9, 1_000_000_000_000).to_f64();
        assert!((z * z * 0.5e12 / 1e-9 - 1.0).abs() < 1e-6, "{z}");
        let rk4 = SymbolicStep::new(libration_core::integrator::Rk4).unwrap();
        // A polynomial of fourth degree: z⁴/24 is all that is left at this size.
        let z = rk4.largest_step_for_error(1e80, 1).to_f64();
        assert!((z.powi(4) / 24.0 / 1e80 - 1.0).abs() < 1e-9, "{z}");
    }

    #[test]
    fn the_largest_step_for_an_error_meets_it_and_no_larger_one_does() {
        let step = SymbolicStep::new(libration_core::integrator::VelocityVerlet).unwrap();
        let z = step.largest_step_for_error(0.01, 1000).to_f64();
        // n·z³/24 = 0.01, with the ellipse of z²/8 beside it.
        assert!((0.05..0.063).contains(&z), "{z}");
        let error = |z| OrbitError::new(&step, z).unwrap().worst_error_within(1000);
        assert!(error(z) <= 0.01 && error(z * (1.0 + 1e-11)) > 0.01);
    }
}
