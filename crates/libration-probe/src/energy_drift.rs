//! Drift of the energy along a trajectory, and its reason.

use serde::Serialize;

use crate::BlackBoxError;
use crate::convergence::displaced;
use crate::prober::Prober;

/// Periods of the slowest mode that a trajectory should have, and the most steps for them.
const PERIODS: f64 = 20.0;
const MOST_STEPS: usize = 100_000;
/// Steps of a trajectory of a system that conserves its energy, where a slow drift matters.
const CONSERVATIVE_STEPS: usize = 20_000;
/// Those of other systems.
const STEPS: usize = 2_000;
/// Part of the scales by which the state is displaced.
const DISPLACEMENT: f64 = 0.1;
/// Drifts per step below this, relative to the energy of the displacement, are roundings.
const ROUNDING: f64 = 1e-13;

/// The drift of the energy.
#[derive(Clone, Debug, Serialize)]
pub struct EnergyDrift {
    /// Rate of the energy in 1/s, relative to that of a displacement from an equilibrium; else to the energy itself.
    pub rate: f64,
    /// The same with half the step.
    pub rate_halved: Option<f64>,
    /// Steps of the trajectory.
    pub steps: usize,
    /// The smallest rate that the trajectory resolves, in 1/s.
    pub resolution: f64,
    /// The reason.
    pub reason: DriftReason,
}

/// Why an energy drifts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum DriftReason {
    /// It does not, within the resolution.
    None,
    /// The rate falls with the step.
    Truncation,
    /// The rate does not depend on the step: the system is not conservative.
    System,
    /// The rate grows when the step is halved.
    Rounding,
    /// The trajectory leaves the finite numbers.
    Divergence,
    /// The simulator has one step only.
    Unknown,
    /// The rate changes little with the step, but is not the same.
    Unclear,
    /// The trajectory has few periods of the slowest mode, and its oscillation looks like a drift.
    Short,
}

impl DriftReason {
    /// The reason in words.
    pub fn text(self) -> &'static str {
        match self {
            DriftReason::None => "no drift within the resolution",
            DriftReason::Truncation => "truncation: the rate falls with the step",
            DriftReason::System => "the system itself: the rate does not depend on the step",
            DriftReason::Rounding => "rounding: the rate grows when the step is halved",
            DriftReason::Divergence => "the trajectory diverges",
            DriftReason::Unclear => {
                "unknown: the rate neither falls with the step nor stays the same"
            }
            DriftReason::Short => "unknown: the trajectory has few periods of the slowest mode",
            DriftReason::Unknown => "unknown: the simulator has one step only",
        }
    }
}

impl EnergyDrift {
    /// The drift over a trajectory from a displaced state; none if the energy is unknown.
    pub(crate) fn measure(
        prober: &mut Prober<'_>,
        longest_period: f64,
        is_at_rest: bool,
    ) -> Result<Option<Self>, BlackBoxError> {
        let subject = prober.subject;
        let start = displaced(prober, DISPLACEMENT);
        let (Some(rest), Some(energy)) = (prober.energy(&subject.state)?, prober.energy(&start)?)
        else {
            return Ok(None);
        };
        let least = if subject.is_conservative { CONSERVATIVE_STEPS } else { STEPS };
        let wanted = PERIODS * longest_period / subject.dt;
        let steps = least.max((wanted as usize).min(MOST_STEPS)) / 2 * 2;
        let is_short = wanted > 2.0 * steps as f64;
        let size = if is_at_rest { energy - rest } else { energy };
        let size = size.abs().max(f64::MIN_POSITIVE);
        let Some(full) = rate(prober, &start, subject.dt, steps, size)? else {
            return Ok(Some(EnergyDrift {
                rate: f64::INFINITY,
                rate_halved: None,
                steps,
                resolution: 0.0,
                reason: DriftReason::Divergence,
            }));
        };
        let halved = match subject.has_fixed_dt {
            true => None,
            false => rate(prober, &start, subject.dt / 2.0, 2 * steps, size)?,
        };
        let rounding = ROUNDING / subject.dt * (energy.abs() / size).max(1.0);
        let resolution = full.wobble.max(rounding);
        let reason = match &halved {
            _ if full.rate.abs() <= resolution => DriftReason::None,
            _ if is_short => DriftReason::Short,
            None => DriftReason::Unknown,
            Some(half) => {
                let ratio = full.rate.abs() / half.rate.abs().max(f64::MIN_POSITIVE);
                match ratio {
                    0.97..=1.03 => DriftReason::System,
                    ratio if ratio > 1.25 => DriftReason::Truncation,
                    ratio if ratio < 0.8 => DriftReason::Rounding,
                    _ => DriftReason::Unclear,
                }
            }
        };
        let rate_halved = halved.as_ref().map(|half| half.rate);
        Ok(Some(EnergyDrift { rate: full.rate, rate_halved, steps, resolution, reason }))
    }
}

struct Rate {
    rate: f64,
    /// How far the rates of parts of the trajectory are apart because the energy oscillates.
    wobble: f64,
}

/// The rate of the energy: the difference of smooth averages over the halves of a trajectory. None if it diverges.
fn rate(
    prober: &mut Prober<'_>,
    start: &[f64],
    dt: f64,
    steps: usize,
    size: f64,
) -> Result<Option<Rate>, BlackBoxError> {
    let action = &prober.subject.action;
    let mut x = start.to_vec();
    let mut energies = Vec::with_capacity(steps);
    for _ in 0..steps {
        match prober.advance(&x, action, dt) {
            Ok(next) => x = next,
            Err(BlackBoxError::NotFinite { .. }) => return Ok(None),
            Err(error) => return Err(error),
        }
        let Some(energy) = prober.energy(&x)? else { return Ok(None) };
        energies.push(energy / size);
    }
    let span = |part: core::ops::Range<usize>| {
        let middle = (part.start + part.end) / 2;
        let time = (part.end - part.start) as f64 / 2.0 * dt;
        (average(&energies[middle..part.end]) - average(&energies[part.start..middle])) / time
    };
    let whole = span(0..steps);
    // A shift of the window moves the phase of an oscillation, but no drift.
    let shift = steps / 50;
    let others = [span(shift..steps), span(0..steps - shift), span(shift / 3..steps - shift / 2)];
    let wobble = others.iter().map(|other| (other - whole).abs()).fold(0.0, f64::max);
    Ok(Some(Rate { rate: whole, wobble }))
}

/// The average with the weights of a squared sine, squared: an oscillation leaves the fifth power of its period over the window.
fn average(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    let weight = |k: usize| (core::f64::consts::PI * (k as f64 + 0.5) / n).sin().powi(4);
    let total: f64 = (0..values.len()).map(weight).sum();
    values.iter().enumerate().map(|(k, value)| weight(k) * value).sum::<f64>() / total
}
