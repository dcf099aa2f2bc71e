//! Delays of parts of a loop by their parameters.

use core::f64::consts::{SQRT_2, TAU};

/// A delay, as its source states it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Delay {
    /// A time in s.
    Time(f64),
    /// A cycle with this rate in Hz: a value is up to a period old.
    Cycle(f64),
    /// A low-pass filter of first order with this cutoff frequency in Hz.
    FirstOrder(f64),
    /// A low-pass filter of first order with this time constant in s.
    TimeConstant(f64),
    /// A Butterworth filter of second order with this cutoff frequency in Hz.
    Butterworth(f64),
    /// A moving average, or a difference quotient, over this window in s.
    Window(f64),
}

impl Delay {
    /// The delay in s; of a filter its group delay at low frequency, `−dφ/dω` at `ω = 0`. For a filter `1/(1 + b₁ s + …)` it is `b₁`.
    pub fn seconds(self) -> f64 {
        match self {
            Delay::Time(seconds) | Delay::TimeConstant(seconds) => seconds,
            Delay::Cycle(rate) => 1.0 / rate,
            Delay::FirstOrder(cutoff) => 1.0 / (TAU * cutoff),
            Delay::Butterworth(cutoff) => SQRT_2 / (TAU * cutoff),
            Delay::Window(window) => window / 2.0,
        }
    }

    /// The parameters in words, and the formula of the delay.
    pub fn text(self) -> String {
        match self {
            Delay::Time(_) => "stated".to_owned(),
            Delay::Cycle(rate) => format!("cycle of {rate} Hz: 1/f"),
            Delay::FirstOrder(cutoff) => format!("first order, {cutoff} Hz: 1/(2πf)"),
            Delay::TimeConstant(seconds) => format!("first order, {seconds} s: T"),
            Delay::Butterworth(cutoff) => format!("Butterworth, order 2, {cutoff} Hz: √2/(2πf)"),
            Delay::Window(window) => format!("window of {window} s: T/2"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A complex number as [re, im].
    type Complex = [f64; 2];

    /// The phase of a response in the Laplace variable iω, from numbers that share no formula with [`Delay::seconds`].
    fn phase(delay: Delay, omega: f64) -> f64 {
        let over = |[re, im]: Complex| -im.atan2(re);
        match delay {
            Delay::Time(seconds) => -omega * seconds,
            Delay::Cycle(rate) => -omega / rate,
            Delay::FirstOrder(cutoff) => over([1.0, omega / (TAU * cutoff)]),
            Delay::TimeConstant(seconds) => over([1.0, omega * seconds]),
            // Poles of order 2 at angles of 135° and 225°.
            Delay::Butterworth(cutoff) => {
                let pole = TAU * cutoff / SQRT_2;
                over([pole, omega - pole]) + over([pole, omega + pole])
            }
            // The integral of exp(−iωt) over the window, by the midpoint rule.
            Delay::Window(window) => {
                let at = |k: u32| (f64::from(k) + 0.5) / 1000.0 * window * omega;
                let [re, im] =
                    (0..1000).fold([0.0, 0.0], |[re, im], k| [re + at(k).cos(), im - at(k).sin()]);
                im.atan2(re)
            }
        }
    }

    #[test]
    fn delays_of_filters_are_slopes_of_their_phase_at_low_frequency() {
        // `scipy.signal.freqs` of butter(2, 2π·30, analog=True) has a delay of 7.5026 ms at ω → 0, of butter(1, 2π·250) 0.63662 ms.
        assert!((Delay::Butterworth(30.0).seconds() - 7.5026e-3).abs() < 1e-7);
        assert!((Delay::FirstOrder(250.0).seconds() - 6.3662e-4).abs() < 1e-8);
        let all = [
            Delay::Time(0.1),
            Delay::Cycle(500.0),
            Delay::FirstOrder(100.0),
            Delay::TimeConstant(0.005),
            Delay::Butterworth(20.0),
            Delay::Window(0.1),
        ];
        for delay in all {
            // The phase has terms ω and (ωT)³, so that its slope errs by (ωT)² = 10⁻⁶, and rounding by 10⁻¹⁶/10⁻³.
            let omega = 1e-3 / delay.seconds();
            let slope = -(phase(delay, omega) - phase(delay, -omega)) / (2.0 * omega);
            let error = (slope / delay.seconds() - 1.0).abs();
            assert!(error < 2e-6, "{delay:?}: {error:e}");
        }
    }
}
