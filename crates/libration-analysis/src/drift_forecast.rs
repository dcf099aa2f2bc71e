//! The largest energy drift of a linear system, without simulating it in floats.

use libration_core::number::{TwoFloat, Wide};
use libration_core::{Elementary, Float, Hamiltonian, Model, Scalar, State};

use super::UpdateMatrix;

/// Steps before the last that are tried where the orbit leaves the range of the search; a growing
/// spiral has its largest energy in its last turn.
const LAST_TURN: u64 = 64;

/// Part by which a drift in double-double exceeds a limit that the exact drift then exceeds too.
const CLEARLY: f64 = 1e-6;

/// The largest relative energy drift of an orbit.
#[derive(Clone, Copy, Debug)]
pub struct DriftForecast {
    /// `|E_n − E₀| / |E₀|` in 1024 bits; it may lie far outside the range of an `f64`.
    pub drift: Wide,
    /// The step `n` at which it is reached.
    pub at_step: u64,
}

impl DriftForecast {
    /// Steps that are searched one by one. Over more of them, an orbit that does not close comes
    /// closer to its extremes by less than a part in 10¹².
    pub const SEARCHED: u64 = 4_000_000;
}

/// The largest relative energy drift within `steps` steps of the linear map `step` from `start`.
///
/// The step `n` of the maximum is found by iterating the map in double-double: step by step, and
/// over longer runs also in strides from the first step to the last, from the best of which it climbs
/// to the top. The drift there is computed from `Mⁿ` in 1024 bits: what is returned carries no visible
/// rounding, and is zero where there is nothing else, below `2⁻¹⁰⁰⁰` for each step. None where the
/// initial energy is zero.
pub fn forecast_drift<const D: usize>(
    model: impl Model<D>,
    step: &UpdateMatrix<Wide, D>,
    start: &State<f64, D>,
    steps: u64,
) -> Option<DriftForecast> {
    forecast(model, step, start, steps, f64::INFINITY)
}

/// Whether the largest relative energy drift of [`forecast_drift`] is at most `limit`. The search stops at the first step that is
/// clearly beyond it. None where the initial energy is zero.
pub fn drift_keeps_within<const D: usize>(
    model: impl Model<D>,
    step: &UpdateMatrix<Wide, D>,
    start: &State<f64, D>,
    steps: u64,
    limit: f64,
) -> Option<bool> {
    let forecast = forecast(model, step, start, steps, limit * (1.0 + CLEARLY))?;
    Some(forecast.drift.to_f64() <= limit)
}

/// The forecast, or one of a step at which the drift exceeds `enough`.
fn forecast<const D: usize>(
    model: impl Model<D>,
    step: &UpdateMatrix<Wide, D>,
    start: &State<f64, D>,
    steps: u64,
    enough: f64,
) -> Option<DriftForecast> {
    let drift = exact_drift(model, step, start)?;
    let searched = steps.min(DriftForecast::SEARCHED);
    let (found, covered) = search(model, step, start, searched, enough);
    let tail = if covered < searched { LAST_TURN } else { 1 };
    let forecast = |n| DriftForecast { drift: drift(n), at_step: n };
    let mut best = forecast(found);
    let mut consider = |n: u64| {
        let next = forecast(n);
        let better = next.drift > best.drift;
        if better {
            best = next;
        }
        better
    };
    (steps.saturating_sub(tail - 1)..=steps).for_each(|n| {
        consider(n);
    });
    // Orbits so slow that the search saw but a part of a turn.
    let stride = steps.div_ceil(DriftForecast::SEARCHED);
    if stride > 1 {
        let (far, _) = search(model, &step.power(stride), start, steps / stride, enough);
        let mut at = far * stride;
        consider(at);
        let mut reach = stride;
        while reach > 0 {
            let near = [at.saturating_sub(reach), (at + reach).min(steps)];
            match near.into_iter().find(|&n| consider(n)) {
                Some(n) => at = n,
                None => reach /= 2,
            }
        }
    }
    Some(best)
}

/// The relative drift after `n` steps as a function of `n`.
fn exact_drift<const D: usize>(
    model: impl Model<D>,
    step: &UpdateMatrix<Wide, D>,
    start: &State<f64, D>,
) -> Option<impl Fn(u64) -> Wide> {
    let (system, start, step) = (model.on::<Wide>(), start.map(Wide::from_f64), *step);
    let initial = system.energy(&start);
    let scale = initial.abs().recip();
    let drift = move |n| {
        let energy = system.energy(&step.power(n).apply(&start));
        let drift = (energy - initial).abs() * scale;
        // n steps of a few operations, each to 2⁻¹⁰²³.
        let rounding = Wide::from_f64(n as f64).scaled(-1000);
        if drift < rounding { Wide::ZERO } else { drift }
    };
    (!initial.is_zero()).then_some(drift)
}

/// The step of the largest drift in double-double, or the first above `enough`, and how many steps stayed finite.
fn search<const D: usize>(
    model: impl Model<D>,
    step: &UpdateMatrix<Wide, D>,
    start: &State<f64, D>,
    steps: u64,
    enough: f64,
) -> (u64, u64) {
    let system = model.on::<TwoFloat>();
    let step = step.map(TwoFloat::from);
    let mut state = start.map(TwoFloat::from_f64);
    let initial = system.energy(&state);
    let enough = initial.abs().hi() * enough;
    let (mut largest, mut at_step) = (TwoFloat::zero(), 0);
    for n in 1..=steps {
        state = step.apply(&state);
        let drift = (system.energy(&state) - initial).abs();
        if !drift.is_finite() {
            return (at_step, n - 1);
        }
        if drift > largest {
            (largest, at_step) = (drift, n);
            if drift.hi() > enough {
                return (n, steps);
            }
        }
    }
    (at_step, steps)
}
