//! The rounding error of single steps and its prediction for many.

use libration_core::{Float, State};

/// The rounding error that one step leaves in the energy, relative to the energy: its mean, and its variance.
///
/// Each step is taken twice from the same state, in the float under test and in a much wider number; the difference
/// of the two energies is what the step has rounded, truncation has no part in it. Where roundings are independent of
/// each other, `n` steps leave `n` times the mean and `√n` times the deviation (Brouwer, Astron. J. 46, 149, 1937;
/// Hairer, Lubich, Wanner: Geometric Numerical Integration, 2nd ed., §VIII.5).
///
/// Roundings of neighbouring steps are alike where the increment of a step changes by less than a unit in the last
/// place from one to the next, that is for `z² < 2u`. So what whole stretches leave is summed up, too: over a stretch
/// of a turn, that knows of all that neighbours have in common.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalRounding {
    /// Mean of the rounding error of a step.
    pub mean: f64,
    /// Variance of the rounding error of a step.
    pub variance: f64,
    /// Variance of the sum over a stretch, for each of its steps: more than `variance` where neighbours are alike,
    /// less where they make up for each other.
    pub spread: f64,
    /// Standard error of `mean`, by the scatter of the stretches.
    pub mean_error: f64,
}

/// A mean is told from zero by this many of its standard errors: by chance one in 16 000 is.
const SIGNIFICANT: f64 = 4.0;

impl LocalRounding {
    /// The rounding of `steps` steps from near each of `starts`, of which there should be 30 at least.
    ///
    /// As many steps are taken before: the last bits of a start are not those of an orbit, which inherits them from
    /// where it was larger.
    ///
    /// `step` is the step under test, `exact` the same step with the same parameters on a number `W` so wide that
    /// its own rounding does not count, and `energy` what is conserved. Errors are relative to the energy where a step
    /// begins. None if a start or a step leaves the range of the float, or if there are fewer than two starts.
    pub fn over<F: Float, W: Float, const D: usize>(
        starts: &[State<F, D>],
        steps: u64,
        step: impl Fn(State<F, D>) -> State<F, D>,
        exact: impl Fn(State<W, D>) -> State<W, D>,
        energy: impl Fn(&State<W, D>) -> W,
    ) -> Option<Self> {
        let widened = |state: &State<F, D>| state.map(|x| W::from_f64(x.to_f64()));
        let (mut sums, mut squares) = (Vec::with_capacity(starts.len()), 0.0);
        for &start in starts {
            let mut state = (0..steps).fold(start, |state, _| step(state));
            let mut sum = 0.0;
            for _ in 0..steps {
                let from = widened(&state);
                state = step(state);
                let (should, is) = (energy(&exact(from)), energy(&widened(&state)));
                let error = (is - should).to_f64() / energy(&from).to_f64();
                sum += error;
                squares += error * error;
            }
            sums.push(sum);
        }
        let (stretches, steps) = (sums.len() as f64, steps as f64);
        let mean = sums.iter().sum::<f64>() / (stretches * steps);
        let scatter = sums.iter().map(|sum| (sum - mean * steps).powi(2)).sum::<f64>();
        let spread = scatter / ((stretches - 1.0) * steps);
        let variance = squares / (stretches * steps) - mean * mean;
        let mean_error = (spread / (stretches * steps)).sqrt();
        let rounding = LocalRounding { mean, variance, spread, mean_error };
        (spread.is_finite() && variance.is_finite()).then_some(rounding)
    }

    /// The mean error of a step, or zero where the scatter does not tell it from that.
    pub fn bias(&self) -> f64 {
        if self.mean.abs() > SIGNIFICANT * self.mean_error { self.mean } else { 0.0 }
    }

    /// The root mean square, over orbits, of the relative change of the energy after `n` steps.
    pub fn drift_after(&self, n: f64) -> f64 {
        (self.bias() * n).hypot((self.spread * n).sqrt())
    }

    /// The number of steps after which that is `size`, as is the error of the method that it is compared with:
    /// infinite where nothing is rounded.
    pub fn steps_to(&self, size: f64) -> f64 {
        // (bias·n)² + spread·n = size², without a difference of nearly equal numbers.
        let root = self.spread.hypot(2.0 * self.bias() * size);
        2.0 * size * size / (self.spread + root)
    }
}

#[cfg(test)]
mod tests {
    use core::f64::consts::TAU;

    use libration_core::integrator::{TextbookVerlet, VelocityVerlet};
    use libration_core::number::{Compensated, TwoFloat};
    use libration_core::system::Oscillator;
    use libration_core::{Integrator, Model, Scalar};

    use super::*;
    use libration_core::number::Wide;

    use crate::{EnergyBand, QuadraticForm, UpdateMatrix};

    const START: State<f64, 1> = State { q: [1.0], v: [0.0] };
    const MODEL: Oscillator<f64> = Oscillator { omega2: 10.0 };

    /// A method with a step of `dt` on the oscillator of ω² = 10, which no float rounds.
    #[derive(Clone, Copy)]
    struct Setting<I> {
        method: I,
        dt: f64,
    }

    impl<I: Integrator> Setting<I> {
        fn step<F: Float>(self) -> impl Fn(State<F, 1>) -> State<F, 1> {
            let system = Model::<1>::on::<F>(&MODEL);
            move |state| self.method.step(&system, state, F::from_f64(self.dt))
        }

        fn matrix<F: Float>(self) -> UpdateMatrix<Wide> {
            UpdateMatrix::of_step(self.method, MODEL, &START, F::from_f64(self.dt).to_f64())
        }

        /// `count` points of orbits a little smaller than that of the start.
        fn starts<F: Float>(self, count: usize) -> Vec<State<F, 1>> {
            let band = EnergyBand::new(MODEL, &self.matrix::<F>()).unwrap();
            let scaled = |(i, point): (usize, State<f64, 1>)| {
                // Multiples of the golden ratio fill an interval evenly in any order.
                let size = 1.0 - 1e-3 * (0.618_033_988_749_895 * i as f64).fract();
                point.map(|x| F::from_f64(size * x))
            };
            band.curve(&START, count).into_iter().skip(1).enumerate().map(scaled).collect()
        }

        /// The prediction from about `samples` steps.
        fn local<F: Float, W: Float>(self, steps: u64) -> LocalRounding {
            let turn = (TAU / (MODEL.omega2.sqrt() * self.dt)).round() as u64;
            let form = QuadraticForm::carried_by(&self.matrix::<F>());
            let form = form.map(|x| W::from_f64(x.to_f64()));
            let rounded = F::from_f64(self.dt).to_f64();
            let exact = Setting { dt: rounded, ..self };
            let starts = self.starts::<F>((steps / turn) as usize);
            let energy = |state: &State<W, 1>| form.at(state);
            LocalRounding::over(&starts, turn, self.step::<F>(), exact.step::<W>(), energy).unwrap()
        }

        /// Mean and scatter of the energy over `orbits` after `n` steps.
        fn simulated<F: Float>(self, orbits: usize, n: u64) -> (f64, f64) {
            let form = QuadraticForm::carried_by(&self.matrix::<F>()).map(TwoFloat::from);
            let energy =
                |state: &State<F, 1>| form.at(&state.map(|x| TwoFloat::from_f64(x.to_f64())));
            let step = self.step::<F>();
            let drift = |start: State<F, 1>| {
                let end = (0..n).fold(start, |state, _| step(state));
                let before = energy(&start);
                (energy(&end) - before).to_f64() / before.to_f64()
            };
            let drifts: Vec<f64> = self.starts(orbits).into_iter().map(drift).collect();
            let mean = drifts.iter().sum::<f64>() / orbits as f64;
            let squares = drifts.iter().map(|d| (d - mean).powi(2)).sum::<f64>();
            (mean, (squares / (orbits as f64 - 1.0)).sqrt())
        }
    }

    #[test]
    fn independent_roundings_add_up_as_brouwer_says() {
        // Four deviations of a scatter over 64 orbits are 4/√126 of it.
        const ORBITS: usize = 64;
        let allowed = 4.0 / (2.0 * (ORBITS as f64 - 1.0)).sqrt();
        for dt in [0.01, 0.003] {
            let setting = Setting { method: VelocityVerlet, dt };
            let local = setting.local::<f32, f64>(1_000_000);
            assert_eq!(local.bias(), 0.0);
            let n = 100_000;
            let (_, scatter) = setting.simulated::<f32>(ORBITS, n);
            let predicted = local.drift_after(n as f64);
            assert!((scatter / predicted - 1.0).abs() < allowed, "{scatter:e} {predicted:e}");
            // The range that was measured for this method elsewhere.
            let roundings = predicted / (f32::UNIT_ROUNDOFF * (n as f64).sqrt());
            assert!((0.6..1.1).contains(&roundings), "{roundings}");
        }
        let double = Setting { method: VelocityVerlet, dt: 0.01 }.local::<f64, TwoFloat>(200_000);
        let roundings = double.drift_after(1e6) / (f64::UNIT_ROUNDOFF * 1e3);
        assert!((0.6..1.2).contains(&roundings), "{roundings}");
    }

    #[test]
    fn a_million_steps_drift_by_7e_5_in_single_precision_and_by_a_fiftieth_of_it_compensated() {
        const ORBITS: usize = 32;
        let setting = Setting { method: VelocityVerlet, dt: 0.01 };
        let (_, single) = setting.simulated::<f32>(ORBITS, 1_000_000);
        let (_, compensated) = setting.simulated::<Compensated>(ORBITS, 1_000_000);
        // Each is known to 4/√62 of itself.
        assert!((single / 6.8e-5 - 1.0).abs() < 0.51, "{single:e}");
        assert!((compensated / 1.2e-6 - 1.0).abs() < 0.51, "{compensated:e}");
        let predicted = setting.local::<Compensated, f64>(1_000_000).drift_after(1e6);
        assert!((compensated / predicted - 1.0).abs() < 0.51, "{compensated:e} {predicted:e}");
    }

    #[test]
    fn the_textbooks_verlet_is_biased_and_drifts_linearly() {
        let setting = Setting { method: TextbookVerlet, dt: 0.001 };
        let local = setting.local::<f32, f64>(4_000_000);
        let n = 1e6;
        let (mean, _) = setting.simulated::<f32>(8, n as u64);
        // The bias is known to its standard error, and each of eight orbits walks at random beside it.
        let allowed = 4.0 * (local.mean_error * n).hypot((local.spread * n / 8.0).sqrt());
        assert!((mean - local.bias() * n).abs() < allowed, "{mean:e} {:e}", local.bias() * n);
        assert!(mean.abs() > 15.0 * (local.spread * n).sqrt(), "{mean:e}");
    }

    #[test]
    fn rounding_overtakes_truncation_after_1700_steps_of_1_ms_and_14_million_of_10_ms() {
        for (dt, known) in [(1e-3, 1.7e3), (1e-2, 1.4e7)] {
            let local = Setting { method: VelocityVerlet, dt }.local::<f32, f64>(1_000_000);
            // From rest, Verlet's energy falls by z²/4 at most.
            let steps = local.steps_to(MODEL.omega2 * dt * dt / 4.0);
            // It goes as the square of a coefficient that is given to a tenth or so.
            assert!((steps / known - 1.0).abs() < 0.25, "{dt}: {steps:e}, not {known:e}");
            let drift = local.drift_after(steps);
            assert!((drift / (MODEL.omega2 * dt * dt / 4.0) - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn nothing_is_said_of_steps_that_leave_the_range_of_a_float() {
        let starts = [START.map(half::f16::from_f64); 3];
        let energy = |state: &State<f64, 1>| state.q[0];
        let grow = |state: State<half::f16, 1>| state.doubled();
        let found = LocalRounding::over(&starts, 20, grow, |s: State<f64, 1>| s.doubled(), energy);
        assert_eq!(found, None);
        assert_eq!(LocalRounding::over(&starts[..1], 2, |s| s, |s: State<f64, 1>| s, energy), None);
    }
}
