//! The exact motion at samples.

use std::sync::atomic::AtomicBool;

use libration::analysis::jacobian;
use libration::linear::{Matrix, exponential};

use super::sample_steps::{sample_steps, with_knots};
use super::{MotionSubject, adaptive_reference};
use crate::AnalyzeError;

/// The differences that steps of the two adaptive references may have, relative to the range of a state: errors are compared with the
/// second, whose own error is that of the first or less.
const TOLERANCES: [f64; 2] = [1e-9, 1e-12];

/// Operations of the first reference. The same with samples where it is fast takes up to three times as many, the more accurate one four
/// times.
const MOST_OPERATIONS: u64 = 1 << 28;

/// The largest number of degrees of freedom for exponentials.
const MOST_DEGREES: usize = 32;

/// Why a reference ends before the last sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum End {
    /// It takes too many steps.
    Work,
    /// The motion ends at this time in s, or its forces jump there all the time.
    Motion(f64),
}

/// States at samples.
#[derive(Clone, Debug)]
pub(super) struct Samples {
    /// Positions, velocities and inputs at each sample that was reached.
    pub(super) states: Vec<Vec<f64>>,
    /// The least and the largest value of each of them.
    pub(super) ranges: Vec<[f64; 2]>,
    /// Why later ones are missing.
    pub(super) end: Option<End>,
    /// The first time in s about which forces may do more than evaluations show.
    pub(super) unseen: Option<f64>,
    /// The ends of adaptive steps, times in s.
    pub(super) knots: Vec<f64>,
}

impl Samples {
    pub(super) fn new(subject: &MotionSubject<'_>) -> Self {
        let ranges = subject.start.iter().map(|&x| [x; 2]).collect();
        Samples { states: Vec::new(), ranges, end: None, unseen: None, knots: Vec::new() }
    }

    pub(super) fn push(&mut self, state: &[f64]) {
        for (range, x) in self.ranges.iter_mut().zip(state) {
            *range = [range[0].min(*x), range[1].max(*x)];
        }
        self.states.push(state.to_vec());
    }
}

/// The exact motion, and one of less accuracy whose distance bounds its error.
pub(super) struct Reference {
    /// The numbers of the steps after which there are samples.
    pub(super) numbers: Vec<u64>,
    pub(super) kind: &'static str,
    pub(super) exact: Samples,
    pub(super) coarse: Samples,
}

impl Reference {
    /// The motion over `steps` steps of `dt` seconds.
    pub(super) fn new(
        subject: &MotionSubject<'_>,
        steps: u64,
        dt: f64,
        stop: &AtomicBool,
    ) -> Result<Self, AnalyzeError> {
        let mut numbers = sample_steps(steps);
        let times = |numbers: &[u64]| -> Vec<f64> {
            numbers.iter().map(|&number| number as f64 * dt).collect()
        };
        if let Some(exact) = exponentials(subject, &times(&numbers)) {
            return Ok(Reference { numbers, kind: "exponential", coarse: exact.clone(), exact });
        }
        let follow = |tolerance, numbers: &[u64], operations| {
            adaptive_reference::follow(subject, &times(numbers), tolerance, operations, true, stop)
        };
        let mut coarse = follow(TOLERANCES[0], &numbers, MOST_OPERATIONS)?;
        // Between few samples of many steps the motion may be fast.
        if (numbers.len() as u64) < steps && coarse.end.is_none() {
            numbers = with_knots(&numbers, &coarse.knots, dt);
            coarse = follow(TOLERANCES[0], &numbers, 3 * MOST_OPERATIONS)?;
        }
        let exact = follow(TOLERANCES[1], &numbers[..coarse.states.len()], 4 * MOST_OPERATIONS)?;
        Ok(Reference { numbers, kind: "adaptive", exact, coarse })
    }

    /// Number of samples that both reach.
    pub(super) fn known(&self) -> usize {
        self.exact.states.len().min(self.coarse.states.len())
    }

    /// Why later samples are missing.
    pub(super) fn end(&self) -> Option<End> {
        self.exact.end.or(self.coarse.end)
    }

    /// The first time in s about which forces may do more than evaluations show.
    pub(super) fn unseen(&self) -> Option<f64> {
        self.exact.unseen.or(self.coarse.unseen)
    }
}

/// The motion of a system with constant derivatives, by matrix exponentials from sample to sample: `x' = A x + c` with `c` as the column
/// of a state that is always 1. None for other systems.
fn exponentials(subject: &MotionSubject<'_>, times: &[f64]) -> Option<Samples> {
    let dynamics = subject.dynamics;
    let d = dynamics.degrees();
    if !subject.is_affine || d > MOST_DEGREES {
        return None;
    }
    let mut origin = subject.start.to_vec();
    origin[..2 * d].fill(0.0);
    let constant: Vec<f64> = dynamics.accelerations().on::<f64>().run(&origin).collect();
    let slopes = jacobian(dynamics, &origin);
    let rate = |i: usize, j: usize| match (i.checked_sub(d), j) {
        (None, j) => f64::from(u8::from(j == i + d)),
        (Some(row), j) if row < d && j < 2 * d => slopes[(row, j)],
        (Some(row), _) if row < d => constant[row],
        _ => 0.0,
    };
    let rates = Matrix::from_fn(2 * d + 1, 2 * d + 1, rate);
    let mut state = subject.start[..2 * d].to_vec();
    state.push(1.0);
    let mut samples = Samples::new(subject);
    let mut known: Option<(f64, Matrix)> = None;
    let mut before = 0.0;
    for &time in times {
        let span = time - before;
        let flow = match known.take() {
            Some((of, flow)) if of == span => flow,
            _ => exponential(&rates.scaled(span)),
        };
        state = flow.apply(&state);
        known = Some((span, flow));
        before = time;
        if state.iter().any(|x| !x.is_finite()) {
            samples.end = Some(End::Motion(time));
            break;
        }
        samples.push(&[&state[..2 * d], &subject.start[2 * d..]].concat());
    }
    Some(samples)
}
