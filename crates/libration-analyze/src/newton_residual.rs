//! What the fixed number of Newton steps of an implicit integrator leaves.

use std::sync::atomic::{AtomicBool, Ordering};

use libration::equations::{Dynamics, Evaluation, StepProgram};
use libration::{AnyMethod, Float};
use libration_report::verdict::{Outcome, Verdict};
use serde::Serialize;

/// The largest correction by a further Newton step that a run may have, as a part of the change of the state in its step.
pub const MOST_RESIDUAL: f64 = 1e-6;

/// Roundings of the states of a step up to which a correction is rounding.
const ROUNDINGS: f64 = 64.0;

/// What the Newton steps of an implicit integrator leave in a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct NewtonResidual {
    /// The largest correction of a state by a further Newton step, as a part of the change of this state in the step or in the one before.
    /// Infinite if it is no number.
    pub largest: f64,
    /// The step that has it, from 1.
    pub step: u64,
    /// Its time in s.
    pub t: f64,
    /// Number of steps whose residual is known.
    pub examined: u64,
    /// Number of steps with more than [`MOST_RESIDUAL`].
    pub exceeding: u64,
}

impl NewtonResidual {
    /// Whether the equations of all examined steps are solved.
    pub fn is_small(&self) -> bool {
        self.exceeding == 0
    }

    /// Whether the equations of all examined steps are solved, in words.
    pub fn verdict(&self) -> Verdict {
        let NewtonResidual { largest, step, t, examined, exceeding } = *self;
        if self.is_small() {
            let evidence =
                format!("a further Newton step changes a state by at most {largest:.1e} of a step");
            return Verdict::new(Outcome::Within, evidence);
        }
        let part = match largest.is_finite() {
            true => format!("by {largest:.1e} of its change in step {step} (t = {t} s)"),
            false => format!("without bound in step {step} (t = {t} s)"),
        };
        Verdict::new(
            Outcome::Exceeds,
            format!(
                "a further Newton step changes a state {part}, more than {MOST_RESIDUAL:e}, and so in {exceeding} of {examined} steps"
            ),
        )
    }

    /// The error of a run whose steps are not solved; none if they are.
    pub fn error(&self) -> Option<String> {
        (!self.is_small()).then(|| {
            format!(
                "the steps did not solve their equations: {}; expected solved equations; help: a shorter time step",
                self.verdict().evidence
            )
        })
    }
}

/// The step of an integrator with a further Newton step; none of an integrator without an iteration.
pub(crate) fn refined(method: AnyMethod, dynamics: &Dynamics) -> Option<StepProgram> {
    let AnyMethod::Implicit(method) = method else { return None };
    method.refined().map(|refined| StepProgram::implicit(refined, dynamics))
}

/// Operations of a run whose residual is measured for an analysis: less than a second.
const MOST_OPERATIONS: u64 = 1 << 28;

/// Steps between two checks of the stop flag.
const CHUNK: u64 = 1 << 12;

/// What the Newton steps of an integrator leave in at most `steps` steps of `dt` seconds from positions, velocities and inputs, fewer if they
/// take long. `places` are those of the states that count. None without an iteration, and if `stop` is set.
pub(crate) fn of_run(
    method: AnyMethod,
    dynamics: &Dynamics,
    start: &[f64],
    places: Vec<usize>,
    (dt, steps): (f64, u64),
    stop: &AtomicBool,
) -> Option<NewtonResidual> {
    let refined = refined(method, dynamics)?;
    let step = StepProgram::of(method, dynamics);
    let most = MOST_OPERATIONS / (2 * step.program().operations().max(1) as u64);
    let mut run = step.program().on::<f64>();
    let mut check = NewtonCheck::new(&refined, places);
    let mut inputs = start.to_vec();
    inputs.resize(2 * dynamics.degrees() + dynamics.inputs(), 0.0);
    inputs.push(dt);
    let mut next = Vec::with_capacity(inputs.len());
    for step in 1..=steps.min(most.max(1)) {
        if step % CHUNK == 0 && stop.load(Ordering::Relaxed) {
            return None;
        }
        next.clear();
        next.extend(run.run(&inputs));
        if !next.iter().all(|x| x.is_finite()) {
            break;
        }
        check.observe(&inputs, &next, step);
        inputs[..next.len()].copy_from_slice(&next);
    }
    check.found()
}

/// Observes the steps of a run.
///
/// Steps have no result beside their state, since they have the same operations for all numbers: the residual is measured beside them.
pub(crate) struct NewtonCheck<'p, S> {
    refined: Evaluation<'p, S>,
    /// The states that count, by their places among positions and velocities.
    places: Vec<usize>,
    /// Changes in the step before.
    before: Vec<f64>,
    found: NewtonResidual,
}

impl<'p, S: Float> NewtonCheck<'p, S> {
    pub(crate) fn new(refined: &'p StepProgram, places: Vec<usize>) -> Self {
        let found = NewtonResidual { largest: 0.0, step: 0, t: 0.0, examined: 0, exceeding: 0 };
        let before = vec![0.0; places.len()];
        NewtonCheck { refined: refined.program().on(), places, before, found }
    }

    /// What was found; none before a step.
    pub(crate) fn found(&self) -> Option<NewtonResidual> {
        (self.found.examined > 0).then_some(self.found)
    }

    /// Forgets the last step: the next one is that of another trajectory.
    pub(crate) fn begin(&mut self) {
        self.before.fill(0.0);
    }

    /// Observes a step with this number, from positions, velocities, inputs and the time step to positions and velocities.
    pub(crate) fn observe(&mut self, inputs: &[S], next: &[S], step: u64) {
        let degrees = next.len() / 2;
        let dt = inputs.last().map_or(0.0, |dt| dt.to_f64());
        let size = |states: &[S]| states.iter().fold(0.0_f64, |most, x| most.max(x.to_f64().abs()));
        let (q, v) = next.split_at(degrees);
        let (q, v) = (
            size(q).max(size(&inputs[..degrees])),
            size(v).max(size(&inputs[degrees..2 * degrees])),
        );
        // Rounding of a stiff force changes a velocity as that of a position does in a step.
        let rounding = ROUNDINGS * S::UNIT_ROUNDOFF.to_f64() * (q + dt * v);
        let refined: Vec<S> = self.refined.run(inputs).collect();
        let mut worst = 0.0_f64;
        for (&place, before) in self.places.iter().zip(&mut self.before) {
            let change = (next[place].to_f64() - inputs[place].to_f64()).abs();
            let correction = (refined[place].to_f64() - next[place].to_f64()).abs();
            let rounding = if place < degrees { rounding } else { rounding / dt };
            let own = match correction <= rounding {
                true => 0.0,
                false => correction / change.max(*before),
            };
            worst = if own > worst || own.is_nan() { own } else { worst };
            *before = change;
        }
        if worst.is_nan() {
            worst = f64::INFINITY;
        }
        self.found.examined += 1;
        self.found.exceeding += u64::from(worst > MOST_RESIDUAL);
        if worst > self.found.largest {
            let t = step as f64 * dt;
            self.found = NewtonResidual { largest: worst, step, t, ..self.found };
        }
    }
}
