//! Commands that are lost, and commands that arrive after one of two dead times.
//!
//! Which command acts is a hidden state of the filter. Hypotheses with the same acting command are merged to their mean and covariance
//! (the second-order pseudo-Bayesian filter: Y. Bar-Shalom, X. R. Li and T. Kirubarajan, *Estimation with Applications to Tracking and
//! Navigation*, 2001, section 11.6).

use std::f64::consts::TAU;

use crate::estimate::Estimate;
use crate::minimum::simplex;
use crate::model::Model;
use crate::plant_step::PlantSteps;
use crate::recording::Recording;
use crate::response::UnitPlant;

/// A law of arrivals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ArrivalLaw {
    /// Every command arrives after the dead time.
    Certain,
    /// Some commands are lost.
    Loss,
    /// Some commands arrive after a longer dead time.
    TwoDelays,
}

/// A fit of a law of arrivals.
#[derive(Clone, Debug)]
pub(crate) struct ArrivalFit {
    pub(crate) law: ArrivalLaw,
    /// Parameters of the response, the dead time first.
    pub(crate) shape: Vec<f64>,
    pub(crate) gain: f64,
    pub(crate) load: f64,
    /// Standard deviation of the noise.
    pub(crate) deviation: f64,
    pub(crate) loss: f64,
    /// What a longer dead time adds, in s, and the share of commands that it delays.
    pub(crate) second: (f64, f64),
    pub(crate) log_likelihood: f64,
    pub(crate) parameters: usize,
    /// Coordinates of the fit: see [`Coordinates`].
    pub(crate) coordinates: Vec<f64>,
}

/// Most hypotheses at a time.
const MOST_HYPOTHESES: usize = 12;
/// The least weight of a hypothesis relative to the heaviest.
const LIGHTEST: f64 = 1e-8;

#[derive(Clone, Debug)]
struct Hypothesis {
    acting: usize,
    weight: f64,
    mean: Vec<f64>,
    covariance: Vec<f64>,
}

/// What is fixed during a search.
struct Search<'a> {
    model: &'a Model,
    recording: &'a Recording,
    law: ArrivalLaw,
    first: usize,
    /// States at the first response, and the variance of what is not known of them.
    start: Vec<f64>,
    start_variance: f64,
    deviation: f64,
}

impl ArrivalFit {
    /// Fits a law of arrivals, from a fit in which all commands arrive.
    pub(crate) fn new(law: ArrivalLaw, base: &Estimate, recording: &Recording) -> Option<Self> {
        let model = &base.model;
        let start: Vec<f64> = base.regression.coefficients[2..].to_vec();
        let deviation = base.variance().sqrt();
        let first = model.window(recording).first;
        let search = Search {
            model,
            recording,
            law,
            first,
            start,
            start_variance: deviation * deviation,
            deviation,
        };
        let coefficients = &base.regression.coefficients;
        let common = |shape: &[f64], noise: f64| {
            let mut coordinates = model.free(shape);
            coordinates.extend([coefficients[0], coefficients[1], noise]);
            coordinates
        };
        let shape = &base.point.shape;
        let period = median_period(recording);
        let starts: Vec<Vec<f64>> = match law {
            ArrivalLaw::Certain => vec![common(shape, 0.0)],
            ArrivalLaw::Loss => [-3.5, -1.5]
                .iter()
                .map(|&loss| [common(shape, -0.7), vec![loss]].concat())
                .collect(),
            ArrivalLaw::TwoDelays => [1.0, 2.0, 4.0]
                .iter()
                .flat_map(|&periods| [0.2, 0.5, 0.8].map(|share| (periods * period, share)))
                .map(|(longer, share): (f64, f64)| {
                    let mut shorter = shape.clone();
                    shorter[0] = (shape[0] - share * longer).max(0.0);
                    [common(&shorter, -0.7), vec![longer, (share / (1.0 - share)).ln()]].concat()
                })
                .collect(),
        };
        let mut scales = model.shape_scales(shape, 0.2 * model.interval);
        scales.extend([
            0.05 * coefficients[0].abs().max(1e-9),
            0.05 * coefficients[0].abs().max(1e-9) * search.command_size(),
            0.3,
        ]);
        match law {
            ArrivalLaw::Certain => {}
            ArrivalLaw::Loss => scales.push(0.8),
            ArrivalLaw::TwoDelays => scales.extend([0.3 * period, 0.8]),
        }
        let mut cost = |coordinates: &[f64]| search.cost(coordinates);
        let rough: Vec<(f64, &Vec<f64>)> =
            starts.iter().map(|start| (cost(start), start)).collect();
        let mut rough: Vec<_> = rough.into_iter().filter(|(cost, _)| cost.is_finite()).collect();
        rough.sort_by(|a, b| a.0.total_cmp(&b.0));
        let best = rough
            .into_iter()
            .take(2)
            .map(|(_, start)| {
                let found = simplex(&mut cost, start, &scales, 1e-5);
                let fresh: Vec<f64> = scales.iter().map(|scale| -0.3 * scale).collect();
                simplex(&mut cost, &found.point, &fresh, 1e-6)
            })
            .min_by(|a, b| a.value.total_cmp(&b.value))?;
        let parts = search.parts(&best.point)?;
        let parameters = best.point.len() + base.regression.solved.saturating_sub(2);
        Some(ArrivalFit {
            law,
            shape: parts.shape,
            gain: parts.gain,
            load: parts.load,
            deviation: parts.deviation,
            loss: parts.loss,
            second: parts.second,
            log_likelihood: -best.value,
            parameters,
            coordinates: best.point,
        })
    }

    /// Bayes' information criterion.
    pub(crate) fn criterion(&self, count: usize) -> f64 {
        self.parameters as f64 * (count as f64).ln() - 2.0 * self.log_likelihood
    }
}

/// The median time between commands, in s.
pub(crate) fn median_period(recording: &Recording) -> f64 {
    let times = &recording.command_times;
    let mut periods: Vec<f64> =
        times.windows(2).map(|pair| pair[1] - pair[0]).filter(|&period| period > 0.0).collect();
    periods.sort_by(f64::total_cmp);
    periods.get(periods.len() / 2).copied().unwrap_or_else(|| recording.interval())
}

/// The parts of a point.
struct Parts {
    shape: Vec<f64>,
    gain: f64,
    load: f64,
    deviation: f64,
    loss: f64,
    second: (f64, f64),
}

impl Search<'_> {
    fn command_size(&self) -> f64 {
        let values = &self.recording.commands;
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let square: f64 = values.iter().map(|x| (x - mean).powi(2)).sum();
        (square / values.len() as f64).sqrt()
    }

    /// The meaning of coordinates: free parameters of the response, gain, load, logarithm of the noise relative to that of the base, then
    /// the logit of the loss, or what the longer dead time adds and the logit of its share.
    fn parts(&self, coordinates: &[f64]) -> Option<Parts> {
        let free = self.model.free_shape();
        let white = Model { noise: crate::NoiseKind::White, jitter: None, ..self.model.clone() };
        let shape = white.point(&coordinates[..free])?.shape;
        let logistic = |x: f64| 1.0 / (1.0 + (-x).exp());
        let rest = &coordinates[free..];
        let mut parts = Parts {
            shape,
            gain: self.model.gain.unwrap_or(rest[0]),
            load: rest[1],
            deviation: self.deviation * rest[2].exp(),
            loss: 0.0,
            second: (0.0, 0.0),
        };
        match self.law {
            ArrivalLaw::Certain => {}
            ArrivalLaw::Loss => parts.loss = logistic(rest[3]),
            ArrivalLaw::TwoDelays => {
                parts.second = (rest[3], logistic(rest[4]));
                if rest[3] <= 0.0 || parts.shape[0] + rest[3] > self.model.longest {
                    return None;
                }
            }
        }
        (rest.iter().all(|x| x.is_finite()) && rest[2].abs() < 20.0).then_some(parts)
    }

    fn cost(&self, coordinates: &[f64]) -> f64 {
        let Some(parts) = self.parts(coordinates) else { return f64::INFINITY };
        let plant = self.model.response.dynamics(&parts.shape[1..]);
        -self.log_likelihood(&plant, &parts)
    }

    fn log_likelihood(&self, plant: &UnitPlant, parts: &Parts) -> f64 {
        let n = plant.states();
        let (times, values) = (&self.recording.command_times[..], &self.recording.commands[..]);
        let events = self.events(parts);
        let mut steps = PlantSteps::new(plant, false);
        let mut now = self.recording.response_times[self.first];
        let mut next = events.partition_point(|event| event.0 <= now);
        let acting = times.partition_point(|t| t + parts.shape[0] <= now).saturating_sub(1);
        let mut covariance = vec![0.0; n * n];
        (0..n).for_each(|i| covariance[i * n + i] = self.start_variance);
        let mut mean = vec![0.0; n];
        mean.iter_mut().zip(&self.start).for_each(|(x, start)| *x = *start);
        let mut hypotheses = vec![Hypothesis { acting, weight: 1.0, mean, covariance }];
        let variance = parts.deviation * parts.deviation;
        let mut log_likelihood = 0.0;
        for i in self.first..self.recording.responses.len() {
            let end = self.recording.response_times[i];
            while let Some(&(arrival, k, chance)) = events.get(next).filter(|event| event.0 <= end)
            {
                let is_new =
                    hypotheses.iter().any(|h| h.acting < k && values[h.acting] != values[k]);
                if is_new {
                    advance(&mut hypotheses, &mut steps, arrival - now, values, parts);
                    now = arrival.max(now);
                }
                branch(&mut hypotheses, k, chance, values);
                next += 1;
            }
            advance(&mut hypotheses, &mut steps, end - now, values, parts);
            now = end;
            let response = self.recording.responses[i];
            let mut total = 0.0;
            for h in &mut hypotheses {
                let direct = plant.d * (parts.gain * values[h.acting] + parts.load);
                let predicted: f64 =
                    plant.c.iter().zip(&h.mean).map(|(c, x)| c * x).sum::<f64>() + direct;
                let gains: Vec<f64> = (0..n)
                    .map(|i| (0..n).map(|j| h.covariance[i * n + j] * plant.c[j]).sum())
                    .collect();
                let spread = variance + plant.c.iter().zip(&gains).map(|(c, g)| c * g).sum::<f64>();
                let error = response - predicted;
                h.weight *= (-0.5 * error * error / spread).exp() / (TAU * spread).sqrt();
                for i in 0..n {
                    h.mean[i] += gains[i] / spread * error;
                    for j in 0..n {
                        h.covariance[i * n + j] -= gains[i] * gains[j] / spread;
                    }
                }
                total += h.weight;
            }
            if !(total > 0.0) {
                // Each hypothesis is excluded by more than the range of floats.
                return f64::NEG_INFINITY;
            }
            log_likelihood += total.ln();
            hypotheses.iter_mut().for_each(|h| h.weight /= total);
            prune(&mut hypotheses);
        }
        log_likelihood
    }

    /// Arrivals in the order of time: time, command, and the probability that it comes now if it has not come before.
    fn events(&self, parts: &Parts) -> Vec<(f64, usize, f64)> {
        let (longer, late) = parts.second;
        let early = (1.0 - late) * (1.0 - parts.loss);
        let mut events = Vec::with_capacity(2 * self.recording.commands.len());
        for (k, time) in self.recording.command_times.iter().enumerate() {
            events.push((time + parts.shape[0], k, early));
            if late > 0.0 {
                let chance = late * (1.0 - parts.loss) / (1.0 - early);
                events.push((time + parts.shape[0] + longer, k, chance));
            }
        }
        events.sort_by(|a, b| a.0.total_cmp(&b.0));
        events
    }
}

/// Moves all hypotheses on by `h` seconds, each under its command.
fn advance(
    hypotheses: &mut [Hypothesis],
    steps: &mut PlantSteps<'_>,
    h: f64,
    values: &[f64],
    parts: &Parts,
) {
    if !(h > 0.0) {
        return;
    }
    let step = steps.step(h);
    let n = step.gamma.len();
    for hypothesis in hypotheses {
        let command = parts.gain * values[hypothesis.acting] + parts.load;
        let row = |i: usize| &step.phi[i * n..(i + 1) * n];
        hypothesis.mean = (0..n)
            .map(|i| {
                let free: f64 = row(i).iter().zip(&hypothesis.mean).map(|(p, x)| p * x).sum();
                free + step.gamma[i] * command
            })
            .collect();
        let half: Vec<f64> = (0..n * n)
            .map(|place| {
                let (i, j) = (place / n, place % n);
                (0..n).map(|k| row(i)[k] * hypothesis.covariance[k * n + j]).sum()
            })
            .collect();
        hypothesis.covariance = (0..n * n)
            .map(|place| {
                let (i, j) = (place / n, place % n);
                (0..n).map(|k| half[i * n + k] * row(j)[k]).sum()
            })
            .collect();
    }
}

/// Command `k` comes with probability `chance`, where an older command acts.
fn branch(hypotheses: &mut Vec<Hypothesis>, k: usize, chance: f64, values: &[f64]) {
    let mut arrived: Option<Hypothesis> = None;
    let mut kept: Vec<Hypothesis> = Vec::with_capacity(hypotheses.len() + 1);
    for mut h in hypotheses.drain(..) {
        if h.acting >= k {
            kept.push(h);
            continue;
        }
        // Whether an equal command comes changes nothing.
        let chance = if values[h.acting] == values[k] { 1.0 } else { chance };
        if chance < 1.0 {
            kept.push(Hypothesis { weight: h.weight * (1.0 - chance), ..h.clone() });
        }
        h.weight *= chance;
        h.acting = k;
        arrived = Some(match arrived {
            None => h,
            Some(other) => merged(other, h),
        });
    }
    kept.extend(arrived);
    *hypotheses = kept;
}

/// Both hypotheses as one with their mean and covariance.
fn merged(a: Hypothesis, b: Hypothesis) -> Hypothesis {
    let weight = a.weight + b.weight;
    if !(weight > 0.0) {
        return a;
    }
    let (share_a, share_b) = (a.weight / weight, b.weight / weight);
    let n = a.mean.len();
    let between = |i: usize| a.mean[i] - b.mean[i];
    let covariance = (0..n * n)
        .map(|place| {
            share_a * a.covariance[place]
                + share_b * b.covariance[place]
                + share_a * share_b * between(place / n) * between(place % n)
        })
        .collect();
    let mean = a.mean.iter().zip(&b.mean).map(|(x, y)| share_a * x + share_b * y).collect();
    Hypothesis { acting: a.acting, weight, mean, covariance }
}

/// Drops hypotheses that weigh nothing.
fn prune(hypotheses: &mut Vec<Hypothesis>) {
    hypotheses.sort_by(|a, b| b.weight.total_cmp(&a.weight));
    let heaviest = hypotheses[0].weight;
    hypotheses.retain(|h| h.weight >= LIGHTEST * heaviest);
    hypotheses.truncate(MOST_HYPOTHESES);
}
