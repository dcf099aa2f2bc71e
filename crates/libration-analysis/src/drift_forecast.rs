//! The largest energy drift of a linear system, without simulating it in floats.

use libration_core::number::{TwoFloat, Wide};
use libration_core::{Elementary, Float, Hamiltonian, Model, Scalar, State};

use super::{QuadraticForm, UpdateMatrix};

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

    /// As [`forecast_drift`], of degrees of freedom that move by the same map, each from its start, with the same energy.
    pub fn of_orbits(
        energy: &QuadraticForm<Wide>,
        step: &UpdateMatrix<Wide>,
        starts: &[State<f64, 1>],
        steps: u64,
    ) -> Option<Self> {
        forecast(energy, step, starts, steps, f64::INFINITY)
    }
}

fn energy_of(model: impl Model<1>) -> QuadraticForm<Wide> {
    let system = model.on::<Wide>();
    QuadraticForm::of(|state| system.energy(state))
}

/// The largest relative energy drift within `steps` steps of the linear map `step` from `start`.
///
/// The step `n` of the maximum is found by iterating the map in double-double: step by step, and
/// over longer runs also in strides from the first step to the last, from the best of which it climbs
/// to the top. The drift there is computed from `Mⁿ` in 1024 bits: what is returned carries no visible
/// rounding, and is zero where there is nothing else, below `2⁻¹⁰⁰⁰` for each step. None where the
/// initial energy is zero.
pub fn forecast_drift(
    model: impl Model<1>,
    step: &UpdateMatrix<Wide>,
    start: &State<f64, 1>,
    steps: u64,
) -> Option<DriftForecast> {
    DriftForecast::of_orbits(&energy_of(model), step, &[*start], steps)
}

/// Whether the largest relative energy drift of [`forecast_drift`] is at most `limit`. The search stops at the first step that is
/// clearly beyond it. None where the initial energy is zero.
pub fn drift_keeps_within(
    model: impl Model<1>,
    step: &UpdateMatrix<Wide>,
    start: &State<f64, 1>,
    steps: u64,
    limit: f64,
) -> Option<bool> {
    let (energy, enough) = (energy_of(model), limit * (1.0 + CLEARLY));
    let forecast = forecast(&energy, step, &[*start], steps, enough)?;
    Some(forecast.drift.to_f64() <= limit)
}

/// The forecast, or one of a step at which the drift exceeds `enough`.
fn forecast(
    energy: &QuadraticForm<Wide>,
    step: &UpdateMatrix<Wide>,
    starts: &[State<f64, 1>],
    steps: u64,
    enough: f64,
) -> Option<DriftForecast> {
    let drift = exact_drift(energy, step, starts)?;
    let searched = steps.min(DriftForecast::SEARCHED);
    let (found, covered) = search(energy, step, starts, searched, enough);
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
        let (far, _) = search(energy, &step.power(stride), starts, steps / stride, enough);
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
fn exact_drift(
    energy: &QuadraticForm<Wide>,
    step: &UpdateMatrix<Wide>,
    starts: &[State<f64, 1>],
) -> Option<impl Fn(u64) -> Wide> {
    let starts: Vec<_> = starts.iter().map(|start| start.map(Wide::from_f64)).collect();
    let sum = move |of: &dyn Fn(&State<Wide, 1>) -> Wide| {
        starts.iter().fold(Wide::ZERO, |sum, start| sum + of(start))
    };
    let (energy, step) = (*energy, *step);
    let initial = sum(&|start| energy.at(start));
    let scale = initial.abs().recip();
    let drift = move |n| {
        let power = step.power(n);
        let energy = sum(&|start| energy.at(&power.apply(start)));
        let drift = (energy - initial).abs() * scale;
        // n steps of a few operations, each to 2⁻¹⁰²³.
        let rounding = Wide::from_f64(n as f64).scaled(-1000);
        if drift < rounding { Wide::ZERO } else { drift }
    };
    (!initial.is_zero()).then_some(drift)
}

/// The step of the largest drift in double-double, or the first above `enough`, and how many steps stayed finite.
fn search(
    energy: &QuadraticForm<Wide>,
    step: &UpdateMatrix<Wide>,
    starts: &[State<f64, 1>],
    steps: u64,
    enough: f64,
) -> (u64, u64) {
    let (energy, step) = (energy.map(TwoFloat::from), step.map(TwoFloat::from));
    let of_all = |states: &[State<TwoFloat, 1>]| {
        states.iter().fold(TwoFloat::zero(), |sum, state| sum + energy.at(state))
    };
    let mut states: Vec<_> = starts.iter().map(|start| start.map(TwoFloat::from_f64)).collect();
    let initial = of_all(&states);
    let enough = initial.abs().hi() * enough;
    let (mut largest, mut at_step) = (TwoFloat::zero(), 0);
    for n in 1..=steps {
        states.iter_mut().for_each(|state| *state = step.apply(state));
        let drift = (of_all(&states) - initial).abs();
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
