//! The likelihood of commands that may be lost, or arrive after one of two dead times.
//!
//! Which command acts is a hidden state. Hypotheses about it are filters, whose number is kept small: those that agree are merged to their
//! mean and covariance, and those that weigh least are dropped (Y. Bar-Shalom, X. R. Li and T. Kirubarajan, *Estimation with Applications
//! to Tracking and Navigation*, 2001, section 11.6).

use std::f64::consts::TAU;

use crate::hypothesis::{ArrivalModel, Hypothesis, MOST_STATES, merge_alike, prune};
use crate::plant_step::PlantSteps;
use crate::quantiles::{normal_probability, normal_quantile};
use crate::recording::Recording;
use crate::response::UnitPlant;

/// Where a filter begins.
#[derive(Clone, Debug)]
pub(crate) struct Start {
    /// The first response.
    pub(crate) first: usize,
    /// Most responses.
    pub(crate) responses: usize,
    /// States there, and their variance.
    pub(crate) states: Vec<f64>,
    pub(crate) variance: f64,
}

/// What each response leaves behind.
#[derive(Clone, Debug, Default)]
pub(crate) struct Trace {
    /// Normal scores.
    pub(crate) scores: Vec<f64>,
    /// Parts of the log likelihood.
    pub(crate) terms: Vec<f64>,
}

/// The log likelihood of a recording, and its trace if one is wanted.
pub(crate) fn log_likelihood(
    recording: &Recording,
    plant: &UnitPlant,
    model: &ArrivalModel,
    start: &Start,
    mut trace: Option<&mut Trace>,
) -> f64 {
    let n = plant.states();
    let (times, values) = (&recording.command_times[..], &recording.commands[..]);
    let events = events(model, times);
    let mut steps = PlantSteps::new(plant, false);
    let mut now = recording.response_times[start.first];
    let mut next = events.partition_point(|event| event.time <= now);
    let acting = times.partition_point(|t| t + model.shape[0] <= now).saturating_sub(1);
    let mut first = Hypothesis {
        acting,
        weight: 1.0,
        mean: [0.0; MOST_STATES],
        covariance: [[0.0; MOST_STATES]; MOST_STATES],
    };
    for i in 0..n {
        first.mean[i] = start.states.get(i).copied().unwrap_or(0.0);
        first.covariance[i][i] = start.variance;
    }
    let mut hypotheses = vec![first];
    let mut log_likelihood = 0.0;
    let count = recording.responses.len() - start.first;
    for i in start.first..start.first + count.min(start.responses) {
        let end = recording.response_times[i];
        while let Some(event) = events.get(next).filter(|event| event.time <= end) {
            let k = event.command;
            if hypotheses.iter().any(|h| h.acting < k && values[h.acting] != values[k]) {
                advance(&mut hypotheses, &mut steps, event.time - now, values, model);
                now = event.time.max(now);
            }
            branch(&mut hypotheses, event, values, plant, model.gain);
            next += 1;
        }
        advance(&mut hypotheses, &mut steps, end - now, values, model);
        now = end;
        let response = recording.responses[i];
        let mut below = 0.0;
        let mut total = 0.0;
        for h in &mut hypotheses {
            let (error, spread) = h.measure(plant, model, values, response);
            if trace.is_some() {
                below += h.weight * normal_probability(error / spread.sqrt());
            }
            h.weight *= (-0.5 * error * error / spread).exp() / (TAU * spread).sqrt();
            total += h.weight;
        }
        // Each hypothesis is excluded by more than the range of floats.
        if total <= 0.0 || total.is_nan() {
            return f64::NEG_INFINITY;
        }
        if let Some(trace) = &mut trace {
            trace.scores.push(normal_quantile(below));
            trace.terms.push(total.ln());
        }
        log_likelihood += total.ln();
        hypotheses.iter_mut().for_each(|h| h.weight /= total);
        prune(&mut hypotheses);
    }
    log_likelihood
}

/// A possible arrival of a command.
#[derive(Clone, Copy, Debug)]
struct Event {
    time: f64,
    command: usize,
    /// The probability that it comes now if it has not come before.
    chance: f64,
    /// The standard deviation of the time.
    spread: f64,
}

/// A normal law as a mixture of narrower ones: offsets and weights, in standard deviations. Within each the effect of a shift is linear.
const NARROW: [(f64, f64); 7] = [
    (-1.95, 0.02702),
    (-1.30, 0.10158),
    (-0.65, 0.22487),
    (0.00, 0.29306),
    (0.65, 0.22487),
    (1.30, 0.10158),
    (1.95, 0.02702),
];
/// The standard deviation of each, with which the mixture has the variance of the normal law: `1 − Σ w δ²`.
const NARROW_DEVIATION: f64 = 0.5110;

/// Possible arrivals in the order of time.
fn events(model: &ArrivalModel, times: &[f64]) -> Vec<Event> {
    let (longer, late) = model.second;
    // Delay beyond the dead time, probability, and spread.
    let mut parts = vec![(0.0, 1.0 - late, 0.0)];
    if late > 0.0 {
        parts.push((longer, late, 0.0));
    }
    if model.jitter > 0.0 {
        let part = |(offset, weight): (f64, f64)| {
            (offset * model.jitter, weight, NARROW_DEVIATION * model.jitter)
        };
        parts = NARROW.map(part).to_vec();
    }
    let mut events = Vec::with_capacity(parts.len() * times.len());
    let mut before = 0.0;
    for &(delay, weight, spread) in &parts {
        let probability = weight * (1.0 - model.loss);
        let chance = (probability / (1.0 - before)).min(1.0);
        before += probability;
        let delay = model.shape[0] + delay;
        let event =
            |(command, time): (usize, &f64)| Event { time: time + delay, command, chance, spread };
        events.extend(times.iter().enumerate().map(event));
    }
    if parts.len() > 1 {
        events.sort_by(|a, b| a.time.total_cmp(&b.time));
    }
    events
}

/// Moves all hypotheses on by `h` seconds.
fn advance(
    hypotheses: &mut [Hypothesis],
    steps: &mut PlantSteps<'_>,
    h: f64,
    values: &[f64],
    model: &ArrivalModel,
) {
    if h > 0.0 {
        let step = steps.step(h);
        hypotheses.iter_mut().for_each(|hypothesis| hypothesis.advance(step, values, model));
    }
}

/// A command comes with its probability where an older command acts.
fn branch(
    hypotheses: &mut Vec<Hypothesis>,
    event: &Event,
    values: &[f64],
    plant: &UnitPlant,
    gain: f64,
) {
    let k = event.command;
    for i in 0..hypotheses.len() {
        let h = &mut hypotheses[i];
        if h.acting >= k {
            continue;
        }
        let change = values[k] - values[h.acting];
        // Whether an equal command comes changes nothing.
        if change == 0.0 {
            h.acting = k;
            continue;
        }
        let mut arrived = Hypothesis { acting: k, weight: h.weight * event.chance, ..*h };
        if event.spread > 0.0 {
            arrived.shift(plant, gain * change * event.spread);
        }
        if event.chance < 1.0 {
            h.weight *= 1.0 - event.chance;
            hypotheses.push(arrived);
        } else {
            *h = arrived;
        }
    }
    merge_alike(hypotheses);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn narrow_laws_together_have_the_moments_of_a_normal_one() {
        let moment = |of: fn(f64, f64) -> f64| -> f64 {
            NARROW.iter().map(|&(offset, weight)| weight * of(offset, NARROW_DEVIATION)).sum()
        };
        assert!((moment(|_, _| 1.0) - 1.0).abs() < 1e-12);
        assert!(moment(|d, _| d).abs() < 1e-12);
        assert!((moment(|d, s| d * d + s * s) - 1.0).abs() < 1e-3);
        // A fourth moment of 3, to the digits of which the grid of five is capable.
        let fourth = moment(|d, s| d.powi(4) + 6.0 * d * d * s * s + 3.0 * s.powi(4));
        assert!((fourth - 3.0).abs() < 0.3, "{fourth}");
    }
}
