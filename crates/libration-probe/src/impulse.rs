//! Responses to a change that lasts for one call.

use serde::Serialize;

use crate::BlackBoxError;
use crate::prober::Prober;

/// Calls after which a black box should have forgotten what was before.
pub(crate) const MOST_CALLS: usize = 64;

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

/// Sizes of the responses to one changed call, from its own.
#[derive(Default)]
pub(crate) struct Response {
    pub(crate) states: Vec<f64>,
    pub(crate) observations: Option<Vec<f64>>,
}

impl Lateness {
    pub(crate) fn of(name: &str, sizes: &[f64]) -> Self {
        let first = sizes.iter().position(|size| *size > 0.0);
        let last = sizes.iter().rposition(|size| *size > 0.0);
        let total: f64 = sizes.iter().sum();
        let moment: f64 = sizes.iter().enumerate().map(|(k, size)| k as f64 * size).sum();
        let mean = if total > 0.0 { moment / total } else { 0.0 };
        Lateness { of: name.to_owned(), first, last, mean }
    }
}

/// All states of the subject, moved by different parts of their scales.
pub(crate) fn moved(prober: &Prober<'_>) -> Vec<f64> {
    let subject = prober.subject;
    let shift = |i: usize| (1.0 + i as f64 / 7.0) / 64.0 * subject.state_scale[i];
    subject.state.iter().enumerate().map(|(i, x)| x + shift(i)).collect()
}

/// Responses to one call with another state or action, after an even and after an odd number of calls; the larger of both.
pub(crate) fn respond(
    prober: &mut Prober<'_>,
    x: &[f64],
    u: &[f64],
) -> Result<Response, BlackBoxError> {
    let mut first = respond_now(prober, x, u)?;
    // One call that counts: the next change comes at the other parity.
    let second = respond_now(prober, x, u)?;
    let merge = |a: &mut Vec<f64>, b: &[f64]| {
        a.iter_mut().zip(b).for_each(|(a, b)| *a = a.max(*b));
    };
    merge(&mut first.states, &second.states);
    if let (Some(a), Some(b)) = (&mut first.observations, &second.observations) {
        merge(a, b);
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
        response.states.push(distance(&next, &base.0, Some(scale)));
        if let (Some(seen), Some(base)) = (&observation, &base.1) {
            response.observations.get_or_insert_default().push(distance(seen, base, None));
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

/// The distance of two results; any difference of bits counts.
pub(crate) fn distance(a: &[f64], b: &[f64], scale: Option<&[f64]>) -> f64 {
    let size = |i: usize| scale.map_or(1.0, |scale| scale[i]);
    let apart = |i: usize| match a[i].to_bits() == b[i].to_bits() {
        true => 0.0,
        false => ((a[i] - b[i]) / size(i)).abs().max(f64::MIN_POSITIVE),
    };
    (0..a.len().min(b.len())).map(apart).fold(0.0, f64::max)
}
