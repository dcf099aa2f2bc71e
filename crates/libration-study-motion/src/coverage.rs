//! Coverage of an invariant curve by a discrete orbit.

use libration::analysis::{EnergyBand, UpdateMatrix, drift_keeps_within, forecast_drift};
use libration::system::Oscillator;
use libration::{Method, State};

/// `d ln D/d ln z` of the largest drift `D` on the curve: how much closer in `z` a search comes than
/// it is in `D`. The methods drift with a power of `z`, but from some starts it is flat in places.
pub(super) fn exponent(method: Method, start: &State<f64, 1>, steps: u64, z: f64) -> f64 {
    let unit = Oscillator { omega2: 1.0 };
    let ln_drift = |z: f64| {
        let step = UpdateMatrix::of_step(method, unit, start, z);
        let (low, high) = EnergyBand::new(unit, &step)?.drift_after(start, steps);
        Some(low.abs().max(high.abs()).ln())
    };
    const PART: f64 = 1e-6;
    let below = ln_drift(z * (1.0 - 2.0 * PART)).zip(ln_drift(z * (1.0 - PART)));
    below.map_or(1.0, |(a, b)| (b - a) / PART)
}

/// How far beyond `z`, relative to it, a run of `steps` steps may still keep its energy within
/// `tolerance`, at which its curve ends: a discrete orbit visits some phases and not others, few of
/// them where some turns are nearly a whole number of steps. That is looked up in powers of the matrix, at
/// many steps and at the one where a search has ended. None if further than anybody looks.
pub(super) fn slack(
    method: Method,
    start: &State<f64, 1>,
    steps: u64,
    (z, ended): (f64, f64),
    tolerance: f64,
) -> Option<f64> {
    const LOOKS: u32 = 32;
    const FURTHEST: f64 = 0.2;
    // Longer runs only visit more.
    const ENOUGH: u64 = 100_000;
    let unit = Oscillator { omega2: 1.0 };
    let beyond = |i: u32| FURTHEST * (f64::from(i) / f64::from(LOOKS)).powi(2);
    let keeps = |z: f64| {
        let step = UpdateMatrix::of_step(method, unit, start, z);
        drift_keeps_within(unit, &step, start, steps.min(ENOUGH), tolerance) == Some(true)
    };
    // A search ends just where the criterion fails.
    let there = if keeps(ended * (1.0 - 1e-6)) { ended / z - 1.0 } else { 0.0 };
    let last = (0..=LOOKS).rev().find(|&i| keeps(z * (1.0 + beyond(i))));
    match last {
        None => Some(there.max(0.0)),
        Some(LOOKS) => None,
        Some(i) => Some(there.max(beyond(i + 1))),
    }
}

/// Whether orbits at `z = ωΔt` turn: at the end of stability and beyond, a start may be one that the
/// step merely repeats or stretches, and no extreme of any curve comes by.
pub(super) fn turns(method: Method, start: &State<f64, 1>, z: f64) -> bool {
    let unit = Oscillator { omega2: 1.0 };
    let step = UpdateMatrix::of_step(method, unit, start, z);
    EnergyBand::new(unit, &step).is_some()
}

/// By which part the largest drift of `steps` steps may stay below that of their curve, at `z = ωΔt`
/// and at slightly larger steps, which shift the last phase by up to four radians: where a turn is
/// nearly a whole number of steps an orbit visits few phases, and a search slips through. The start
/// is in units in which `ω = 1`.
pub(super) fn lacking(method: Method, start: &State<f64, 1>, steps: u64, z: f64) -> f64 {
    let unit = Oscillator { omega2: 1.0 };
    let step = |z: f64| UpdateMatrix::of_step(method, unit, start, z);
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
