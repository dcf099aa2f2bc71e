//! Fits of lost commands and of two dead times.

use crate::arrival_filter::{Start, Trace, log_likelihood};
use crate::estimate::Estimate;
use crate::hypothesis::{ArrivalModel, MOST_STATES};
use crate::minimum::{restarted, within};
use crate::model::Model;
use crate::noise::NoiseKind;
use crate::recording::Recording;

/// A law of arrivals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ArrivalLaw {
    /// Every command arrives after the dead time.
    Certain,
    /// The dead time of a command is normally distributed.
    Jitter,
    /// Some commands are lost.
    Loss,
    /// Some commands arrive after a longer dead time.
    TwoDelays,
}

impl ArrivalLaw {
    /// All laws, certain arrivals first.
    pub(crate) const ALL: [ArrivalLaw; 4] =
        [ArrivalLaw::Certain, ArrivalLaw::Jitter, ArrivalLaw::Loss, ArrivalLaw::TwoDelays];

    /// The name in results.
    pub(crate) fn name(self) -> &'static str {
        match self {
            ArrivalLaw::Certain => "certain",
            ArrivalLaw::Jitter => "jitter",
            ArrivalLaw::Loss => "loss",
            ArrivalLaw::TwoDelays => "two-delays",
        }
    }
}

/// A fit of a law of arrivals.
#[derive(Clone, Debug)]
pub(crate) struct ArrivalFit {
    pub(crate) law: ArrivalLaw,
    pub(crate) model: ArrivalModel,
    pub(crate) log_likelihood: f64,
    pub(crate) parameters: usize,
    /// Free parameters of the response, gain, load, logarithm of the noise relative to that of the base, then the logit of the loss, or
    /// what the longer dead time adds and the logit of its share, or the jitter.
    pub(crate) coordinates: Vec<f64>,
}

/// Starts of a search.
const STARTS: usize = 2;
/// Most calls per coordinate of each simplex of a search, and of the fit to all responses.
const ROUGH_CALLS: usize = 40;
const FINE_CALLS: usize = 60;
/// Hypotheses about the acting command of each response, in the mean: steps of the effort.
const HYPOTHESES: usize = 2;
/// Responses of a search, before all of them.
const SEARCHED: usize = 500;

/// What is fixed during a search.
pub(crate) struct ArrivalSearch<'a> {
    pub(crate) model: Model<'a>,
    pub(crate) recording: &'a Recording,
    law: ArrivalLaw,
    start: Start,
    /// The standard deviation of the noise of the base.
    deviation: f64,
    pub(crate) scales: Vec<f64>,
    starts: Vec<Vec<f64>>,
    /// Coefficients of the base that are no coordinates.
    hidden: usize,
}

impl<'a> ArrivalSearch<'a> {
    /// A search from a fit in which all commands arrive; `None` if its plant has too many states.
    pub(crate) fn new(
        law: ArrivalLaw,
        base: &Estimate<'a>,
        recording: &'a Recording,
    ) -> Option<Self> {
        let model = Model { noise: NoiseKind::White, ..base.model.clone() };
        let states = base.initial_states(recording);
        if states.len() > MOST_STATES {
            return None;
        }
        let deviation = base.variance().sqrt();
        let first = model.window(recording).first;
        let start = Start { first, responses: usize::MAX, states, variance: deviation * deviation };
        let [gain, load] = [0, 1].map(|i| base.regression.coefficients[i]);
        let shape = &base.point.shape;
        let period = median_period(recording);
        let common = |earlier: f64, noise: f64| {
            let mut shape = shape.clone();
            shape[0] = (shape[0] - earlier).max(0.0);
            let mut coordinates = model.free(&shape);
            coordinates.extend([gain, load, noise]);
            coordinates
        };
        // Arrivals that vary look like a longer lag: of independent delays variances add up, and that of a lag is its square.
        let apart = |longer: f64, share: f64| {
            let mut shape = shape.clone();
            let lag = shape.get(1).copied().unwrap_or(0.0);
            let left =
                (lag * lag - share * (1.0 - share) * longer * longer).max(0.04 * lag * lag).sqrt();
            shape[0] = (shape[0] + lag - left - share * longer).max(0.0);
            shape.iter_mut().skip(1).take(1).for_each(|lag| *lag = left);
            let mut coordinates = model.free(&shape);
            coordinates.extend([gain, load, -0.7]);
            coordinates
        };
        let logit = |share: f64| (share / (1.0 - share)).ln();
        let starts = match law {
            ArrivalLaw::Certain => vec![common(0.0, 0.0)],
            ArrivalLaw::Jitter => [0.1, 0.3, 1.0]
                .iter()
                .map(|&periods: &f64| {
                    [common(0.0, -0.7), vec![periods * period.min(model.longest)]].concat()
                })
                .collect(),
            // Losses delay commands that are repeated: without them the dead time is shorter.
            ArrivalLaw::Loss => [0.02, 0.1, 0.3, 0.5]
                .iter()
                .flat_map(|&loss: &f64| {
                    [0.0, loss / (1.0 - loss) * period].map(|earlier| (loss, earlier))
                })
                .map(|(loss, earlier)| [common(earlier, -0.7), vec![logit(loss)]].concat())
                .collect(),
            ArrivalLaw::TwoDelays => [0.5, 1.0, 2.0, 4.0]
                .iter()
                .flat_map(|&periods| [0.1, 0.3, 0.6].map(|share| (periods * period, share)))
                .flat_map(|(longer, share): (f64, f64)| {
                    let own = vec![longer, logit(share)];
                    [common(share * longer, -0.7), apart(longer, share)]
                        .map(|start| [start, own.clone()].concat())
                })
                .collect(),
        };
        let size = gain.abs().max(1e-9);
        let mut scales = model.shape_scales(shape, 0.2 * model.interval);
        scales.extend([0.05 * size, 0.05 * size * spread(&recording.commands), 0.3]);
        match law {
            ArrivalLaw::Certain => {}
            ArrivalLaw::Jitter => scales.push(0.1 * period),
            ArrivalLaw::Loss => scales.push(0.8),
            ArrivalLaw::TwoDelays => scales.extend([0.3 * period, 0.8]),
        }
        let hidden = base.regression.solved.saturating_sub(2);
        Some(ArrivalSearch { model, recording, law, start, deviation, scales, starts, hidden })
    }

    /// The fit of greatest likelihood of the first responses, with its likelihood of all.
    pub(crate) fn rough(&self) -> Option<ArrivalFit> {
        let mut cost = |coordinates: &[f64]| self.cost_of(coordinates, SEARCHED);
        let mut rough: Vec<(f64, &Vec<f64>)> =
            self.starts.iter().map(|start| (cost(start), start)).collect();
        rough.retain(|(cost, _)| cost.is_finite());
        rough.sort_by(|a, b| a.0.total_cmp(&b.0));
        let found = rough
            .into_iter()
            .take(STARTS)
            .map(|(_, start)| within(&mut cost, start, &self.scales, 0.1, ROUGH_CALLS))
            .min_by(|a, b| a.value.total_cmp(&b.value))?;
        let found = restarted(&mut cost, &found.point, &self.scales, 0.1, ROUGH_CALLS);
        self.fit_of(self.cost(&found.point), found.point)
    }

    /// The fit near these coordinates.
    pub(crate) fn fit_near(&self, start: &[f64]) -> Option<ArrivalFit> {
        let mut cost = |coordinates: &[f64]| self.cost(coordinates);
        let fresh: Vec<f64> = self.scales.iter().map(|scale| 0.3 * scale).collect();
        let found = restarted(&mut cost, start, &fresh, 1e-2, FINE_CALLS);
        self.fit_of(found.value, found.point)
    }

    fn fit_of(&self, cost: f64, coordinates: Vec<f64>) -> Option<ArrivalFit> {
        Some(ArrivalFit {
            law: self.law,
            model: self.arrival_model(&coordinates)?,
            log_likelihood: -cost,
            parameters: coordinates.len() + self.hidden,
            coordinates,
        })
    }

    /// The parameters of these coordinates; `None` outside of the model.
    fn arrival_model(&self, coordinates: &[f64]) -> Option<ArrivalModel> {
        let free = self.model.free_shape();
        let shape = self.model.point(&coordinates[..free])?.shape;
        let logistic = |x: f64| 1.0 / (1.0 + (-x).exp());
        let rest = &coordinates[free..];
        if !(rest.iter().all(|x| x.is_finite()) && rest[2].abs() < 20.0) {
            return None;
        }
        let mut model = ArrivalModel {
            shape,
            gain: self.model.gain.unwrap_or(rest[0]),
            load: rest[1],
            deviation: self.deviation * rest[2].exp(),
            jitter: 0.0,
            loss: 0.0,
            second: (0.0, 0.0),
        };
        match self.law {
            ArrivalLaw::Certain => {}
            ArrivalLaw::Jitter => {
                model.jitter = rest[3].abs();
                if model.jitter > self.model.longest {
                    return None;
                }
            }
            ArrivalLaw::Loss => model.loss = logistic(rest[3]),
            ArrivalLaw::TwoDelays => {
                model.second = (rest[3], logistic(rest[4]));
                if rest[3] <= 0.0 || model.shape[0] + rest[3] > self.model.longest {
                    return None;
                }
            }
        }
        Some(model)
    }

    /// The number of responses.
    pub(crate) fn count(&self) -> usize {
        self.recording.responses.len() - self.start.first
    }

    pub(crate) fn cost(&self, coordinates: &[f64]) -> f64 {
        self.cost_of(coordinates, usize::MAX)
    }

    /// The negative log likelihood of the first responses.
    fn cost_of(&self, coordinates: &[f64], responses: usize) -> f64 {
        let model = self.arrival_model(coordinates);
        model.filter(|_| self.model.effort.spend(HYPOTHESES * responses.min(self.count()))).map_or(
            f64::INFINITY,
            |model| {
                let plant = self.model.response.dynamics(&model.shape[1..]);
                let start = Start { responses, ..self.start.clone() };
                -log_likelihood(self.recording, &plant, &model, &start, None)
            },
        )
    }

    /// What the responses leave behind at these coordinates; `None` outside of the model.
    pub(crate) fn trace(&self, coordinates: &[f64]) -> Option<Trace> {
        let model = self.arrival_model(coordinates)?;
        let plant = self.model.response.dynamics(&model.shape[1..]);
        let mut trace = Trace::default();
        let value = log_likelihood(self.recording, &plant, &model, &self.start, Some(&mut trace));
        value.is_finite().then_some(trace)
    }

    /// Normal scores of the responses, which are independent if the model holds.
    pub(crate) fn scores(&self, fit: &ArrivalFit) -> Vec<f64> {
        self.trace(&fit.coordinates).unwrap_or_default().scores
    }
}

impl ArrivalFit {
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

/// The standard deviation.
pub(crate) fn spread(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    (values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt()
}
