//! How well a discrete orbit covers the curve on which it lies.

use libration::analysis::{EnergyBand, Linearisation, forecast_drift};
use libration::system::Oscillator;
use libration::{Method, State, with_method};

/// `d ln D/d ln z` of the largest drift `D` on the curve: how much closer in `z` a search comes than
/// it is in `D`. The methods drift with a power of `z`, but from some starts it is flat in places.
pub(super) fn exponent(method: Method, start: &State<f64, 1>, steps: u64, z: f64) -> f64 {
    let unit = Oscillator { omega2: 1.0 };
    let ln_drift = |z: f64| {
        let step = with_method!(method, |m| Linearisation::new(m, unit, start, z)).step;
        let (low, high) = EnergyBand::new(unit, &step)?.drift_after(start, steps);
        Some(low.abs().max(high.abs()).ln())
    };
    const PART: f64 = 1e-6;
    let below = ln_drift(z * (1.0 - 2.0 * PART)).zip(ln_drift(z * (1.0 - PART)));
    below.map_or(1.0, |(a, b)| (b - a) / PART)
}

/// By which part the largest drift of `steps` steps may stay below that of their curve, at `z = ωΔt`
/// and at slightly larger steps, which shift the last phase by up to four radians: where a turn is
/// nearly a whole number of steps an orbit visits few phases, and a search slips through. The start
/// is in units in which `ω = 1`.
pub(super) fn lacking(method: Method, start: &State<f64, 1>, steps: u64, z: f64) -> f64 {
    let unit = Oscillator { omega2: 1.0 };
    let step = |z: f64| with_method!(method, |m| Linearisation::new(m, unit, start, z)).step;
    // Where the energy changes by the determinant alone all phases are alike.
    if EnergyBand::new(unit, &step(z)).is_none_or(|band| band.worst_start().is_none()) {
        return 0.0;
    }
    let at = |z: f64| {
        let step = step(z);
        let forecast = forecast_drift(unit, &step, start, steps)?;
        let (low, high) = EnergyBand::new(unit, &step)?.drift_after(start, steps);
        Some(1.0 - forecast.drift.to_f64() / low.abs().max(high.abs()))
    };
    let shifted = (0..=40).map(|i| at(z * (1.0 + 0.1 * f64::from(i) / (z * steps as f64))));
    shifted.flatten().fold(0.0, f64::max).min(1.0)
}
