//! Errors of a motion against the exact one, and the verdict.

use std::sync::atomic::AtomicBool;

use libration::equations::StepProgram;
use libration_report::verdict::Verdict;
use serde::Serialize;

use super::energy::EnergyOf;
use super::judgement::Excess;
use super::reference::Reference;
use super::undefined_function::undefined_function;
use super::{EnergyChange, MotionState, MotionSubject, SMALL, StepRun, most_steps};
use crate::AnalyzeError;

/// An error counts where the exact motion is known to this part of it.
const KNOWN: f64 = 0.25;

/// The range of a state that hardly moves, as a part of the largest range of the states of the same unit: states of one unit are parts of
/// one motion.
const LEAST_RANGE: f64 = 1e-3;

/// The same of states without units, which need not be of one kind: above roundings only.
const LEAST_RANGE_WITHOUT_UNIT: f64 = 1e-9;

/// A motion under steps beside the exact motion.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MotionExamination {
    /// Number of steps of the request.
    pub requested_steps: u64,
    /// Number of steps up to which the motion was compared with the exact one.
    pub examined_steps: u64,
    /// Number of steps after which the states were compared: of many steps not all, but more where the motion is fast.
    pub compared_steps: usize,
    /// The exact motion: `exponential` of a system with constant derivatives, else `adaptive`, steps of order eight with their own error
    /// control.
    pub reference: &'static str,
    /// The largest difference of two such motions of different tolerance, relative to the ranges of states.
    pub reference_error: f64,
    /// The states.
    pub states: Vec<StateExamination>,
    /// The energy; none if the system has none.
    pub energy: Option<EnergyChange>,
    /// The first step after which a state is not finite; none if there is none.
    pub diverged_at_step: Option<u64>,
    /// The function without a value that ends the steps, with its argument; none if none does.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub undefined: Option<String>,
    /// Whether the steps resolve the motion.
    pub verdict: Verdict,
    /// The least and the largest value of each position and velocity, in the exact motion where that is known.
    #[serde(skip)]
    pub(crate) ranges: Vec<[f64; 2]>,
}

/// A state of a motion.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StateExamination {
    /// The name.
    pub name: String,
    /// The unit; empty without one.
    pub unit: String,
    /// The size with which errors are compared: the range of the state in the exact motion. Of a state that hardly moves, a part of the
    /// largest range of its unit.
    pub range: f64,
    /// The largest error.
    pub largest_error: f64,
    /// The step at which it occurs.
    pub largest_error_at_step: u64,
    /// Whether the error is small beside the motion at all examined steps.
    pub resolved: bool,
}

/// Follows a motion for `requested` steps, or fewer if they take long, and compares it with the exact one.
///
/// # Errors
/// [`AnalyzeError::Interrupted`].
pub(crate) fn examine(
    subject: &MotionSubject<'_>,
    step: &StepProgram,
    dt: f64,
    requested: u64,
    stop: &AtomicBool,
) -> Result<MotionExamination, AnalyzeError> {
    let steps = requested.min(most_steps(step));
    let reference = Reference::new(subject, steps, dt, stop)?;
    let numbers = &reference.numbers;
    let run = StepRun { start: subject.start, step, dt, substeps: 1 };
    let mut energy_of = EnergyOf::new(subject.dynamics);
    let mut energy = energy_of.as_mut().map(|of| EnergyChange::new(of, subject, steps));
    let (mut samples, mut diverged) = (Vec::with_capacity(numbers.len()), None);
    let (mut before, mut undefined) = (subject.start.to_vec(), None);
    run.follow(steps, stop, |number, state| {
        if let (Some(change), Some(of)) = (&mut energy, &mut energy_of) {
            change.add(number, of.total(state));
        }
        if numbers.get(samples.len()) == Some(&number) {
            samples.push(state.to_vec());
        }
        if state.iter().any(|x| !x.is_finite()) {
            diverged = Some(number);
            undefined = undefined_function(step, &before, dt);
        }
        before.copy_from_slice(state);
    })?;
    let known = reference.known();
    let mut ranges = reference.exact.ranges.clone();
    if known == 0 {
        for state in samples.iter().filter(|state| state.iter().all(|x| x.is_finite())) {
            for (range, x) in ranges.iter_mut().zip(state) {
                *range = [range[0].min(*x), range[1].max(*x)];
            }
        }
    }
    let scales = scales(subject.states, &ranges);
    let mut found = MotionExamination {
        requested_steps: requested,
        examined_steps: known.checked_sub(1).map_or(0, |last| numbers[last]),
        compared_steps: known.min(samples.len()),
        reference: reference.kind,
        reference_error: 0.0,
        states: Vec::new(),
        energy,
        diverged_at_step: diverged,
        undefined,
        verdict: Verdict::unknown(""),
        ranges,
    };
    let mut excess: Option<Excess> = None;
    let mut unsure: Option<u64> = None;
    found.states = subject.states.iter().zip(&scales).map(StateExamination::new).collect();
    for (i, &number) in numbers.iter().enumerate().take(known.min(samples.len())) {
        for (j, (state, scale)) in subject.states.iter().zip(&scales).enumerate() {
            let [own, exact, coarse] =
                [&samples[i], &reference.exact.states[i], &reference.coarse.states[i]]
                    .map(|states| states[state.place]);
            let (error, doubt) = ((own - exact).abs(), (coarse - exact).abs());
            found.states[j].add(number, error);
            found.reference_error = found.reference_error.max(doubt / scale);
            let is_small = error <= SMALL * scale;
            if !is_small
                && excess.as_ref().is_none_or(|first| first.step == number && !first.is_known)
            {
                excess = Some(Excess { step: number, state: j, is_known: doubt <= KNOWN * error });
            }
            if doubt > KNOWN * SMALL * scale && unsure.is_none() {
                unsure = Some(number);
            }
        }
    }
    if let (Some(change), Some(of)) = (&mut found.energy, &mut energy_of) {
        change.compare(of, subject.start, &samples, &reference);
    }
    found.verdict = found.judge(dt, excess, unsure, steps, &reference);
    Ok(found)
}

/// The range of each state with which its errors are compared.
fn scales(states: &[MotionState], ranges: &[[f64; 2]]) -> Vec<f64> {
    let range = |state: &MotionState| ranges[state.place][1] - ranges[state.place][0];
    let scale = |state: &MotionState| {
        let group = states.iter().filter(|other| other.is_like(state)).map(range);
        let part = if state.unit.is_empty() { LEAST_RANGE_WITHOUT_UNIT } else { LEAST_RANGE };
        let own = range(state).max(part * group.fold(0.0, f64::max));
        let [low, high] = ranges[state.place];
        // Of what does not move at all: its size, or one unit.
        match (own > 0.0, low.abs().max(high.abs())) {
            (true, _) => own,
            (false, size) if size > 0.0 => size,
            (false, _) => 1.0,
        }
    };
    states.iter().map(scale).collect()
}

impl StateExamination {
    fn new((state, range): (&MotionState, &f64)) -> Self {
        StateExamination {
            name: state.name.clone(),
            unit: state.unit.clone(),
            range: *range,
            largest_error: 0.0,
            largest_error_at_step: 0,
            resolved: true,
        }
    }

    fn add(&mut self, step: u64, error: f64) {
        // What is no number is the largest.
        if error.is_nan() || error > self.largest_error {
            (self.largest_error, self.largest_error_at_step) = (error, step);
        }
        self.resolved &= error <= SMALL * self.range;
    }

    /// The largest error relative to the motion.
    pub fn relative_error(&self) -> f64 {
        self.largest_error / self.range
    }
}

impl MotionExamination {
    /// Whether nothing moves.
    pub(crate) fn is_at_rest(&self) -> bool {
        let moves = |&[low, high]: &[f64; 2]| high > low;
        self.examined_steps > 0 && !self.ranges.iter().any(moves)
    }

    /// Whether a state, of positions and velocities, is within the motion or as near to it as the motion is wide.
    pub(crate) fn is_near(&self, at: &[f64], places: impl IntoIterator<Item = usize>) -> bool {
        places.into_iter().all(|place| {
            let [low, high] = self.ranges[place];
            let width = high - low + 1e-6 * low.abs().max(high.abs());
            (low - width..=high + width).contains(&at[place])
        })
    }
}
