//! How the influence of earlier calls fades.

use serde::Serialize;

use crate::BlackBoxError;
use crate::decay::{GONE, decay, is_gone};
use crate::impulse::{MOST_CALLS, distance, moved};
use crate::prober::Prober;

/// Calls until the influence must be gone.
const PATIENCE: usize = 4096;
/// Largest factor by which a slow decay may be off its prediction over all calls.
const FADED: f64 = 3.0;

/// The influence of earlier calls that fades as that of a filter does.
#[derive(Clone, Debug, Serialize)]
pub struct Settling {
    /// Whether it is that of earlier commands alone, or that of earlier states; none if it lasts too long to tell them apart.
    pub is_of_commands: Option<bool>,
    /// Its factor per call.
    pub factor: f64,
    /// Its time constant in s, if it fades with the time of the steps.
    pub time_constant: f64,
    /// Whether results are the same bits in the end.
    pub is_settled: bool,
}

impl Settling {
    /// None if results do not settle: they vary at random, or the influence does not fade.
    pub(crate) fn measure(prober: &mut Prober<'_>) -> Result<Option<Self>, BlackBoxError> {
        let subject = prober.subject;
        let scales = subject.action.iter().zip(&subject.action_scale);
        let changed: Vec<f64> = scales.map(|(u, scale)| u + scale / 64.0).collect();
        let Some(factor) = disturb(prober, &moved(prober), &changed)? else { return Ok(None) };
        let (is_settled, change) = settle(prober)?;
        // What does not fade as predicted is no filter but a clock, for example.
        if !is_settled && change > FADED * factor.powi(PATIENCE as i32).max(GONE) {
            return Ok(None);
        }
        let is_of_commands = match is_settled {
            true => Some(disturb(prober, &moved(prober), &subject.action)?.is_none()),
            false => None,
        };
        let time_constant = -subject.dt / factor.ln();
        let (is_settled, _) = settle(prober)?;
        Ok(Some(Settling { is_of_commands, factor, time_constant, is_settled }))
    }
}

/// Calls with the subject's state and action until the results of four in a row are the same: whether they are in the end, and how far
/// the last two are apart, in parts of the first two.
fn settle(prober: &mut Prober<'_>) -> Result<(bool, f64), BlackBoxError> {
    let subject = prober.subject;
    let (mut same, mut first, mut change) = (0, None, 0.0);
    let mut last = prober.call_one(&subject.state, &subject.action, subject.dt)?;
    for _ in 0..PATIENCE {
        let next = prober.call_one(&subject.state, &subject.action, subject.dt)?;
        change = distance(&next, &last, &subject.state_scale);
        first.get_or_insert(change);
        same = if is_gone(change) { same + 1 } else { 0 };
        if same == 3 {
            return Ok((true, 0.0));
        }
        last = next;
    }
    Ok((false, change / first.unwrap_or(1.0).max(f64::MIN_POSITIVE)))
}

/// The factor per call by which results settle after calls with another state or action; none if they do not, or do at once.
fn disturb(prober: &mut Prober<'_>, x: &[f64], u: &[f64]) -> Result<Option<f64>, BlackBoxError> {
    let subject = prober.subject;
    for _ in 0..MOST_CALLS {
        prober.call_one(x, u, subject.dt)?;
    }
    let mut results = Vec::new();
    for _ in 0..MOST_CALLS {
        results.push(prober.call_one(&subject.state, &subject.action, subject.dt)?);
    }
    let apart = |pair: &[Vec<f64>]| distance(&pair[0], &pair[1], &subject.state_scale);
    Ok(decay(&results.windows(2).map(apart).collect::<Vec<_>>(), MOST_CALLS / 8))
}
