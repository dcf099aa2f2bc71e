//! Which integrator, with which step: the cheapest that loses no more than is tolerated.

use libration::catalog::Actuation;
use libration::{AnySystem, Method};
use libration_analyze::analyze::{Criteria, Request, Stepping, Timing, analyze};
use libration_work::Work;

use super::AdviseError;

/// What an integrator would take.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Choice {
    /// Its name.
    pub integrator: &'static str,
    /// The largest step that meets the tolerance, in s; none where none that is tried does.
    pub dt: Option<f64>,
    /// What is lost with it, in the measure of the tolerance; where no integrator meets it, the least that was found, and else
    /// infinite.
    pub lost: f64,
    /// The step with which that least is lost, in s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub best_dt: Option<f64>,
    /// What is lost with a step 1.2 times as long; none where steps are parts of a period, and the next longer is more than that.
    pub lost_beyond: Option<f64>,
    /// Of a loop: steps in a period.
    pub substeps: Option<u64>,
    /// Force evaluations in a second of simulated time; none where no step meets the tolerance.
    pub evaluations: Option<f64>,
}

impl Choice {
    /// Of `method` nothing is found yet.
    pub(super) fn none(method: Method) -> Self {
        Choice {
            integrator: method.name(),
            dt: None,
            lost: f64::INFINITY,
            best_dt: None,
            lost_beyond: None,
            substeps: None,
            evaluations: None,
        }
    }
}

/// What a search knows of a step.
pub(super) trait Trial: Sync {
    /// What is lost by `method` in steps of `dt` seconds; more than `most` need not be found exactly.
    fn lost(&self, work: &Work<'_>, method: Method, dt: f64, most: f64)
    -> Result<f64, AdviseError>;
}

/// The ratio of neighbouring steps that are tried.
const RATIO: f64 = 1.09;

/// To such a part the largest step is found.
const SHARP: f64 = 0.002;

/// What is tried beyond the step that is chosen.
pub(super) const BEYOND: f64 = 1.2;

/// The largest step between `least` and `most` that loses no more than `tolerance`, going down from above.
pub(super) fn largest_step(
    work: &Work<'_>,
    trial: &impl Trial,
    method: Method,
    tolerance: f64,
    [least, most]: [f64; 2],
) -> Result<Choice, AdviseError> {
    let lost = |dt: f64| trial.lost(work, method, dt, tolerance);
    let mut choice = Choice::none(method);
    let (mut above, mut low) = (most, most);
    let mut at = lost(low)?;
    while at > tolerance {
        (above, low) = (low, low / RATIO);
        if low < least {
            return Ok(choice);
        }
        at = lost(low)?;
    }
    while above / low > 1.0 + SHARP {
        let middle = (low * above).sqrt();
        let here = lost(middle)?;
        if here <= tolerance { (low, at) = (middle, here) } else { above = middle }
    }
    // What is lost may fall again for a while beyond.
    let mut beyond = lost(BEYOND * low)?;
    while beyond <= tolerance && BEYOND * low < most {
        (low, at) = (BEYOND * low, beyond);
        beyond = lost(BEYOND * low)?;
    }
    // All of it, beyond what is tolerated.
    beyond = trial.lost(work, method, BEYOND * low, f64::INFINITY)?;
    (choice.dt, choice.lost, choice.lost_beyond) = (Some(low), at, Some(beyond));
    Ok(choice)
}

/// The least that is lost with steps between `least` and `most`, each half of the one before, until rounding makes it more again.
pub(super) fn best_possible(
    work: &Work<'_>,
    trial: &impl Trial,
    method: Method,
    [least, most]: [f64; 2],
) -> Result<Choice, AdviseError> {
    let mut choice = Choice::none(method);
    let mut dt = most;
    while dt >= least {
        let here = trial.lost(work, method, dt, f64::INFINITY)?;
        if here < choice.lost {
            (choice.lost, choice.best_dt) = (here, Some(dt));
        } else if here > 2.0 * choice.lost && here.is_finite() {
            break;
        }
        dt /= 2.0;
    }
    Ok(choice)
}

/// Force evaluations of a step, counted.
pub(super) fn evaluations(system: AnySystem, q: &[f64], v: &[f64], method: Method) -> Option<u64> {
    let request = Request {
        system,
        actuation: Actuation::Acceleration,
        stepping: Stepping::Method(method),
        dt: 1e-6,
        q: q.to_vec(),
        v: v.to_vec(),
        steps: 1,
        criteria: Criteria::default(),
        timing: Timing::default(),
    };
    analyze(&request).ok().map(|analysis| analysis.force_evaluations_per_step)
}

/// The cheapest first; those that never meet the tolerance last.
pub(super) fn by_cost(choices: &mut [Choice]) {
    let cost = |choice: &Choice| choice.evaluations.unwrap_or(f64::INFINITY);
    choices.sort_by(|a, b| cost(a).total_cmp(&cost(b)).then(a.lost.total_cmp(&b.lost)));
}
