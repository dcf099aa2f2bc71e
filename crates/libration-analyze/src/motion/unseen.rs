//! What forces may do between the evaluations of a step.

use libration::equations::{Enclosure, Evaluation, Interval};

use super::{MotionState, MotionSubject, SMALL};

/// The largest part of a step of the reference without an evaluation: a force that is not seen acts for no longer.
const GAP: f64 = 0.125;

/// The part of the largest range of states of its kind from which the own range of a state counts. Below it, it may be rounding.
const LEAST_RANGE: f64 = 1e-6;

/// How far a motion leaves the hull of a step's three states, as a part of their second difference. A parabola through them leaves it by at
/// most an eighth; a clock does not leave it.
const BEYOND: f64 = 0.25;

/// A change that is no change.
const NOTHING: f64 = 1e-200;

/// Accelerations over all states of a step, beside those at three states.
pub(super) struct Unseen<'a> {
    states: &'a [MotionState],
    degrees: usize,
    enclosure: Enclosure<'a>,
    rates: Evaluation<'a, f64>,
    boxes: Vec<Interval>,
    sampled: Vec<Interval>,
}

impl<'a> Unseen<'a> {
    pub(super) fn new(subject: &MotionSubject<'a>) -> Self {
        let accelerations = subject.dynamics.accelerations();
        Unseen {
            states: subject.states,
            degrees: subject.dynamics.degrees(),
            enclosure: accelerations.enclosure(),
            rates: accelerations.on(),
            boxes: Vec::new(),
            sampled: Vec::new(),
        }
    }

    /// The largest change of a velocity that no evaluation of a step shows, where 1 is what makes an error that counts: the forces of a step
    /// may reach values between three of its states that they do not have at these. `inputs` are positions, velocities and inputs at its
    /// beginning, and `range` is that of a state by its place.
    pub(super) fn largest(
        &mut self,
        inputs: &[f64],
        states: [&[f64]; 2],
        length: f64,
        range: impl Fn(usize) -> f64,
    ) -> f64 {
        let count = 2 * self.degrees;
        self.boxes.clear();
        self.boxes.extend(inputs.iter().map(|&x| [x, x]));
        self.sampled.clear();
        self.sampled.extend(self.rates.run(inputs).map(|x| [x, x]));
        let mut at = inputs.to_vec();
        for state in states {
            at[..count].copy_from_slice(&state[..count]);
            widen(&mut self.boxes, &at);
            for (own, x) in self.sampled.iter_mut().zip(self.rates.run(&at)) {
                *own = [own[0].min(x), own[1].max(x)];
            }
        }
        let [middle, end] = states;
        for (place, [low, high]) in self.boxes[..count].iter_mut().enumerate() {
            let beyond = BEYOND * (inputs[place] - 2.0 * middle[place] + end[place]).abs();
            (*low, *high) = (*low - beyond, *high + beyond);
        }
        let all: Vec<Interval> = self.enclosure.run(&self.boxes).collect();
        let mut worst = 0.0_f64;
        for state in self.states {
            let Some(degree) = state.place.checked_sub(self.degrees) else { continue };
            let ([low, high], [least, most]) = (all[degree], self.sampled[degree]);
            let change = GAP * length * (high - most).max(least - low);
            if change > NOTHING {
                let like = self.states.iter().filter(|other| other.is_like(state));
                let group = like.fold(0.0, |most, other| f64::max(most, range(other.place)));
                let own = range(state.place);
                let own = if own > LEAST_RANGE * group { own } else { group };
                worst = worst.max(change / (SMALL * own));
            }
        }
        worst
    }
}

fn widen(boxes: &mut [Interval], at: &[f64]) {
    for (own, x) in boxes.iter_mut().zip(at) {
        *own = [own[0].min(*x), own[1].max(*x)];
    }
}
