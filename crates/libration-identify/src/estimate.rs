//! The point of greatest likelihood.

use crate::effort::Effort;
use crate::minimum::simplex;
use crate::model::{Model, Point};
use crate::recording::Recording;
use crate::regression::Regression;
use crate::whitening::Window;

/// A fit of a model to a recording.
#[derive(Clone, Debug)]
pub(crate) struct Estimate<'w> {
    pub(crate) model: Model<'w>,
    /// The coordinates of the point.
    pub(crate) coordinates: Vec<f64>,
    pub(crate) point: Point,
    pub(crate) regression: Regression,
    pub(crate) log_likelihood: f64,
}

/// Most dead times of the first search.
const DEAD_TIMES: usize = 96;
/// Responses of the first search.
const SEARCHED: usize = 1500;
/// Starts of the second search.
const STARTS: usize = 3;
/// The log likelihood is known to this.
pub(crate) const TOLERANCE: f64 = 1e-7;

impl<'w> Estimate<'w> {
    /// The fit from a search over the whole range of the parameters, with the noise at its start.
    pub(crate) fn search(model: &Model<'w>, recording: &Recording) -> Option<Self> {
        let window = model.window(recording);
        let first = busiest(recording, window.first, SEARCHED);
        let end = recording.responses.len().min(first + SEARCHED);
        let short = Recording {
            response_times: recording.response_times[..end].to_vec(),
            responses: recording.responses[..end].to_vec(),
            ..recording.clone()
        };
        let searched = Window { recording: &short, first, ..window };
        // Of three parameters each has fewer values.
        let dead_times = if model.known.len() > 2 { DEAD_TIMES / 3 } else { DEAD_TIMES };
        let grid = (0.5 * model.interval).max(model.longest / dead_times as f64);
        let mut tried: Vec<(f64, Vec<f64>)> = Vec::new();
        let counts = (model.longest / grid).floor() as usize;
        for shape in shapes(model, recording) {
            for i in 0..=counts {
                let mut shape = shape.clone();
                shape[0] = grid * i as f64;
                let cost = model.cost(searched, &model.start(&shape));
                tried.push((cost, shape));
                if model.known[0].is_some() {
                    break;
                }
            }
        }
        tried.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut starts: Vec<Vec<f64>> = Vec::new();
        for (_, shape) in tried.into_iter().filter(|(cost, _)| cost.is_finite()) {
            let is_near = |other: &Vec<f64>| {
                (shape[0] - other[0]).abs() < 2.5 * grid
                    && shape.iter().zip(other).skip(1).all(|(x, y)| x == y)
            };
            if !starts.iter().any(is_near) {
                starts.push(shape);
            }
            if starts.len() == STARTS {
                break;
            }
        }
        let fits = starts.iter().map(|shape| {
            let mut cost = |coordinates: &[f64]| model.cost(searched, coordinates);
            let mut scales = model.shape_scales(shape, 0.5 * grid);
            scales.extend(model.noise_start().1);
            simplex(&mut cost, &model.start(shape), &scales, 1e-3)
        });
        let best = fits.min_by(|a, b| a.value.total_cmp(&b.value))?;
        Self::from_start(model, recording, &best.point, 0.2 * grid)
    }

    /// The fit near these coordinates.
    pub(crate) fn from_start(
        model: &Model<'w>,
        recording: &Recording,
        start: &[f64],
        step: f64,
    ) -> Option<Self> {
        let window = model.window(recording);
        let point = model.point(start)?;
        let mut scales = model.shape_scales(&point.shape, step);
        let shapes = scales.len();
        scales.extend(model.noise_start().1);
        for scale in &mut scales[..shapes] {
            *scale *= 0.5;
        }
        let mut cost = |coordinates: &[f64]| model.cost(window, coordinates);
        let first = simplex(&mut cost, start, &scales, 1e-3);
        // A simplex can collapse; a fresh one finds what is left.
        let scales: Vec<f64> = scales.iter().map(|scale| -0.3 * scale).collect();
        let found = simplex(&mut cost, &first.point, &scales, TOLERANCE);
        Self::at(model, recording, &found.point)
    }

    /// The fit at these coordinates.
    pub(crate) fn at(
        model: &Model<'w>,
        recording: &Recording,
        coordinates: &[f64],
    ) -> Option<Self> {
        let point = model.point(coordinates)?;
        let regression = model.regression(model.window(recording), &point);
        let log_likelihood = regression.log_likelihood();
        log_likelihood.is_finite().then(|| Estimate {
            model: model.clone(),
            coordinates: coordinates.to_vec(),
            point,
            regression,
            log_likelihood,
        })
    }

    /// The fit of the same response with another noise, from this one.
    pub(crate) fn extended(&self, model: &Model<'w>, recording: &Recording) -> Option<Self> {
        Self::from_start(model, recording, &model.start(&self.point.shape), 0.2 * model.interval)
    }

    /// The same fit, for further searches of another effort.
    pub(crate) fn with_effort<'v>(&self, effort: Effort<'v>) -> Estimate<'v> {
        Estimate {
            model: self.model.with_effort(effort),
            coordinates: self.coordinates.clone(),
            point: self.point.clone(),
            regression: self.regression.clone(),
            log_likelihood: self.log_likelihood,
        }
    }

    /// The number of estimated numbers: coordinates, coefficients, and the variance of the noise.
    pub(crate) fn parameters(&self) -> usize {
        self.model.coordinates() + self.regression.solved + 1
    }

    /// Whether the response has states.
    pub(crate) fn has_states(&self) -> bool {
        self.regression.coefficients.len() > 2
    }

    /// Bayes' information criterion, lower for the better model (G. Schwarz, Annals of Statistics 6, 1978).
    pub(crate) fn criterion(&self) -> f64 {
        let count = self.regression.residuals.len() as f64;
        self.parameters() as f64 * count.ln() - 2.0 * self.log_likelihood
    }

    /// The variance of the noise, corrected for the estimated coefficients.
    pub(crate) fn variance(&self) -> f64 {
        let count = self.regression.residuals.len();
        let free = count.saturating_sub(self.regression.solved + self.model.free_shape()).max(1);
        self.regression.sum_of_squares / free as f64
    }

    /// The standard deviation of independent errors of the measurement.
    pub(crate) fn white_deviation(&self) -> f64 {
        (self.variance() * self.point.noise.white).sqrt()
    }
}

/// The first of `count` responses, from `first` on, during which the command changes most.
pub(crate) fn busiest(recording: &Recording, first: usize, count: usize) -> usize {
    let times = &recording.response_times;
    if times.len() <= first + count {
        return first;
    }
    // The sum of all changes up to each response.
    let mut next = 1;
    let mut sum = 0.0;
    let sums: Vec<f64> = times
        .iter()
        .map(|&time| {
            while next < recording.commands.len() && recording.command_times[next] <= time {
                sum += (recording.commands[next] - recording.commands[next - 1]).abs();
                next += 1;
            }
            sum
        })
        .collect();
    let change = |i: usize| sums[i + count - 1] - sums[i];
    let starts = first..times.len() - count + 1;
    let most = starts.clone().map(change).fold(0.0, f64::max);
    let mut busiest = starts.filter(|&i| change(i) >= (1.0 - 1e-9) * most);
    let earliest = busiest.next().unwrap_or(first);
    // Of windows with the same changes, as of a single step, one that has the responses before them and three times as many behind them.
    let latest = busiest.next_back().unwrap_or(earliest);
    latest - (latest - earliest) / 4
}

/// Parameters behind the dead time with which a search begins.
fn shapes(model: &Model<'_>, recording: &Recording) -> Vec<Vec<f64>> {
    let (interval, span) = (model.interval, recording.span());
    // From less than an interval to a part of the recording, four per decade.
    let per_decade = if model.known.len() > 2 { 3.0 } else { 4.0 };
    let decades = (0.2 * span / interval).log10().clamp(0.0, 6.0);
    let count = (per_decade * decades).ceil() as i32;
    let times = (0..=count).map(|i| 0.5 * interval * 10.0_f64.powf(f64::from(i) / per_decade));
    let zetas = [0.15, 0.6, 1.5];
    let all: Vec<Vec<f64>> = match model.response.parameters().len() {
        1 => vec![vec![0.0]],
        2 => [0.0].into_iter().chain(times).map(|time| vec![0.0, time]).collect(),
        _ => times.flat_map(|time| zetas.iter().map(move |&zeta| vec![0.0, time, zeta])).collect(),
    };
    let with_known = |shape: Vec<f64>| -> Vec<f64> {
        shape.iter().zip(&model.known).map(|(x, known)| known.unwrap_or(*x)).collect()
    };
    let mut all: Vec<Vec<f64>> = all.into_iter().map(with_known).collect();
    all.dedup();
    all
}
