//! How well a discrete orbit covers the curve on which it lies.

use libration::analysis::{EnergyBand, Linearisation, forecast_drift};
use libration::system::Oscillator;
use libration::{Method, State, with_method};

/// By which part the largest drift of `steps` steps stays below that of their curve, at `z = ωΔt` and
/// wherever the last phase is shifted by up to a radian: which phases an orbit visits changes
/// from one step size to the next. The start is in units in which `ω = 1`.
pub(super) fn lacking(method: Method, start: &State<f64, 1>, steps: u64, z: f64) -> f64 {
    let unit = Oscillator { omega2: 1.0 };
    let shift = 1.0 / (z * steps as f64);
    let at = |z: f64| {
        let step = with_method!(method, |m| Linearisation::new(m, unit, start, z)).step;
        let forecast = forecast_drift(unit, &step, start, steps)?;
        let (low, high) = EnergyBand::new(unit, &step)?.drift_after(start, steps);
        Some(1.0 - forecast.drift.to_f64() / low.abs().max(high.abs()))
    };
    let shifted = [-1.0, -0.5, 0.0, 0.5, 1.0].map(|radians| at(z * (1.0 + radians * shift)));
    shifted.into_iter().flatten().fold(0.0, f64::max).min(1.0)
}
