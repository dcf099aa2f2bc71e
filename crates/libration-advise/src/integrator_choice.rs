//! The choice of integrator and step: the cheapest that meets a tolerance.

use libration::Method;
use libration::equations::{Dynamics, StepProgram};
use libration_work::Work;

use super::AdviseError;

/// An integrator with its largest step within the tolerance.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct IntegratorChoice {
    /// The name of the integrator.
    pub integrator: &'static str,
    /// The largest step that meets the tolerance, in s; none if no tried step does.
    pub dt: Option<f64>,
    /// The error with this step, in the measure of the tolerance. If no integrator meets it, the smallest error found, else
    /// infinite.
    pub lost: f64,
    /// The step with the smallest error, in s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub best_dt: Option<f64>,
    /// The error with a step 1.2 times as long, or with the next longer part of a period; none without one.
    pub lost_beyond: Option<f64>,
    /// The shortest tried step, in s; none for a loop.
    pub tried_down_to: Option<f64>,
    /// Steps per period of a loop.
    pub substeps: Option<u64>,
    /// Force evaluations per second of simulated time; none if no step meets the tolerance.
    pub evaluations: Option<f64>,
}

impl IntegratorChoice {
    /// The choice of `method` without a step.
    pub(super) fn none(method: Method) -> Self {
        IntegratorChoice {
            integrator: method.name(),
            dt: None,
            lost: f64::INFINITY,
            best_dt: None,
            lost_beyond: None,
            tried_down_to: None,
            substeps: None,
            evaluations: None,
        }
    }
}

/// What a search of integrators covers.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct SearchExtent {
    /// Number of integrators that were tried.
    pub integrators: usize,
    /// The shortest and the longest tried step, in s.
    pub steps: [f64; 2],
    /// What was not tried, in words.
    pub not_tried: Vec<String>,
}

/// The error of a step, for a search.
pub(super) trait StepTrial: Sync {
    /// The error of `method` in steps of `dt` seconds; an error above `most` may be inexact.
    fn lost(&self, work: &Work<'_>, method: Method, dt: f64, most: f64)
    -> Result<f64, AdviseError>;

    /// The step below which errors fall with the step.
    fn resolving_step(&self) -> f64;

    /// The longest step of a search, in s: 4 rad of the motion, whose stiffest rate may be far above that of its turns, or the horizon.
    fn longest_step(&self) -> f64;
}

/// Runge–Kutta methods of high orders that are tried.
const RUNGE_KUTTA: [&str; 2] = ["dormand-prince-8", "dormand-prince-rkn-12"];

/// The methods that are tried: those with code of their own, and the most efficient tables that have their order on such forces.
pub(super) fn offered_methods(is_positional: bool) -> impl Iterator<Item = Method> {
    let runge_kutta = RUNGE_KUTTA.into_iter().filter_map(Method::from_name);
    let tables = Method::most_efficient_tables().chain(runge_kutta);
    let suits = move |method: &Method| is_positional || !method.supposes_positional_forces();
    Method::ALL.into_iter().chain(tables.filter(suits))
}

/// Force evaluations per step.
pub(super) fn evaluations(method: Method, dynamics: &Dynamics) -> usize {
    StepProgram::new(method, dynamics).evaluations()
}

/// Ratio of neighbouring tried steps.
const RATIO: f64 = 1.09;

/// The same where errors fall with the step.
const COARSE: f64 = 2.0;

/// Relative accuracy of the largest step.
const SHARP: f64 = 0.002;

/// Ratio of the step tried beyond the chosen step.
pub(super) const BEYOND: f64 = 1.2;

/// The largest step between `least` and `most` with an error of at most `tolerance`, searched from above; a longer one if `most` meets the
/// tolerance and steps between do, too.
pub(super) fn largest_step(
    work: &Work<'_>,
    trial: &impl StepTrial,
    method: Method,
    tolerance: f64,
    [least, most]: [f64; 2],
) -> Result<IntegratorChoice, AdviseError> {
    let mut choice = IntegratorChoice::none(method);
    let (mut longest, mut shortest) = (most, most);
    let ranges = [least, most];
    while let Some(found) =
        next_step(work, trial, method, tolerance, longest, ranges, &mut shortest)?
    {
        choice.tried_down_to = Some(shortest);
        let [dt, lost, beyond] = found;
        (choice.dt, choice.lost, choice.lost_beyond) = (Some(dt), lost, Some(beyond));
        // An error that rises faster than that of its order may have passed through zero: shorter steps may exceed the tolerance.
        let is_steep = beyond > STEEP * BEYOND.powi(method.order() as i32) * lost;
        let mut shorter = None;
        if is_steep {
            for part in 1..=NEIGHBOURS {
                let near =
                    dt * BEYOND.powf(NEIGHBOURHOOD * f64::from(part) / f64::from(NEIGHBOURS));
                if near > least && trial.lost(work, method, near, tolerance)? > tolerance {
                    shorter = Some(near);
                }
            }
        }
        match shorter {
            Some(near) => longest = near,
            None => return Ok(choice),
        }
    }
    Ok(IntegratorChoice { tried_down_to: Some(shortest), ..IntegratorChoice::none(method) })
}

/// Shorter steps that are tried where an error may have passed through zero, evenly on a scale of logarithms.
const NEIGHBOURS: u32 = 8;

/// The shortest of them, as a power of the step [beyond](BEYOND): 0.76 of the step. The phase of a pendulum had a zero between steps that
/// exceeded the tolerance down to 0.79 of it.
const NEIGHBOURHOOD: f64 = -1.5;

/// How many times faster than with its order an error rises where it may have passed through zero.
const STEEP: f64 = 4.0;

/// A largest step of at most `longest` within the tolerance, with its error and that of a step [beyond](BEYOND) it; `shortest` is the
/// shortest tried one.
fn next_step(
    work: &Work<'_>,
    trial: &impl StepTrial,
    method: Method,
    tolerance: f64,
    longest: f64,
    [least, most]: [f64; 2],
    shortest: &mut f64,
) -> Result<Option<[f64; 3]>, AdviseError> {
    let lost = |dt: f64| trial.lost(work, method, dt, tolerance);
    let (mut above, mut low) = (longest, longest);
    let mut at = lost(low)?;
    while at > tolerance {
        let ratio = if low < trial.resolving_step() { COARSE } else { RATIO };
        (above, low) = (low, low / ratio);
        if low < least {
            return Ok(None);
        }
        *shortest = shortest.min(low);
        at = lost(low)?;
    }
    while above / low > 1.0 + SHARP {
        let middle = (low * above).sqrt();
        let here = lost(middle)?;
        if here <= tolerance { (low, at) = (middle, here) } else { above = middle }
    }
    // The error may decrease again beyond; not where a longer step has been left.
    let mut beyond = lost(BEYOND * low)?;
    let is_possible = |low: f64| BEYOND * low <= trial.longest_step();
    while longest == most && beyond <= tolerance && (BEYOND * low < most || is_possible(low)) {
        (low, at) = (BEYOND * low, beyond);
        beyond = lost(BEYOND * low)?;
    }
    // The range ended at a step that meets the tolerance, and the search went on.
    if low > most {
        let mut above = BEYOND * low;
        while beyond > tolerance && above / low > 1.0 + SHARP {
            let middle = (low * above).sqrt();
            let here = lost(middle)?;
            if here <= tolerance { (low, at) = (middle, here) } else { above = middle }
        }
    }
    // The exact error beyond the tolerance.
    beyond = trial.lost(work, method, BEYOND * low, f64::INFINITY)?;
    Ok(Some([low, at, beyond]))
}

/// The smallest error with steps between `least` and `most`, halved until rounding increases it.
pub(super) fn best_possible(
    work: &Work<'_>,
    trial: &impl StepTrial,
    method: Method,
    [least, most]: [f64; 2],
) -> Result<IntegratorChoice, AdviseError> {
    let mut choice = IntegratorChoice::none(method);
    let mut dt = most;
    while dt >= least {
        let here = trial.lost(work, method, dt, f64::INFINITY)?;
        choice.tried_down_to = Some(dt);
        if here < choice.lost {
            (choice.lost, choice.best_dt) = (here, Some(dt));
        } else if here > 2.0 * choice.lost && here.is_finite() {
            break;
        }
        dt /= 2.0;
    }
    Ok(choice)
}

/// Sorts by cost; integrators without a step come last.
pub(super) fn sort_by_cost(choices: &mut [IntegratorChoice]) {
    let cost = |choice: &IntegratorChoice| choice.evaluations.unwrap_or(f64::INFINITY);
    choices.sort_by(|a, b| cost(a).total_cmp(&cost(b)).then(a.lost.total_cmp(&b.lost)));
}
