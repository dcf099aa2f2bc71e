//! Which state observations show.

use serde::Serialize;

use crate::BlackBoxError;
use crate::convergence::displaced;
use crate::prober::Prober;

/// The state that observations show.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Observed {
    /// That which is asked for, or the last one that was returned.
    Asked,
    /// That which was given to the last step: the simulator stores the observation before its update.
    Given,
    /// None: all observations are the same.
    Nothing,
    /// Unknown: observations of the same state vary on and on.
    Varying,
}

impl Observed {
    /// `responds`: whether observations respond to the given states at all.
    ///
    /// An observation that does not depend on the state that is asked for is one that the simulator has stored. That of a returned state
    /// depends on the length of the step or on the action, as the state does; that of a given state does not. One at a limit of the
    /// observations depends on no state nearby, and shows none.
    pub(crate) fn of(prober: &mut Prober<'_>, responds: bool) -> Result<Self, BlackBoxError> {
        let subject = prober.subject;
        if !responds || subject.has_fixed_dt {
            return Ok(if responds { Observed::Asked } else { Observed::Nothing });
        }
        let (dt, u) = (subject.dt, &subject.action);
        let (x, other) = (displaced(prober, 0.1), displaced(prober, 0.2));
        let (next, seen) = after(prober, &x, u, dt)?;
        let seen_of_other = prober.observe(&other)?;
        let mut changed = u.clone();
        changed.iter_mut().zip(&subject.action_scale).for_each(|(u, scale)| *u += scale / 64.0);
        let (of_half, seen_of_half) = after(prober, &x, u, dt / 2.0)?;
        let (_, seen_of_changed) = after(prober, &x, &changed, dt)?;
        let (_, seen_later) = after(prober, &next, u, dt)?;
        let (_, seen_after_other) = after(prober, &other, u, dt)?;
        let value = |of: &Option<Vec<f64>>, i: usize| of.as_ref().map(|of| of[i]);
        let is_of_given = |i: usize| {
            let is = |other: &Option<Vec<f64>>| value(other, i) == value(&seen, i);
            // An observation of what never changes is none of a given state.
            is(&seen_of_other)
                && is(&seen_of_half)
                && is(&seen_of_changed)
                && !is(&seen_later)
                && !is(&seen_after_other)
        };
        let count = seen.as_ref().map_or(0, Vec::len);
        let shows_given = of_half != next && (0..count).any(is_of_given);
        Ok(if shows_given { Observed::Given } else { Observed::Asked })
    }
}

/// A step, and the observation after it.
pub(crate) fn after(
    prober: &mut Prober<'_>,
    x: &[f64],
    u: &[f64],
    dt: f64,
) -> Result<(Vec<f64>, Option<Vec<f64>>), BlackBoxError> {
    let next = prober.step_one(x, u, dt)?;
    let seen = prober.observe(&next)?;
    Ok((next, seen))
}
