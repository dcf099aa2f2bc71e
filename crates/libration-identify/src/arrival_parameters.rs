//! Parameters of a fit of random arrivals.

use libration::linear::Matrix;

use crate::arrivals::{ArrivalFit, ArrivalLaw};
use crate::interval::Interval;
use crate::model::Model;
use crate::parameters::Estimated;
use crate::quantiles::{LEVEL, normal_quantile};

/// All parameters, with normal intervals by the curvature of the likelihood.
pub(crate) fn arrival_parameters(
    fit: &ArrivalFit,
    model: &Model<'_>,
    covariance: Option<&Matrix>,
) -> Vec<Estimated> {
    let error = |i: usize| {
        covariance.map(|covariance| covariance[(i, i)].sqrt()).filter(|error| error.is_finite())
    };
    let quantile = normal_quantile(0.5 + 0.5 * LEVEL);
    let around = |row: Estimated, error: Option<f64>, least: f64| Estimated {
        standard_error: error,
        interval: error.map(|error| Interval {
            low: (row.value - quantile * error).max(least),
            high: Some(row.value + quantile * error),
        }),
        ..row
    };
    let mut rows = Vec::new();
    let mut free = 0;
    for (i, parameter) in model.response.parameters().iter().enumerate() {
        let value = fit.model.shape[i];
        let row = Estimated::plain(parameter.key, parameter.name, parameter.unit, value);
        let is_known = model.known[i].is_some();
        rows.push(if is_known { row } else { around(row, error(free), 0.0) });
        free += usize::from(!is_known);
    }
    for (key, name, value, place) in [
        ("gain", "gain", fit.model.gain, free),
        ("load", "constant load at the input", fit.model.load, free + 1),
    ] {
        let row = Estimated::plain(key, name, "", value);
        let is_known = key == "gain" && model.gain.is_some();
        rows.push(if is_known { row } else { around(row, error(place), f64::NEG_INFINITY) });
    }
    rows.push(Estimated::plain("noise_std", "white noise", "", fit.model.deviation));
    let last = fit.coordinates.len() - 1;
    // The coordinate is the logit.
    let share = |key: &str, name: &str, value: f64| {
        let at = |offset: f64| 1.0 / (1.0 + (-(fit.coordinates[last] + offset)).exp());
        let width = error(last).map(|error| quantile * error);
        Estimated {
            standard_error: width.map(|width| width / quantile * value * (1.0 - value)),
            interval: width.map(|width| Interval { low: at(-width), high: Some(at(width)) }),
            ..Estimated::plain(key, name, "", value)
        }
    };
    match fit.law {
        ArrivalLaw::Certain => {}
        ArrivalLaw::Jitter => {
            let row =
                Estimated::plain("jitter", "jitter of the dead time, rms", "s", fit.model.jitter);
            rows.push(around(row, error(last), 0.0));
        }
        ArrivalLaw::Loss => rows.push(share("loss", "lost commands", fit.model.loss)),
        ArrivalLaw::TwoDelays => {
            let (longer, late) = fit.model.second;
            // Of the sum of both coordinates.
            let sum = covariance
                .filter(|_| model.known[0].is_none())
                .map(|c| c[(0, 0)] + c[(last - 1, last - 1)] + 2.0 * c[(0, last - 1)]);
            let sum = sum.filter(|square| square.is_finite()).map(|square| square.max(0.0).sqrt());
            let value = fit.model.shape[0] + longer;
            let row = Estimated::plain("second_dead_time", "longer dead time", "s", value);
            rows.push(around(row, sum, 0.0));
            rows.push(share("second_share", "share of the longer dead time", late));
        }
    }
    rows
}
