//! What a step remembers of earlier calls: late commands, late states and late observations.

use serde::Serialize;

use crate::impulse::{Lateness, MOST_CALLS, moved, respond};
use crate::observation_age::ObservationAge;
use crate::observed::Observed;
use crate::prober::Prober;
use crate::settling::Settling;
use crate::{BlackBoxError, DelayAudit};

/// The influence of a call on the results of later ones.
///
/// All calls have the same state and action but one, in which a single action or all states differ. The results that differ are those
/// that the one call reaches. Each change is made after an even and after an odd number of calls, since a delay may alternate.
#[derive(Clone, Debug, Serialize)]
pub struct Memory {
    /// Calls after which a result no longer depends on earlier ones; none: more than were tried.
    pub calls: Option<usize>,
    /// The most calls that were tried.
    pub tried: usize,
    /// For each action, when results respond to it.
    pub inputs: Vec<Lateness>,
    /// When the returned states respond to the given state.
    pub state: Lateness,
    /// When observations respond to it; none without observations.
    pub observation: Option<Lateness>,
    /// Which state observations show; none without observations.
    pub observed: Option<Observed>,
    /// The age of observations within the last step, in steps; none: not examined.
    pub observed_age: Option<f64>,
    /// How the influence of earlier calls fades, if it is a filter's.
    pub settling: Option<Settling>,
}

impl Memory {
    /// Measures the memory of a black box.
    pub(crate) fn measure(prober: &mut Prober<'_>) -> Result<Self, BlackBoxError> {
        let subject = prober.subject;
        let (x, u) = (&subject.state, &subject.action);
        for _ in 0..MOST_CALLS {
            prober.call_one(x, u, subject.dt)?;
        }
        let mut inputs = Vec::new();
        for j in 0..u.len() {
            let mut changed = u.clone();
            changed[j] += subject.action_scale[j] / 64.0;
            let response = respond(prober, x, &changed)?;
            inputs.push(Lateness::of(&subject.inputs[j].name, &response.states));
        }
        let response = respond(prober, &moved(prober), u)?;
        let state = Lateness::of("state", &response.states);
        let seen = response.observations.as_deref();
        let observation = seen.map(|seen| Lateness::of_latest("observation", seen));
        let last_seen = seen.and_then(|seen| Lateness::of("observation", seen).last);
        // Observations that vary on and on say nothing about the states.
        let observation_varies = last_seen.is_some_and(|last| last >= MOST_CALLS);
        let last = inputs.iter().chain([&state]).filter_map(|lateness| lateness.last);
        let calls = last.chain(last_seen.filter(|_| !observation_varies)).max().unwrap_or(0);
        // The last call that was tried still responds: the end of the memory is beyond it.
        let calls = (calls < MOST_CALLS).then_some(calls);
        let settling = if calls.is_none() { Settling::measure(prober)? } else { None };
        let observed = match &observation {
            None => None,
            Some(_) if observation_varies => Some(Observed::Varying),
            Some(response) => Some(Observed::of(prober, response.first.is_some())?),
        };
        let is_new = |of: &Lateness| of.first == state.first && of.last == state.last;
        let mut observed_age = None;
        if observed == Some(Observed::Asked)
            && observation.as_ref().is_some_and(is_new)
            && let ObservationAge::Steps(age) = ObservationAge::measure(prober)?
        {
            observed_age = Some(age);
        }
        Ok(Memory {
            calls,
            tried: MOST_CALLS,
            inputs,
            state,
            observation,
            observed,
            observed_age,
            settling,
        })
    }

    /// The latency of an action beyond that of a step that uses it at once, in steps on average. Where it changes from step to step, the
    /// audit of many steps has it.
    pub(crate) fn latency(&self, input: usize, delays: &[DelayAudit]) -> f64 {
        self.inputs.get(input).map_or(0.0, |lateness| {
            let irregular =
                |audit: &&DelayAudit| audit.input == lateness.of && audit.first_change.is_some();
            delays.iter().find(irregular).map_or(lateness.mean, DelayAudit::mean)
        })
    }

    /// Steps by which observations are later than the states.
    pub fn staleness(&self) -> f64 {
        let varies = self.observed == Some(Observed::Varying);
        let late = self.observation.as_ref().filter(|found| found.first.is_some() && !varies);
        let late = late.map_or(0.0, |observation| observation.mean - self.state.mean);
        late + if self.observed == Some(Observed::Given) {
            1.0
        } else {
            self.observed_age.unwrap_or(0.0)
        }
    }
}
