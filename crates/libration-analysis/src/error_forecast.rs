//! The error of a long orbit of the oscillator, without simulating it.

use libration_core::number::Wide;
use libration_core::system::Oscillator;
use libration_core::{Elementary, Scalar, State};

use super::{Complex, Eigenvalues, Spectrum, UpdateMatrix};

/// Differences from one below this are rounding of the 1024 bits.
const ROUNDING: f64 = 1e-250;

/// The position `xₙ` of a linear step beside the exact solution `x(t)`, for any number of steps.
///
/// Both are sums of powers, `xₙ = 2·Re(c·λⁿ)` and `x(nΔt) = 2·Re(g·μⁿ)` with `μ = e^{iωΔt}`, so that
/// sums of squares of their difference are geometric series.
#[derive(Clone, Copy, Debug)]
pub struct ErrorForecast {
    numeric: Mode,
    exact: Mode,
}

/// `2·Re(amplitude · factorⁿ)`.
#[derive(Clone, Copy, Debug)]
struct Mode {
    amplitude: Complex,
    factor: Complex,
}

impl ErrorForecast {
    /// The forecast for `step`, which advances `model` by `dt` seconds; none where the step does
    /// not oscillate.
    pub fn new(
        model: Oscillator<f64>,
        step: &UpdateMatrix<Wide>,
        dt: f64,
        start: &State<f64, 1>,
    ) -> Option<Self> {
        let Eigenvalues::Complex { re, im } = Spectrum::new(step).eigenvalues else { return None };
        let start = start.map(Wide::from_f64);
        let omega = Wide::from_f64(model.omega2).sqrt();
        let (sin, cos) = (omega * Wide::from_f64(dt)).sin_cos();
        let [q] = start.q;
        let [next] = step.apply(&start).q;
        let half = |x: Wide| x.ratio(1, 2);
        Some(ErrorForecast {
            numeric: Mode {
                amplitude: Complex { re: half(q), im: half((q * re - next) / im) },
                factor: Complex { re, im },
            },
            exact: Mode {
                amplitude: Complex { re: half(q), im: -half(start.v[0] / omega) },
                factor: Complex { re: cos, im: sin },
            },
        })
    }

    /// `xₙ − x((n − late)·Δt)`, in m: the state after `n` steps beside the solution of `late` steps
    /// before.
    pub fn after(&self, n: u64, late: u64) -> Wide {
        let twice = |mode: &Mode, n| {
            let value = mode.amplitude.times(mode.factor.powi(n));
            value.re + value.re
        };
        twice(&self.numeric, n) - twice(&self.exact.earlier(late), n)
    }

    /// The root mean square over `samples` instants from the start on, `0, Δt, 2Δt` and so on, of the
    /// solution there beside the state of `late` steps later: of [`after`](Self::after) for
    /// `n = late, …, late + samples − 1`.
    pub fn rms(&self, samples: u64, late: u64) -> Wide {
        let (numeric, exact) = (self.numeric, self.exact.earlier(late));
        // uₙ = c·λⁿ − g·μⁿ; the error is 2·Re u, and its square 2·|u|² + 2·Re u².
        let sum = |a: Mode, b: Mode| {
            let amplitude = a.amplitude.times(b.amplitude);
            amplitude.times(geometric(a.factor.times(b.factor), late, samples)).re
        };
        let squares = |m: Mode| sum(m, m.conjugate()) + sum(m, m);
        let cross = sum(numeric, exact.conjugate()) + sum(numeric, exact);
        let total = squares(numeric) + squares(exact) - cross - cross;
        ((total + total) / Wide::from_f64(samples as f64)).sqrt()
    }
}

impl Mode {
    /// The mode `n` steps before.
    fn earlier(self, n: u64) -> Self {
        Mode { amplitude: self.amplitude.over(self.factor.powi(n)), ..self }
    }

    fn conjugate(self) -> Self {
        Mode { amplitude: self.amplitude.conjugate(), factor: self.factor.conjugate() }
    }
}

/// `wᵏ + … + wᵏ⁺ⁿ⁻¹`.
fn geometric(w: Complex, k: u64, n: u64) -> Complex {
    let one = Complex::real(Wide::one());
    let difference = w.minus(one);
    if difference.abs().to_f64() < ROUNDING {
        return Complex::real(Wide::from_f64(n as f64));
    }
    w.powi(k).times(w.powi(n).minus(one)).over(difference)
}

#[cfg(test)]
mod tests {
    use libration_core::{Method, with_method};

    use super::*;

    fn forecast(method: Method, dt: f64) -> ErrorForecast {
        let (model, start) = (Oscillator { omega2: 10.0 }, State { q: [1.0], v: [0.0] });
        let step = with_method!(method, |m| UpdateMatrix::of_step(m, model, &start, dt));
        ErrorForecast::new(model, &step, dt, &start).unwrap()
    }

    #[test]
    fn the_published_errors_of_a_million_steps_are_met() {
        // RMS over 10⁶ states at Δt = 1 ms, aligned and one step late, printed by NumPy.
        for (method, aligned, late) in [
            (Method::ExplicitEuler, 32.7323, 32.7323),
            (Method::SymplecticEuler, 0.00160666, 0.00382960),
            (Method::VelocityVerlet, 0.000537979, 0.00271542),
            (Method::Rk4, 1.076e-9, 0.00223616),
        ] {
            let forecast = forecast(method, 1e-3);
            for (late, want) in [(0, aligned), (1, late)] {
                let got = forecast.rms(1_000_000, late).to_f64();
                // Half a unit of the last of four or six digits.
                let digits = if want < 1e-6 { 5e-4 } else { 2.3e-6 };
                assert!((got / want - 1.0).abs() < digits, "{} {late}: {got}", method.name());
            }
        }
    }

    #[test]
    fn the_sum_is_that_of_its_terms() {
        let forecast = forecast(Method::ExplicitEuler, 0.01);
        for late in [0, 1, 3] {
            let terms = (late..late + 40).map(|n| forecast.after(n, late).to_f64().powi(2));
            let rms = (terms.sum::<f64>() / 40.0).sqrt();
            let got = forecast.rms(40, late).to_f64();
            // Forty terms, summed in f64.
            assert!((got / rms - 1.0).abs() < 1e-14, "{got} {rms}");
        }
    }
}
