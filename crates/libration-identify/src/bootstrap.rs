//! Intervals from simulated recordings of a fit.

use libration_work::{Interrupted, Work};
use serde::Serialize;

use crate::estimate::Estimate;
use crate::quantiles::LEVEL;
use crate::recording::Recording;
use crate::simulation::SimulatedLoop;

/// What simulated recordings of a fit give for a parameter.
#[derive(Clone, Debug, Serialize)]
pub struct BootstrapRow {
    /// The parameter.
    pub key: String,
    /// The standard deviation of its estimates.
    pub standard_deviation: f64,
    /// The standard deviation over the standard error by Fisher's information; `null` without the latter.
    pub ratio: Option<f64>,
    /// The 95 % interval of the estimates.
    pub low: f64,
    /// Its upper end.
    pub high: f64,
}

/// Estimates of simulated recordings: for each recording the parameters of the response and the gain.
pub(crate) fn bootstrap(
    estimate: &Estimate<'_>,
    recording: &Recording,
    count: usize,
    seed: u64,
    work: &Work<'_>,
) -> Result<Vec<Vec<f64>>, Interrupted> {
    let simulated = simulated(estimate, recording);
    let window = estimate.model.window(recording);
    // Simulated from the start of the window, whose initial state is known.
    let late = Recording {
        response_times: recording.response_times[window.first..].to_vec(),
        responses: recording.responses[window.first..].to_vec(),
        ..recording.clone()
    };
    let trajectories: Vec<u64> = (0..count as u64).collect();
    let found = work.sweep("bootstrap", &trajectories, |&trajectory| {
        let responses = simulated.responses(&late, seed, trajectory);
        let repeated = late.with_responses(responses);
        let step = 0.1 * estimate.model.interval;
        let model = estimate.model.with_effort(estimate.model.effort.renewed(1));
        let fit = Estimate::from_start(&model, &repeated, &estimate.coordinates, step)
            .filter(|_| !model.effort.is_exhausted());
        Ok::<_, Interrupted>(fit.map(|fit| {
            let mut values = fit.point.shape.clone();
            values.push(fit.regression.coefficients[0]);
            values
        }))
    })?;
    Ok(found.into_iter().flatten().collect())
}

/// The loop of an estimate.
pub(crate) fn simulated(estimate: &Estimate<'_>, recording: &Recording) -> SimulatedLoop {
    let coefficients = &estimate.regression.coefficients;
    let plain = SimulatedLoop {
        gain: coefficients[0],
        load: coefficients[1],
        start: estimate.initial_states(recording),
        hold: estimate.model.hold,
        ..SimulatedLoop::new(estimate.model.response.clone(), &estimate.point.shape)
    };
    plain.with_noise(estimate.point.noise, estimate.variance().sqrt())
}

/// The row of one parameter.
pub(crate) fn row(
    key: &str,
    mut values: Vec<f64>,
    standard_error: Option<f64>,
) -> Option<BootstrapRow> {
    if values.len() < 10 {
        return None;
    }
    values.sort_by(f64::total_cmp);
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let square: f64 = values.iter().map(|x| (x - mean).powi(2)).sum();
    let standard_deviation = (square / (count - 1.0)).sqrt();
    let quantile = |part: f64| {
        let place = part * (count - 1.0);
        let below = values[place.floor() as usize];
        let above = values[place.ceil() as usize];
        below + (place - place.floor()) * (above - below)
    };
    Some(BootstrapRow {
        key: key.to_owned(),
        standard_deviation,
        ratio: standard_error.map(|error| standard_deviation / error),
        low: quantile(0.5 - 0.5 * LEVEL),
        high: quantile(0.5 + 0.5 * LEVEL),
    })
}
