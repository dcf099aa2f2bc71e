//! The longest stable step.

use libration::linear::{Complex64, eigenvalues};
use libration_report::notation::number;
use serde::Serialize;

use crate::BlackBoxError;
use crate::flow::Flow;
use crate::linearised_step::{LinearisedStep, largest_scaled};
use crate::modes::{eigenvalue_errors, name_mode};
use crate::prober::{Prober, row};
use crate::step_equilibrium::step_equilibrium;

/// Least distance from the unit circle that counts as outside.
const OUTSIDE: f64 = 1e-12;
/// Errors of a factor that count as outside, too. The two factors of a free mass, both 1, are off by the root of a rounding.
const ERRORS: f64 = 10.0;
/// Growth of a mode that counts as carried out by the flow, in units of its own: a step may be inaccurate before it is unstable.
const OWN_GROWTH: f64 = 2.0;
/// On a motion the rates change within a step, which looks like growth of slow modes. There only modes that are fast beside the step
/// count, by the distance of their factors from 1, and growth beyond this per step.
const FAST: f64 = 0.5;
const GROWTH_ON_A_MOTION: f64 = 0.01;
/// Part of the growth beyond a limit that remains at half the step where a mode grows with every step: that by methods of orders 1 to 4
/// falls by 4 to 32. Where a factor leaves the circle at a limit, nothing remains.
const REMAINS: f64 = 0.02;
/// Ratio of successive trial steps.
const RATIO: f64 = 1.25;
/// Longest and shortest trial, at least: relative to the step of the subject, and relative to the time of the fastest mode.
const RANGE: f64 = 1e4;
const RANGE_OF_FASTEST: [f64; 2] = [0.01, 10.0];
const BISECTIONS: usize = 40;
/// Change of an equilibrium in a step, in units of the scales, that is no rounding.
const MOVED: f64 = 1e-6;
/// Relative width of the bracket at which bisection ends.
const RESOLUTION: f64 = 1e-7;

/// The longest step until a mode leaves the unit circle that the flow does not carry out. A mode that grows in the system, too, leaves
/// when it grows twice as fast.
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
    /// The shortest step that was tried whose equilibrium is another state, in s: that of contacts which rest deeper in longer steps.
    pub rests_elsewhere_from: Option<f64>,
}

impl LargestStep {
    /// `is_at_rest`: whether the state is an equilibrium.
    pub(crate) fn search(
        prober: &mut Prober<'_>,
        flow: &Flow,
        is_at_rest: bool,
    ) -> Result<Self, BlackBoxError> {
        let start = prober.subject.dt;
        let rates = FlowRates::of(flow, is_at_rest);
        let mut found = LargestStep {
            dt: None,
            tried_up_to: start,
            grows_always: false,
            mode: String::new(),
            turns: 0.0,
            reason: None,
            rests_elsewhere_from: None,
        };
        let mut state = prober.subject.state.clone();
        let own = Trial::at(prober, &rates, &mut state, start)?;
        let is_unstable = own.is_unstable();
        if let Some(z) = own.leaving.filter(|_| is_unstable) {
            found.turns = z.arg().abs() / core::f64::consts::TAU;
            found.mode = name_mode(&own.step, z, prober.subject);
        }
        let mut dt = start;
        let fastest = if rates.fastest > 0.0 { rates.fastest.recip() } else { start };
        let range = (start / RANGE).min(RANGE_OF_FASTEST[0] * fastest)
            ..=(start * RANGE).max(RANGE_OF_FASTEST[1] * fastest);
        // Up from a stable step, down from an unstable one.
        loop {
            let next = if is_unstable { dt / RATIO } else { dt * RATIO };
            if !range.contains(&next) {
                found.tried_up_to = dt;
                found.grows_always = is_unstable;
                return Ok(found);
            }
            let other = Trial::at(prober, &rates, &mut state, next)?;
            if other.rests_elsewhere {
                found.rests_elsewhere_from.get_or_insert(next);
            }
            if other.is_unknown {
                found.tried_up_to = dt;
                found.reason = Some(format!("a step of {next:.4} s has no derivative"));
                return Ok(found);
            }
            if other.moves && !is_unstable {
                found.tried_up_to = dt;
                let why = if prober.subject.is_mujoco() {
                    ": contacts rest deeper where dt exceeds half the time constant of solref (refsafe)"
                } else {
                    ""
                };
                found.reason = Some(format!(
                    "no equilibrium of a step of {} s was found near the state{why}",
                    number(next, 4)
                ));
                return Ok(found);
            }
            if other.is_unstable() != is_unstable {
                let (low, high) = if is_unstable { (next, dt) } else { (dt, next) };
                return found.bisect(prober, &rates, &mut state, [low, high]);
            }
            dt = next;
            found.tried_up_to = found.tried_up_to.max(dt);
        }
    }

    fn bisect(
        mut self,
        prober: &mut Prober<'_>,
        rates: &FlowRates,
        state: &mut Vec<f64>,
        [mut low, mut high]: [f64; 2],
    ) -> Result<Self, BlackBoxError> {
        let mut leaving = Trial::at(prober, rates, state, high)?;
        for _ in 0..BISECTIONS {
            if high - low <= RESOLUTION * high {
                break;
            }
            let middle = low + (high - low) / 2.0;
            let trial = Trial::at(prober, rates, state, middle)?;
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
        let [half, own] = [low / 2.0, start].map(|dt| Trial::at(prober, rates, state, dt));
        let (half, own) = (half?, own?);
        let remains = half.excess > REMAINS * leaving.excess && half.excess > half.error;
        self.grows_always = remains && own.excess > own.error;
        self.dt = (!self.grows_always).then_some(low);
        self.tried_up_to = self.tried_up_to.max(high);
        Ok(self)
    }
}

/// Growth rates of the flow, the fastest first, with their errors.
struct FlowRates {
    rates: Vec<(f64, f64)>,
    /// The largest `|s|`.
    fastest: f64,
    is_at_rest: bool,
}

impl FlowRates {
    fn of(flow: &Flow, is_at_rest: bool) -> Self {
        let values = eigenvalues(&flow.a).unwrap_or_default();
        let errors = eigenvalue_errors(&flow.a, &flow.a_errors, &values);
        let mut rates: Vec<(f64, f64)> = values.iter().map(|s| s.re).zip(errors).collect();
        rates.sort_by(|a, b| b.0.total_cmp(&a.0));
        let fastest = values.iter().map(|s| s.norm()).fold(0.0, f64::max);
        FlowRates { rates, fastest, is_at_rest }
    }
}

/// Whether a step of this length moves the state, such as that of contacts which give way by the length of the step.
fn moves(prober: &mut Prober<'_>, state: &[f64], dt: f64) -> Result<bool, BlackBoxError> {
    let subject = prober.subject;
    let actions = row(&subject.action);
    let next = prober.step(&row(state), &actions, dt)?;
    let moved = |i: usize| (next[(0, i)] - state[i]).abs() / subject.state_scale[i];
    Ok((0..state.len()).any(|i| moved(i) > MOVED))
}

/// A step of a trial length.
struct Trial {
    step: LinearisedStep,
    /// The growth per step of the mode that leaves most clearly beyond that of the flow.
    excess: f64,
    /// The growth that errors explain.
    error: f64,
    /// Its factor.
    leaving: Option<Complex64>,
    is_unknown: bool,
    /// Whether the state of an equilibrium moves under a step of this length, and none was found near it that does not.
    moves: bool,
    /// Whether another state is the equilibrium of a step of this length.
    rests_elsewhere: bool,
}

impl Trial {
    /// A step at the equilibrium near `state`, which becomes it.
    fn at(
        prober: &mut Prober<'_>,
        flow: &FlowRates,
        state: &mut Vec<f64>,
        dt: f64,
    ) -> Result<Self, BlackBoxError> {
        let mut moves = flow.is_at_rest && moves(prober, state, dt)?;
        let mut rests_elsewhere = false;
        if moves && let Some(found) = step_equilibrium(prober, state, dt)? {
            *state = found;
            (moves, rests_elsewhere) = (false, true);
        }
        let step = LinearisedStep::of_states_at(prober, state, dt)?;
        let mut factors = match step.a.is_finite() {
            true => eigenvalues(&step.a).unwrap_or_default(),
            false => Vec::new(),
        };
        factors.sort_by(|a, b| b.norm().total_cmp(&a.norm()));
        let errors = eigenvalue_errors(&step.a, &step.a_errors, &factors);
        // At least that of an entry: errors of a solver of constraints are not independent.
        let of_entries = largest_scaled(&step.a_errors, prober.subject) / ERRORS;
        let mut found = Trial {
            step,
            excess: 0.0,
            error: 0.0,
            leaving: None,
            is_unknown: factors.is_empty(),
            moves,
            rests_elsewhere,
        };
        // The modes of the step and of the flow in the order of their growth: what the fastest of the flow carry out is theirs.
        for (k, (z, error)) in factors.iter().zip(errors).enumerate() {
            let (rate, rate_error) = flow.rates.get(k).copied().unwrap_or((0.0, 0.0));
            let unknown = (rate.min(0.0) + ERRORS * rate_error).max(0.0);
            let own = OWN_GROWTH * rate.max(0.0) + unknown;
            let excess = z.norm().ln() - own * dt;
            let mut error = ERRORS * error.max(of_entries);
            if !flow.is_at_rest {
                error = error.max(GROWTH_ON_A_MOTION);
                if (z - 1.0).norm() < FAST {
                    continue;
                }
            }
            if found.leaving.is_none() || excess - error > found.excess - found.error {
                (found.excess, found.error, found.leaving) = (excess, error, Some(*z));
            }
        }
        Ok(found)
    }

    fn is_unstable(&self) -> bool {
        self.is_unknown || (self.leaving.is_some() && self.excess > OUTSIDE.max(self.error))
    }
}
