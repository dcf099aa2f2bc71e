//! Observations of a moment within the last step.

use crate::BlackBoxError;
use crate::convergence::displaced;
use crate::observed::after;
use crate::prober::Prober;

/// Halvings of the step whose observation is that of the state before it, but for a change that extrapolation removes.
const HALVINGS: [i32; 2] = [10, 11];
/// Least change of an observation in a step relative to its size, far above the rounding of single precision.
const CHANGE: f64 = 1e-4;
/// Parts of a step that count as an age, from that of errors to that of a whole step.
const AGES: [f64; 2] = [0.02, 0.98];

/// What is known of the age of observations within the last step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ObservationAge {
    /// The age of the component that is the oldest, in steps; 0: all are those of the end of the step.
    Steps(f64),
    /// The simulator has no shorter steps that would show it.
    Unknown,
}

impl ObservationAge {
    /// An observation after a very short step from a state is that of the state, whatever the observation is.
    pub(crate) fn measure(prober: &mut Prober<'_>) -> Result<Self, BlackBoxError> {
        let subject = prober.subject;
        if subject.has_fixed_dt {
            return Ok(ObservationAge::Unknown);
        }
        let (x, u, dt) = (displaced(prober, 0.1), &subject.action, subject.dt);
        let (next, seen) = after(prober, &x, u, dt)?;
        let Some(seen) = seen else { return Ok(ObservationAge::Steps(0.0)) };
        let Some(other) = prober.observe(&displaced(prober, 0.2))? else {
            return Ok(ObservationAge::Steps(0.0));
        };
        let Some(first) = at_once(prober, &x)? else { return Ok(ObservationAge::Unknown) };
        let Some(last) = at_once(prober, &next)? else { return Ok(ObservationAge::Unknown) };
        let mut oldest = 0.0_f64;
        for i in 0..seen.len() {
            let change = last[i] - first[i];
            // One of the state that is asked for has no age.
            if seen[i] == other[i] && change.abs() > CHANGE * last[i].abs().max(first[i].abs()) {
                let age = (last[i] - seen[i]) / change;
                if (AGES[0]..AGES[1]).contains(&age) {
                    oldest = oldest.max(age);
                }
            }
        }
        Ok(ObservationAge::Steps(oldest))
    }
}

/// The observation in the limit of a step without length; none if short steps change nothing.
fn at_once(prober: &mut Prober<'_>, x: &[f64]) -> Result<Option<Vec<f64>>, BlackBoxError> {
    let subject = prober.subject;
    let mut found = Vec::new();
    for halvings in HALVINGS {
        let (next, seen) = after(prober, x, &subject.action, subject.dt * 2.0_f64.powi(-halvings))?;
        if next == x {
            return Ok(None);
        }
        found.push(seen);
    }
    let [Some(longer), Some(shorter)] = &found[..] else { return Ok(None) };
    Ok(Some(longer.iter().zip(shorter).map(|(a, b)| 2.0 * b - a).collect()))
}
