//! The longest stable step.

use libration::linear::{Complex64, eigenvalues};
use serde::Serialize;

use crate::BlackBoxError;
use crate::flow::Flow;
use crate::linearised_step::{LinearisedStep, largest_scaled};
use crate::modes::{eigenvalue_errors, name_mode};
use crate::prober::Prober;

/// Least distance from the unit circle that counts as outside.
const OUTSIDE: f64 = 1e-12;
/// Errors of a factor that count as outside, too. The two factors of a free mass, both 1, are off by the root of a rounding.
const ERRORS: f64 = 10.0;
/// Part of the growth beyond a limit that remains at half the step where a mode grows with every step: that by methods of orders 1 to 4
/// falls by 4 to 32. Where a factor leaves the circle at a limit, nothing remains.
const REMAINS: f64 = 0.02;
/// Ratio of successive trial steps.
const RATIO: f64 = 1.25;
/// Longest and shortest trial relative to the step of the subject.
const RANGE: f64 = 1e4;
const BISECTIONS: usize = 40;
/// Relative width of the bracket at which bisection ends.
const RESOLUTION: f64 = 1e-7;

/// The longest step until a mode leaves the unit circle that the flow does not carry out.
#[derive(Clone, Debug, Serialize)]
pub struct LargestStep {
    /// In s; none if no limit was found.
    pub dt: Option<f64>,
    /// The longest step that was tried, in s.
    pub tried_up_to: f64,
    /// Whether a mode grows with every step because of the integrator alone.
    pub grows_always: bool,
    /// The states that move most in the mode that leaves.
    pub mode: String,
    /// Its frequency at the limit in periods per step: ½ if its sign changes from step to step.
    pub turns: f64,
    /// Why the search ended, if it did not find a limit.
    pub reason: Option<String>,
}

impl LargestStep {
    pub(crate) fn search(prober: &mut Prober<'_>, flow: &Flow) -> Result<Self, BlackBoxError> {
        let start = prober.subject.dt;
        let rates = eigenvalues(&flow.a).unwrap_or_default();
        let mut found = LargestStep {
            dt: None,
            tried_up_to: start,
            grows_always: false,
            mode: String::new(),
            turns: 0.0,
            reason: None,
        };
        let at = |prober: &mut Prober<'_>, dt: f64| Trial::at(prober, &rates, dt);
        let own = at(prober, start)?;
        let is_unstable = own.is_unstable();
        if let Some(z) = own.leaving.filter(|_| is_unstable) {
            found.turns = z.arg().abs() / core::f64::consts::TAU;
            found.mode = name_mode(&own.step, z, prober.subject);
        }
        let mut dt = start;
        // Up from a stable step, down from an unstable one.
        loop {
            let next = if is_unstable { dt / RATIO } else { dt * RATIO };
            if !(start / RANGE..=start * RANGE).contains(&next) {
                found.tried_up_to = dt;
                found.grows_always = is_unstable;
                return Ok(found);
            }
            let other = at(prober, next)?;
            if other.is_unknown {
                found.tried_up_to = dt;
                found.reason = Some(format!("a step of {next:.4} s has no derivative"));
                return Ok(found);
            }
            if other.is_unstable() != is_unstable {
                let (low, high) = if is_unstable { (next, dt) } else { (dt, next) };
                return found.bisect(prober, &rates, low, high);
            }
            dt = next;
            found.tried_up_to = found.tried_up_to.max(dt);
        }
    }

    fn bisect(
        mut self,
        prober: &mut Prober<'_>,
        rates: &[Complex64],
        mut low: f64,
        mut high: f64,
    ) -> Result<Self, BlackBoxError> {
        let mut leaving = Trial::at(prober, rates, high)?;
        for _ in 0..BISECTIONS {
            if high - low <= RESOLUTION * high {
                break;
            }
            let middle = low + (high - low) / 2.0;
            let trial = Trial::at(prober, rates, middle)?;
            if trial.is_unstable() {
                high = middle;
                leaving = trial;
            } else {
                low = middle;
            }
        }
        if let Some(z) = leaving.leaving {
            self.turns = z.arg().abs() / core::f64::consts::TAU;
            self.mode = name_mode(&leaving.step, z, prober.subject);
        }
        // At the step of the subject, too: slow transients of stiff contacts look like growth close to the limit.
        let start = prober.subject.dt.min(low / 2.0);
        let [half, own] = [low / 2.0, start].map(|dt| Trial::at(prober, rates, dt));
        let (half, own) = (half?, own?);
        let remains = half.excess > REMAINS * leaving.excess && half.excess > half.error;
        self.grows_always = remains && own.excess > own.error;
        self.dt = (!self.grows_always).then_some(low);
        self.tried_up_to = self.tried_up_to.max(high);
        Ok(self)
    }
}

/// A step of a trial length.
struct Trial {
    step: LinearisedStep,
    /// The largest growth of a mode per step beyond that of the flow.
    excess: f64,
    /// The estimated error of its factor.
    error: f64,
    /// The factor of the mode that leaves the circle though the flow does not carry it out.
    leaving: Option<Complex64>,
    is_unknown: bool,
}

impl Trial {
    fn at(prober: &mut Prober<'_>, rates: &[Complex64], dt: f64) -> Result<Self, BlackBoxError> {
        let step = LinearisedStep::of_states(prober, dt)?;
        let mut factors = match step.a.is_finite() {
            true => eigenvalues(&step.a).unwrap_or_default(),
            false => Vec::new(),
        };
        let is_unknown = factors.is_empty();
        factors.sort_by(|a, b| b.norm().total_cmp(&a.norm()));
        // The modes that the flow carries out, the fastest first, account for as many of the step.
        let growing = rates.iter().filter(|s| (s.re * dt).exp() > 1.0 + OUTSIDE).count();
        let leaving = factors.get(growing).copied();
        let excess = leaving.map_or(0.0, |z| z.norm() - 1.0);
        let errors = eigenvalue_errors(&step.a, &step.a_errors, &factors);
        // At least that of an entry: errors of a solver of constraints are not independent.
        let error = errors
            .get(growing)
            .copied()
            .unwrap_or(0.0)
            .max(largest_scaled(&step.a_errors, prober.subject) / ERRORS);
        Ok(Trial { step, excess, error, leaving, is_unknown })
    }

    fn is_unstable(&self) -> bool {
        self.is_unknown || self.excess > OUTSIDE.max(ERRORS * self.error)
    }
}
