//! The choice of a model.

use libration_work::Work;

use crate::arrivals::{ArrivalFit, ArrivalLaw};
use crate::candidate::{ArrivalRow, CandidateRow};
use crate::estimate::{Estimate, with_each_noise};
use crate::hold::Hold;
use crate::identification::Estimated;
use crate::model::Model;
use crate::recording::Recording;
use crate::request::{IdentifyError, Request};
use crate::response::ResponseKind;

/// The chosen model, and what was tried.
pub(crate) struct Selection {
    pub(crate) estimate: Estimate,
    pub(crate) candidates: Vec<CandidateRow>,
    pub(crate) arrivals: Vec<ArrivalRow>,
    /// What the best law of arrivals adds, if one is clearly better than certain arrivals.
    pub(crate) best_arrival: Option<Vec<Estimated>>,
}

/// A law of arrivals replaces certain ones if Bayes' criterion falls by more: "very strong" evidence of R. E. Kass and A. E. Raftery,
/// Journal of the American Statistical Association 90, 1995.
const STRONG: f64 = 10.0;

pub(crate) fn select(
    recording: &Recording,
    request: &Request,
    largest: f64,
    work: &Work<'_>,
) -> Result<Selection, IdentifyError> {
    let models: Vec<Model> = request
        .responses
        .iter()
        .flat_map(|response| request.holds.iter().map(|&hold| (response.clone(), hold)))
        .map(|(response, hold)| model(response, hold, recording, request, largest))
        .collect();
    let fits = work.sweep("models", &models, |model| {
        let white = Estimate::search(model, recording);
        Ok::<_, IdentifyError>(
            white.map(|white| with_each_noise(&white, recording, &request.noises)),
        )
    })?;
    let mut fits: Vec<Estimate> = fits.into_iter().flatten().flatten().collect();
    fits.sort_by(|a, b| a.criterion().total_cmp(&b.criterion()));
    let best = fits.first().ok_or(IdentifyError::NoFit)?.clone();
    let criterion = best.criterion();
    let candidates = fits.iter().map(|fit| CandidateRow::new(fit, criterion)).collect();
    let mut selection =
        Selection { estimate: best, candidates, arrivals: Vec::new(), best_arrival: None };
    if request.arrivals && selection.estimate.model.hold == Hold::Zero {
        arrivals(&mut selection, &fits, recording, work)?;
    }
    Ok(selection)
}

fn model(
    response: ResponseKind,
    hold: Hold,
    recording: &Recording,
    request: &Request,
    largest: f64,
) -> Model {
    let known = response
        .parameters()
        .iter()
        .map(|parameter| match parameter.key {
            "dead_time" => request.dead_time,
            "lag" => request.lag,
            _ => None,
        })
        .collect();
    Model {
        response,
        hold,
        noise: crate::NoiseKind::White,
        jitter: None,
        gain: request.gain,
        known,
        longest: largest,
        interval: recording.interval(),
    }
}

/// Tries losses, two delays and jitter.
fn arrivals(
    selection: &mut Selection,
    fits: &[Estimate],
    recording: &Recording,
    work: &Work<'_>,
) -> Result<(), IdentifyError> {
    let best = selection.estimate.clone();
    let count = best.regression.residuals.len();
    // Losses and two delays are tried with white noise, of the best form of response.
    let white = fits.iter().find(|fit| {
        fit.model.noise == crate::NoiseKind::White
            && fit.model.hold == Hold::Zero
            && fit.model.response == best.model.response
    });
    let laws = [ArrivalLaw::Certain, ArrivalLaw::Loss, ArrivalLaw::TwoDelays];
    let fitted = match white {
        None => Vec::new(),
        Some(white) => work.sweep("arrivals", &laws, |&law| {
            Ok::<_, IdentifyError>(ArrivalFit::new(law, white, recording))
        })?,
    };
    let fitted: Vec<ArrivalFit> = fitted.into_iter().flatten().collect();
    let jittered = (best.model.response.dynamics(&best.point.shape[1..]).states() > 0)
        .then(|| {
            let gain = best.regression.coefficients[0].abs();
            let unit = gain / best.variance().sqrt();
            best.extended(&Model { jitter: Some(unit), ..best.model.clone() }, recording)
        })
        .flatten();
    let certain = best.criterion();
    let mut rows = vec![ArrivalRow {
        law: "certain",
        parameters: Vec::new(),
        log_likelihood: best.log_likelihood,
        excess: 0.0,
    }];
    if let Some(fit) = &jittered {
        rows.push(ArrivalRow {
            law: "jitter",
            parameters: vec![("jitter".to_owned(), fit.jitter())],
            log_likelihood: fit.log_likelihood,
            excess: fit.criterion() - certain,
        });
    }
    // Of the same filter with certain arrivals, so that both begin in the same way.
    let reference = fitted.iter().find(|fit| fit.law == ArrivalLaw::Certain);
    let reference = reference.map_or(0.0, |fit| fit.criterion(count));
    let base = white.map_or(0.0, |white| white.criterion() - certain);
    for fit in fitted.iter().filter(|fit| fit.law != ArrivalLaw::Certain) {
        let (law, parameters) = match fit.law {
            ArrivalLaw::Loss => ("loss", vec![("loss".to_owned(), fit.loss)]),
            _ => (
                "two-delays",
                vec![
                    ("dead_time".to_owned(), fit.shape[0]),
                    ("second_dead_time".to_owned(), fit.shape[0] + fit.second.0),
                    ("second_share".to_owned(), fit.second.1),
                ],
            ),
        };
        rows.push(ArrivalRow {
            law,
            parameters,
            log_likelihood: fit.log_likelihood,
            excess: base + fit.criterion(count) - reference,
        });
    }
    rows.sort_by(|a, b| a.excess.total_cmp(&b.excess));
    if rows[0].law != "certain" && rows[0].excess < -STRONG {
        selection.best_arrival = Some(arrival_parameters(&rows[0]));
        if rows[0].law == "jitter"
            && let Some(fit) = jittered
        {
            selection.estimate = fit;
        }
    }
    let least = rows[0].excess;
    rows.iter_mut().for_each(|row| row.excess -= least);
    selection.arrivals = rows;
    Ok(())
}

fn arrival_parameters(row: &ArrivalRow) -> Vec<Estimated> {
    let describe = |key: &str| match key {
        "jitter" => ("jitter of arrivals, rms", "s"),
        "loss" => ("lost commands", ""),
        "second_dead_time" => ("longer dead time", "s"),
        "second_share" => ("share of the longer dead time", ""),
        _ => ("shorter dead time", "s"),
    };
    row.parameters
        .iter()
        .map(|(key, value)| {
            let (name, unit) = describe(key);
            let key = if key == "dead_time" { "first_dead_time" } else { key };
            Estimated {
                key: key.to_owned(),
                name: name.to_owned(),
                unit: unit.to_owned(),
                value: *value,
                interval: None,
                standard_error: None,
            }
        })
        .collect()
}
