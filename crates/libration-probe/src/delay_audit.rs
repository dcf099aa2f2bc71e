//! Which command each step uses, over many steps.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::BlackBoxError;
use crate::linearised_step::LinearisedStep;
use crate::prober::Prober;

/// Steps of the audit of a command that is late, and of one that is not.
const STEPS: [usize; 2] = [100_000, 2_000];
/// Steps after which the ramp begins anew.
const RAMP: usize = 256;
/// Its first ones, in which commands of the ramp before may act: any delay that a memory can have.
const SKIPPED: usize = 64;
/// Calls between measurements of the responses, so that a fault now and then is no part of most of them.
const PAUSES: [usize; 5] = [0, 1, 2, 4, 7];
/// Parts of a step to which delays are rounded.
const PARTS: f64 = 1000.0;

/// The delays of a command that waits in a queue of the simulator.
#[derive(Clone, Debug, Serialize)]
pub struct DelayAudit {
    /// The name of the input.
    pub input: String,
    /// Steps that were audited.
    pub steps: usize,
    /// Delays in steps, to a thousandth, and the number of steps that used them.
    pub delays: Vec<(f64, usize)>,
    /// The first step whose delay differs from that of the first ones; none if all are the same.
    pub first_change: Option<usize>,
}

impl DelayAudit {
    /// The mean delay in steps.
    pub fn mean(&self) -> f64 {
        let total: f64 = self.delays.iter().map(|(delay, count)| delay * *count as f64).sum();
        total / self.steps as f64
    }

    /// Commands one input by a ramp. The state is the same at each step, so that the result shows the command that was used.
    pub(crate) fn run(
        prober: &mut Prober<'_>,
        step: &LinearisedStep,
        input: usize,
        is_late: bool,
    ) -> Result<Option<Self>, BlackBoxError> {
        let subject = prober.subject;
        let (x, u, dt) = (&subject.state, &subject.action, subject.dt);
        let response = |i: usize| (step.b[(i, input)] / subject.state_scale[i]).abs();
        let shown = (0..x.len()).max_by(|&i, &j| response(i).total_cmp(&response(j)));
        let Some(shown) = shown.filter(|i| response(*i) > 0.0) else { return Ok(None) };
        let span = subject.action_scale[input] / 16.0;
        let ramp = |phase: usize| {
            let mut action = u.clone();
            action[input] += span * (phase as f64 / RAMP as f64);
            action
        };
        // The response to each command of the ramp, which need not be linear.
        let mut measured = vec![Vec::new(); RAMP];
        for pause in PAUSES {
            for _ in 0..pause {
                prober.call_one(x, u, dt)?;
            }
            for (phase, all) in measured.iter_mut().enumerate() {
                all.push(prober.step_one(x, &ramp(phase), dt)?[shown]);
            }
        }
        let responses: Vec<f64> = measured.into_iter().map(median).collect();
        let mut counts: BTreeMap<i64, usize> = BTreeMap::new();
        let (mut start, mut first_change) = (None, None);
        let steps = if is_late { STEPS[0] } else { STEPS[1] };
        let mut audited = 0;
        for k in 0.. {
            if audited == steps {
                break;
            }
            let phase = k % RAMP;
            let response = prober.call_one(x, &ramp(phase), dt)?[shown];
            if k < RAMP || phase < SKIPPED {
                continue;
            }
            audited += 1;
            let Some(used) = place(&responses, response) else { return Ok(None) };
            let delay = ((phase as f64 - used) * PARTS).round() as i64;
            *counts.entry(delay).or_default() += 1;
            if *start.get_or_insert(delay) != delay {
                first_change.get_or_insert(k);
            }
        }
        let delays =
            counts.into_iter().map(|(delay, count)| (delay as f64 / PARTS, count)).collect();
        let input = subject.inputs[input].name.clone();
        Ok(Some(DelayAudit { input, steps, delays, first_change }))
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Where a response lies between those of the ramp, in samples; none if these neither rise nor fall throughout.
fn place(responses: &[f64], response: f64) -> Option<f64> {
    let rises = responses[1] > responses[0];
    let before = |a: f64, b: f64| if rises { a < b } else { a > b };
    if !responses.windows(2).all(|pair| before(pair[0], pair[1])) {
        return None;
    }
    let next = responses.partition_point(|r| before(*r, response)).clamp(1, responses.len() - 1);
    let [low, high] = [responses[next - 1], responses[next]];
    Some((next - 1) as f64 + (response - low) / (high - low))
}
