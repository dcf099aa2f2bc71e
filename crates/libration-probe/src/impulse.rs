//! Responses to a change that lasts for one call.

use serde::Serialize;

use crate::BlackBoxError;
use crate::prober::Prober;

/// Calls after which a black box should have forgotten what was before.
pub(crate) const MOST_CALLS: usize = 64;
/// Part of the sum of all sizes below which the parts of a response cancel.
const CANCELS: f64 = 0.1;

/// When results respond to a change that lasts for one call.
#[derive(Clone, Debug, Serialize)]
pub struct Lateness {
    /// The name of the action, `state` or `observation`.
    pub of: String,
    /// The first result that responds, from 0 for that of the same call; none if no result does.
    pub first: Option<usize>,
    /// The last one.
    pub last: Option<usize>,
    /// Calls between the change and the responses on average, weighted with their sizes.
    pub mean: f64,
}

/// The responses to one changed call, from its own: differences of the states in units of the scales, and of the observations.
#[derive(Default)]
pub(crate) struct Response {
    pub(crate) states: Vec<Vec<f64>>,
    pub(crate) observations: Option<Vec<Vec<f64>>>,
}

impl Lateness {
    pub(crate) fn of(name: &str, responses: &[Vec<f64>]) -> Self {
        let responds = |response: &Vec<f64>| response.iter().any(|x| *x != 0.0);
        let first = responses.iter().position(responds);
        let last = responses.iter().rposition(responds);
        Lateness { of: name.to_owned(), first, last, mean: mean_delay(responses) }
    }

    /// That of the component of observations that is the latest.
    pub(crate) fn of_latest(name: &str, responses: &[Vec<f64>]) -> Self {
        let count = responses.first().map_or(0, Vec::len);
        let component = |i: usize| responses.iter().map(|x| vec![x[i]]).collect::<Vec<_>>();
        let all = (0..count).map(|i| Lateness::of(name, &component(i)));
        let latest = all.filter(|found| found.first.is_some());
        latest.max_by(|a, b| a.mean.total_cmp(&b.mean)).unwrap_or_else(|| Lateness::of(name, &[]))
    }
}

/// The mean delay of a response to one changed call, weighted with its parts along the whole response; with its sizes if these cancel.
fn mean_delay(responses: &[Vec<f64>]) -> f64 {
    let count = responses.first().map_or(0, Vec::len);
    let whole: Vec<f64> = (0..count).map(|i| responses.iter().map(|x| x[i]).sum()).collect();
    let along = |x: &[f64]| x.iter().zip(&whole).map(|(a, b)| a * b).sum::<f64>();
    let size = |x: &[f64]| x.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let weighted = |weight: &dyn Fn(&[f64]) -> f64| {
        let weights: Vec<f64> = responses.iter().map(|x| weight(x)).collect();
        let total: f64 = weights.iter().sum();
        let moment: f64 = weights.iter().enumerate().map(|(k, weight)| k as f64 * weight).sum();
        if total > 0.0 { moment / total } else { 0.0 }
    };
    let total: f64 = responses.iter().map(|x| size(x)).sum();
    if size(&whole) > CANCELS * total { weighted(&along) } else { weighted(&size) }
}

/// All states of the subject, moved by different parts of their scales.
pub(crate) fn moved(prober: &Prober<'_>) -> Vec<f64> {
    let subject = prober.subject;
    let shift = |i: usize| (1.0 + i as f64 / 7.0) / 64.0 * subject.state_scale[i];
    subject.state.iter().enumerate().map(|(i, x)| x + shift(i)).collect()
}

/// The responses to one call with another state or action, after an even and after an odd number of calls: their sums.
pub(crate) fn respond(
    prober: &mut Prober<'_>,
    x: &[f64],
    u: &[f64],
) -> Result<Response, BlackBoxError> {
    let mut first = respond_now(prober, x, u)?;
    // One call that counts: the next change comes at the other parity.
    let second = respond_now(prober, x, u)?;
    let add = |a: &mut [Vec<f64>], b: &[Vec<f64>]| {
        a.iter_mut().flatten().zip(b.iter().flatten()).for_each(|(a, b)| *a += b);
    };
    add(&mut first.states, &second.states);
    if let (Some(a), Some(b)) = (&mut first.observations, &second.observations) {
        add(a, b);
    }
    Ok(first)
}

/// A call with the subject's state and action, one with others, and the responses of those that follow.
fn respond_now(prober: &mut Prober<'_>, x: &[f64], u: &[f64]) -> Result<Response, BlackBoxError> {
    let (base_x, base_u) = (&prober.subject.state, &prober.subject.action);
    let base = observed(prober, base_x, base_u)?;
    let scale = &prober.subject.state_scale;
    let mut response = Response::default();
    // With the call before these are an odd number.
    for k in 0..=MOST_CALLS + 1 {
        let (x, u) = if k == 0 { (x, u) } else { (&base_x[..], &base_u[..]) };
        let (next, observation) = observed(prober, x, u)?;
        response.states.push(differences(&next, &base.0, Some(scale)));
        if let (Some(seen), Some(base)) = (&observation, &base.1) {
            response.observations.get_or_insert_default().push(differences(seen, base, None));
        }
    }
    Ok(response)
}

type Seen = (Vec<f64>, Option<Vec<f64>>);

fn observed(prober: &mut Prober<'_>, x: &[f64], u: &[f64]) -> Result<Seen, BlackBoxError> {
    let next = prober.call_one(x, u, prober.subject.dt)?;
    let observation = prober.observe(&next)?;
    Ok((next, observation))
}

/// The differences of two results; any difference of bits counts.
fn differences(a: &[f64], b: &[f64], scale: Option<&[f64]>) -> Vec<f64> {
    let size = |i: usize| scale.map_or(1.0, |scale| scale[i]);
    let apart = |i: usize| {
        let difference = (a[i] - b[i]) / size(i);
        match a[i].to_bits() == b[i].to_bits() {
            true => 0.0,
            false if difference == 0.0 => f64::MIN_POSITIVE,
            false => difference,
        }
    };
    (0..a.len().min(b.len())).map(apart).collect()
}

/// The distance of two results in units of the scales.
pub(crate) fn distance(a: &[f64], b: &[f64], scale: &[f64]) -> f64 {
    differences(a, b, Some(scale)).iter().fold(0.0, |most, x| most.max(x.abs()))
}
