//! Whether the errors of a linear model depend on levels or directions, as those of a plant with a dead zone, a limit or friction do.
//!
//! A score test (C. R. Rao, Proceedings of the Cambridge Philosophical Society 44, 1948): what a nonlinear element would add to the
//! innovations is compared with them, once all that the parameters of the model may add is removed.

use libration_report::notation::number;
use serde::Serialize;

use crate::estimate::Estimate;
use crate::hold::Hold;
use crate::quantiles::chi_squared_tail;
use crate::recording::Recording;
use crate::residuals::CONTRADICTION;
use crate::whitening::{Whitened, Window, whiten};

/// Probabilities of innovations that depend at least as much on levels and directions, if the plant is linear.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct LinearityTests {
    /// The probability for levels of the command; `null` if it has too few to show them, such as two.
    pub command_levels: Option<f64>,
    /// The probability for levels of the response.
    pub response_levels: Option<f64>,
    /// The probability for the direction of command and response.
    pub directions: Option<f64>,
    /// The probability for parameters that change in the course of the log.
    pub course: Option<f64>,
}

/// A column with less than this part of its length left is explained by the others: what is left is mostly the error of derivatives.
const LEAST_LEFT: f64 = 0.03;
/// Derivatives by parameters are taken over this part of an interval of the responses, or of a parameter.
const DIFFERENCE: f64 = 1e-3;
/// Parts of the values at which slopes may change.
const QUANTILES: [f64; 5] = [0.1, 0.3, 0.5, 0.7, 0.9];
/// Dead zones around zero, as parts of the largest value.
const ZONES: [f64; 2] = [0.1, 0.3];
/// Plays, as parts of half the range of a signal.
const PLAYS: [f64; 2] = [0.05, 0.15];

impl LinearityTests {
    /// The tests of a fit; `scores` are independent innovations, if those of the fit are not.
    pub(crate) fn of(
        estimate: &Estimate<'_>,
        recording: &Recording,
        scores: Option<&[f64]>,
    ) -> Self {
        let model = &estimate.model;
        let window = model.window(recording);
        let whitened = model.whitened(window, &estimate.point);
        let innovations = scores.unwrap_or(&estimate.regression.residuals);
        let (known, effects) = nuisances(estimate, window, &whitened);
        let plant = model.response.dynamics(&estimate.point.shape[1..]);
        let dead_time = estimate.point.shape[0];
        let roots: Vec<f64> = whitened.scales.iter().map(|scale| scale.sqrt()).collect();
        // The effect of another command, and another response, behind the filter of the fit.
        let through = |command: &Recording, dead_time: f64, hold: Hold| -> Vec<f64> {
            let window = Window { recording: command, hold, ..window };
            let found = whiten(window, &plant, dead_time, estimate.point.noise);
            found.regressors.iter().step_by(found.columns).zip(&roots).map(|(x, r)| x / r).collect()
        };
        let beside = |response: Vec<f64>| -> Vec<f64> {
            let other = recording.with_responses(response);
            let window = Window { recording: &other, ..window };
            let found = whiten(window, &plant, dead_time, estimate.point.noise);
            found.responses.iter().zip(&roots).map(|(x, r)| x / r).collect()
        };
        let commanded = |commands: Vec<f64>| {
            through(&Recording { commands, ..recording.clone() }, dead_time, model.hold)
        };
        // Each response as the filter predicts it from those before it.
        let mut predicted = recording.responses.clone();
        let own = estimate.regression.residuals.iter().zip(&roots);
        for (response, (residual, root)) in predicted[window.first..].iter_mut().zip(own) {
            *response -= residual * root;
        }
        let forced = |forces: Vec<f64>| {
            let times = recording.response_times.clone();
            let forces = Recording { command_times: times, commands: forces, ..recording.clone() };
            through(&forces, 0.0, Hold::Zero)
        };
        let rates: Vec<f64> =
            [0.0].into_iter().chain(predicted.windows(2).map(|pair| pair[1] - pair[0])).collect();
        let of_rates = |f: fn(f64) -> f64| rates.iter().map(|&rate| f(rate)).collect::<Vec<f64>>();
        let mut directions: Vec<Vec<f64>> =
            plays(&recording.commands).into_iter().map(commanded).collect();
        directions.extend(plays(&predicted).into_iter().map(beside));
        directions.push(beside(of_rates(f64::signum)));
        if plant.states() > 0 {
            directions.push(forced(of_rates(f64::signum)));
            directions.push(forced(of_rates(f64::abs)));
            directions.push(forced(of_rates(|rate| rate * rate.abs())));
        }
        let levels = |values: &[f64]| bends(values).into_iter();
        LinearityTests {
            command_levels: known
                .probability(innovations, levels(&recording.commands).map(commanded)),
            response_levels: known.probability(innovations, levels(&predicted).map(beside)),
            directions: known.probability(innovations, directions.into_iter()),
            course: known.robust_probability(innovations, effects.into_iter().map(ramped)),
        }
    }

    /// The levels and directions that contradict a linear plant, in words.
    pub(crate) fn contradictions(&self) -> Vec<String> {
        let named = [
            (
                "the level of the command",
                "a dead zone, a limit or a coarse command",
                self.command_levels,
            ),
            (
                "the level of the response",
                "a dead zone or a limit of the sensor",
                self.response_levels,
            ),
            ("the direction of the motion", "backlash or friction", self.directions),
            (
                "the time",
                "a dead time, gain or offset that changes in the course of the log",
                self.course,
            ),
        ];
        named
            .into_iter()
            .filter_map(|(on, such, p)| Some((on, such, p.filter(|p| *p < CONTRADICTION)?)))
            .map(|(on, such, p)| {
                format!("they depend on {on} (p = {}), as with {such}", number(p, 2))
            })
            .collect()
    }

    /// Whether the innovations contradict a linear plant.
    pub fn contradict(&self) -> bool {
        !self.contradictions().is_empty()
    }
}

/// Directions that are explained, as orthonormal columns.
#[derive(Clone, Default)]
struct Basis(Vec<Vec<f64>>);

impl Basis {
    /// The part of a column that no other one explains, of unit length.
    fn left(&self, mut column: Vec<f64>) -> Option<Vec<f64>> {
        let before = length(&column);
        // Twice is enough (B. N. Parlett, The Symmetric Eigenvalue Problem, 1980, section 6.9).
        for _ in 0..2 {
            for other in &self.0 {
                let share: f64 = other.iter().zip(&column).map(|(x, y)| x * y).sum();
                column.iter_mut().zip(other).for_each(|(x, y)| *x -= share * y);
            }
        }
        let left = length(&column);
        let is_left = left.is_finite() && left > LEAST_LEFT * before;
        is_left.then(|| column.iter().map(|x| x / left).collect())
    }

    /// The probability of white innovations that agree with these columns at least as well; `None` if no column is left.
    fn probability(
        &self,
        innovations: &[f64],
        columns: impl Iterator<Item = Vec<f64>>,
    ) -> Option<f64> {
        let power = innovations.iter().map(|x| x * x).sum::<f64>() / innovations.len() as f64;
        self.tail(innovations, columns, |_| power)
    }

    /// The same where the power of innovations may be another one at each of them, as random dead times make it behind changes of the
    /// command (H. White, Econometrica 48, 1980).
    fn robust_probability(
        &self,
        innovations: &[f64],
        columns: impl Iterator<Item = Vec<f64>>,
    ) -> Option<f64> {
        self.tail(innovations, columns, |products| products.iter().map(|x| x * x).sum())
    }

    /// The probability of a sum of squares, one for each column: of its products with the innovations, in units of their `power`.
    fn tail(
        &self,
        innovations: &[f64],
        columns: impl Iterator<Item = Vec<f64>>,
        power: impl Fn(&[f64]) -> f64,
    ) -> Option<f64> {
        let mut basis = self.clone();
        let (mut statistic, mut count) = (0.0, 0);
        for column in columns {
            let Some(left) = basis.left(column) else { continue };
            let products: Vec<f64> = left.iter().zip(innovations).map(|(x, y)| x * y).collect();
            let (share, power) = (products.iter().sum::<f64>(), power(&products));
            if power > 0.0 {
                statistic += share * share / power;
                count += 1;
            }
            basis.0.push(left);
        }
        (count > 0).then(|| chi_squared_tail(statistic, f64::from(count)))
    }
}

/// A column that grows from one end of the log to the other.
fn ramped(column: Vec<f64>) -> Vec<f64> {
    let last = column.len().max(2) as f64 - 1.0;
    column.into_iter().enumerate().map(|(k, x)| x * (k as f64 / last - 0.5)).collect()
}

fn length(column: &[f64]) -> f64 {
    column.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// The changes of the innovations by each parameter of a fit, to both sides: the likelihood has a kink where an arrival meets a sample.
/// The space that they span, and each of them.
fn nuisances(
    estimate: &Estimate<'_>,
    window: Window<'_>,
    whitened: &Whitened,
) -> (Basis, Vec<Vec<f64>>) {
    let model = &estimate.model;
    let columns = whitened.columns;
    let (mut basis, mut effects) = (Basis::default(), Vec::new());
    let mut add = |column: Vec<f64>| {
        let left = basis.left(column);
        effects.extend(left.clone());
        basis.0.extend(left);
    };
    for column in 0..columns {
        let regressor = whitened.regressors.iter().skip(column).step_by(columns);
        add(regressor.zip(&whitened.scales).map(|(x, scale)| x / scale.sqrt()).collect());
    }
    let coefficients = &estimate.regression.coefficients;
    let residual = |whitened: &Whitened, k: usize| {
        let row = &whitened.regressors[k * columns..(k + 1) * columns];
        whitened.responses[k] - row.iter().zip(coefficients).map(|(x, c)| x * c).sum::<f64>()
    };
    for i in 0..model.free_shape() {
        let step = DIFFERENCE * estimate.coordinates[i].abs().max(model.interval);
        for side in [step, -step] {
            let mut moved = estimate.coordinates.clone();
            moved[i] += side;
            let Some(point) = model.point(&moved) else { continue };
            let other = model.whitened(window, &point);
            if other.columns == columns {
                let root = |k: usize| whitened.scales[k].sqrt();
                let change = |k| (residual(&other, k) - residual(whitened, k)) / root(k);
                add((0..whitened.responses.len()).map(change).collect());
            }
        }
    }
    (basis, effects)
}

/// Functions of a signal that bend at some of its levels.
fn bends(values: &[f64]) -> Vec<Vec<f64>> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let level = |part: f64| sorted[(part * (sorted.len() - 1) as f64) as usize];
    let largest = sorted[0].abs().max(sorted[sorted.len() - 1].abs());
    let hinges = QUANTILES
        .map(|part| values.iter().map(|x| (x - level(part)).max(0.0)).collect::<Vec<f64>>());
    let zones = ZONES.map(|part| {
        let zone = part * largest;
        values.iter().map(|x| x.clamp(-zone, zone)).collect::<Vec<f64>>()
    });
    hinges.into_iter().chain(zones).collect()
}

/// A signal behind plays of some widths.
fn plays(values: &[f64]) -> Vec<Vec<f64>> {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let behind = |part: f64| {
        let half = 0.5 * part * (high - low);
        let mut state = values[0];
        values
            .iter()
            .map(|&x| {
                state = state.clamp(x - half, x + half);
                state
            })
            .collect()
    };
    PLAYS.into_iter().map(behind).collect()
}
