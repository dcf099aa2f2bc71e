//! The exact motion by adaptive steps of order eight.

use std::sync::atomic::{AtomicBool, Ordering};

use libration::Method;
use libration::equations::{Evaluation, StepProgram};

use super::reference::{End, Samples};
use super::unseen::Unseen;
use super::{MotionState, MotionSubject};
use crate::AnalyzeError;

/// The integrator of the reference, of order eight for all forces.
const METHOD: &str = "dormand-prince-8";

/// The change of a step from one to the next.
const CHANGES: [f64; 2] = [0.1, 4.0];

/// A step that is shorter than this part of the motion shows that the motion ends, or that forces jump all the time.
const SHORTEST: f64 = 1e-15;

/// Steps are shortened to this part for what forces may do between their evaluations.
const LEAST_LOOK: f64 = 1e-12;

/// The most steps whose ends are kept.
const MOST_KNOTS: usize = 1 << 17;

/// Steps between two checks of the stop flag.
const CHUNK: u64 = 1 << 10;

/// Follows the exact motion to each of `times` by steps, each of which is compared with two of half the length. The difference is at
/// most `tolerance` of the range of each state so far; the better of the two is kept, whose own error is about 1/255 of it. With
/// `looks_between` a step is shortened until its evaluations show what forces may do in it.
pub(super) fn follow(
    subject: &MotionSubject<'_>,
    times: &[f64],
    tolerance: f64,
    most_operations: u64,
    looks_between: bool,
    stop: &AtomicBool,
) -> Result<Samples, AnalyzeError> {
    let mut samples = Samples::new(subject);
    // The list of integrators has it.
    let Some(method) = Method::from_name(METHOD) else { return Ok(samples) };
    let step = StepProgram::new(method, subject.dynamics);
    let operations = 3 * step.program().operations().max(1) as u64;
    let first = times.first().copied().unwrap_or(0.0);
    let mut stepper = Stepper::new(subject, &step, tolerance, expected(subject, first));
    stepper.expect(first);
    let horizon = times.last().copied().unwrap_or(0.0);
    let (mut length, mut trials, mut before) = (first, 0, 0.0);
    // The time up to which steps are not shortened, and the length of the first step that was.
    let mut seen_from = if looks_between { 0.0 } else { f64::INFINITY };
    let mut shortened: Option<f64> = None;
    for &time in times {
        let (span, mut done) = (time - before, 0.0);
        while done < span {
            trials += 1;
            if trials % CHUNK == 0 && stop.load(Ordering::Relaxed) {
                return Err(AnalyzeError::Interrupted);
            }
            if trials * operations > most_operations {
                samples.end = Some(End::Work);
                return Ok(samples);
            }
            let is_last = done + length >= span;
            let own = if is_last { span - done } else { length };
            let off = stepper.attempt(own);
            let mut change = (0.9 * off.powf(-1.0 / 9.0)).clamp(CHANGES[0], CHANGES[1]);
            let now = before + done;
            if off <= 1.0 && now >= seen_from {
                let unseen = stepper.unseen(own);
                // What smooth forces do between evaluations falls with the square of the step.
                let shorter = 0.9 * unseen.sqrt().recip();
                if unseen > 1.0 {
                    let longest = *shortened.get_or_insert(own);
                    length = own * shorter.clamp(CHANGES[0], 0.5);
                    if length < LEAST_LOOK * longest {
                        samples.unseen.get_or_insert(now);
                        (seen_from, length, shortened) = (now + longest, longest, None);
                    }
                    continue;
                }
                (change, shortened) = (change.min(shorter.max(1.0)), None);
            }
            if off <= 1.0 {
                stepper.accept();
                done = if is_last { span } else { done + own };
                if samples.knots.len() < MOST_KNOTS {
                    samples.knots.push(before + done);
                }
                // A step that was cut off at a sample says little about the next.
                length = if is_last { length.max(own * change) } else { own * change };
            } else {
                length = own * if change.is_finite() { change.min(0.5) } else { CHANGES[0] };
                if length < SHORTEST * horizon || before + done + length == before + done {
                    samples.end = Some(End::Motion(before + done));
                    return Ok(samples);
                }
            }
        }
        before = time;
        samples.push(&stepper.inputs[..subject.start.len()]);
        samples.ranges.clone_from(&stepper.ranges);
    }
    Ok(samples)
}

/// The change of each position and velocity in the time of a step of the request, at the rates of the start.
fn expected(subject: &MotionSubject<'_>, dt: f64) -> Vec<f64> {
    let degrees = subject.dynamics.degrees();
    let rates: Vec<f64> = subject.dynamics.accelerations().on::<f64>().run(subject.start).collect();
    let velocities = &subject.start[degrees..2 * degrees];
    let changes = velocities.iter().chain(&rates).map(|rate| (rate * dt).abs());
    changes.map(|change| if change.is_finite() { change } else { 0.0 }).collect()
}

/// Steps with their errors.
struct Stepper<'a> {
    states: &'a [MotionState],
    between: Unseen<'a>,
    step: Evaluation<'a, f64>,
    tolerance: f64,
    /// Positions, velocities, inputs and the length of a step.
    inputs: Vec<f64>,
    trial: Vec<f64>,
    middle: Vec<f64>,
    end: Vec<f64>,
    /// The least and the largest value of each position and velocity.
    ranges: Vec<[f64; 2]>,
    /// Ranges that are expected: until a motion has begun, its range so far says nothing.
    expected: Vec<f64>,
}

impl<'a> Stepper<'a> {
    fn new(
        subject: &MotionSubject<'a>,
        step: &'a StepProgram,
        tolerance: f64,
        expected: Vec<f64>,
    ) -> Self {
        let mut inputs = subject.start.to_vec();
        inputs.push(0.0);
        Stepper {
            states: subject.states,
            between: Unseen::new(subject),
            step: step.program().on(),
            tolerance,
            trial: inputs.clone(),
            middle: Vec::new(),
            end: Vec::new(),
            ranges: subject.start.iter().map(|&x| [x; 2]).collect(),
            expected,
            inputs,
        }
    }

    /// Expects no less than the change in a step of this length, if its error is allowed: rates of a start at rest say nothing.
    fn expect(&mut self, length: f64) {
        if self.attempt(length) <= 1.0 {
            for (place, expected) in self.expected.iter_mut().enumerate() {
                *expected = expected.max((self.end[place] - self.inputs[place]).abs());
            }
        }
    }

    /// The error of a step, where 1 is allowed.
    fn attempt(&mut self, length: f64) -> f64 {
        let Stepper { step, trial, inputs, middle, end, .. } = self;
        let last = inputs.len() - 1;
        trial.copy_from_slice(inputs);
        trial[last] = length;
        let whole: Vec<f64> = step.run(trial).collect();
        trial[last] = 0.5 * length;
        middle.clear();
        middle.extend(step.run(trial));
        trial[..middle.len()].copy_from_slice(middle);
        end.clear();
        end.extend(step.run(trial));
        let size = |place: usize| {
            let [low, high] = self.ranges[place];
            low.abs().max(high.abs()).max(self.end[place].abs())
        };
        let all = self.states.iter().fold(0.0, |most, state| f64::max(most, size(state.place)));
        let mut worst = 0.0;
        for state in self.states {
            let place = state.place;
            let off = (whole[place] - self.end[place]).abs();
            let [low, high] = self.ranges[place];
            let range = high.max(self.end[place]) - low.min(self.end[place]);
            let range = range.max(self.expected[place]);
            let like = self.states.iter().filter(|other| other.is_like(state));
            let group = like.fold(0.0, |most, other| f64::max(most, size(other.place)));
            // Rounding of the state, of those that it is a difference of, and of all others.
            let rounding = f64::EPSILON * (8.0 * size(place) + group + 1e-3 * all);
            let part = if off == 0.0 { 0.0 } else { off / (self.tolerance * range + rounding) };
            worst = if part > worst || part.is_nan() { part } else { worst };
        }
        match self.end.iter().all(|x| x.is_finite()) && !f64::is_nan(worst) {
            true => worst,
            false => f64::INFINITY,
        }
    }

    /// The largest change by forces that the evaluations of the attempted step do not show, where 1 is allowed.
    fn unseen(&mut self, length: f64) -> f64 {
        let Stepper { inputs, middle, end, ranges, expected, .. } = self;
        let range = |place: usize| {
            let [low, high] = ranges[place];
            (high.max(end[place]) - low.min(end[place])).max(expected[place])
        };
        let start = &inputs[..inputs.len() - 1];
        self.between.largest(start, [middle, end], length, range)
    }

    fn accept(&mut self) {
        for states in [&self.middle, &self.end] {
            for (range, x) in self.ranges.iter_mut().zip(states) {
                *range = [range[0].min(*x), range[1].max(*x)];
            }
        }
        let states = self.end.len();
        self.inputs[..states].copy_from_slice(&self.end);
    }
}
