//! Whether a response depends on its command, and what a recording that shows no dependence excludes.

use libration_report::notation::number;

use crate::arrivals::spread;
use crate::estimate::Estimate;
use crate::model::Model;
use crate::recording::Recording;
use crate::simulation::SimulatedLoop;
use crate::start::Start;
use crate::summary::seconds;

/// Whether a response depends on its command.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Dependence {
    /// A model with the command is better than one without, by more than chance.
    Shown,
    /// None is, and the command explains at most this share of the variance of the response.
    Excluded(f64),
    /// None is, but for a reason the recording could not show a dependence.
    Undecided(String),
}

/// A gain in log likelihood that has a probability below 10⁻³ if one of a hundred independent dead times is chosen: `½χ²` at 10⁻⁵.
const BY_CHANCE: f64 = 9.8;
/// Least share of the squares of all changes of a command that a response could show.
const LEAST_SHOWN: f64 = 0.5;
/// A command whose whole effect raises the sum of squares by less than this part cannot be told from a load.
const UNSEEN: f64 = 1e-9;
/// The largest share of the variance of a response which is no dependence.
const LARGEST_SHARE: f64 = 0.1;

impl Dependence {
    /// The dependence that `fits` show, the best fit first.
    pub(crate) fn of(fits: &[Estimate<'_>], recording: &Recording) -> Self {
        let Some(best) = fits.first().filter(|best| !is_better_than_none(best, recording)) else {
            return Dependence::Shown;
        };
        let unseen = unseen_changes(&best.model, recording);
        if let Some(reason) = unseen {
            return Dependence::Undecided(reason);
        }
        // A random disturbance explains what any slow command does: the bound is that under the noise of the best fit.
        let alike = fits.iter().filter(|fit| fit.model.noise == best.model.noise);
        let shares = alike.filter_map(|fit| largest_share(fit, recording));
        match shares.reduce(f64::max) {
            Some(share) if share <= LARGEST_SHARE => Dependence::Excluded(share),
            Some(share) => Dependence::Undecided(format!(
                "the command may explain {} % of the variance of the response, which {} responses do not exclude",
                number(100.0 * share.min(1.0), 2),
                best.regression.residuals.len()
            )),
            None => Dependence::Undecided(
                "the effect of the command cannot be told from that of a constant load and of the initial state".to_owned(),
            ),
        }
    }
}

/// Whether a fit is better than one without the command, by more than a search over the dead time gains by chance.
fn is_better_than_none(fit: &Estimate<'_>, recording: &Recording) -> bool {
    let own = fit.model.with_effort(fit.model.effort.renewed(1));
    let model = Model { gain: Some(0.0), ..own };
    // Of noise that is fitted again, without the command.
    let noise = &fit.coordinates[fit.model.free_shape()..];
    let start = [model.free(&fit.point.shape), noise.to_vec()].concat();
    let without = match noise.is_empty() {
        true => Estimate::at(&model, recording, &start),
        false => Estimate::from_start(&model, recording, &start, 0.2 * model.interval),
    };
    without.is_none_or(|without| fit.log_likelihood - without.log_likelihood > BY_CHANCE)
}

/// Why a recording cannot show a response to its command; `None` if it can: most changes, as large as they are, have to lie where each dead
/// time shows them.
fn unseen_changes(model: &Model<'_>, recording: &Recording) -> Option<String> {
    let times = &recording.response_times;
    let first = match model.start {
        Start::Unknown => times[model.window(recording).first],
        Start::Rest | Start::Held => f64::NEG_INFINITY,
    };
    let last = times[times.len() - 1] - model.longest;
    let (mut seen, mut shown, mut all, mut total) = (0, 0.0, 0, 0.0);
    for (pair, &time) in recording.commands.windows(2).zip(&recording.command_times[1..]) {
        let square = (pair[1] - pair[0]).powi(2);
        if square > 0.0 {
            (all, total) = (all + 1, total + square);
            if (first..=last).contains(&time) {
                (seen, shown) = (seen + 1, shown + square);
            }
        }
    }
    (shown < LEAST_SHOWN * total).then(|| {
        format!(
            "{seen} of {all} changes of the command are where each dead time up to {} would show a response",
            seconds(model.longest)
        )
    })
}

/// The largest share of the variance of the response that the command may explain with the dynamics of a fit; `None` if there is no bound.
fn largest_share(fit: &Estimate<'_>, recording: &Recording) -> Option<f64> {
    if fit.model.gain.is_some() {
        return None;
    }
    let first = fit.model.window(recording).first;
    let part = Recording {
        response_times: recording.response_times[first..].to_vec(),
        responses: recording.responses[first..].to_vec(),
        ..recording.clone()
    };
    let plant = fit.model.response.dynamics(&fit.point.shape[1..]);
    let rest = |state: Option<f64>| state.map_or(0.0, |state| state * recording.commands[0]);
    let unit = SimulatedLoop {
        hold: fit.model.hold,
        start: plant.rest().into_iter().map(rest).collect(),
        ..SimulatedLoop::new(fit.model.response.clone(), &fit.point.shape)
    };
    let effect = spread(&unit.responses(&part, 0, 0));
    let own = spread(&part.responses);
    // The sum of squares is quadratic in the gain: its curvature is the information about the gain, with the same dynamics.
    let gain = fit.regression.coefficients[0];
    let at = |gain: f64| {
        let model = Model { gain: Some(gain), ..fit.model.clone() };
        model.regression(model.window(recording), &fit.point).sum_of_squares
    };
    let step = own / effect;
    let risen = at(gain + step) - at(gain);
    let error = (risen > UNSEEN * at(gain)).then(|| step * (fit.variance() / risen).sqrt())?;
    let largest = gain.abs() + 2.0 * error;
    let share = (largest * effect / own).powi(2);
    share.is_finite().then_some(share)
}
