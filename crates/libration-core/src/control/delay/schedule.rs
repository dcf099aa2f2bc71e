//! Schedules: times of samples and of commands.

use thiserror::Error;

use crate::control::Latency;

/// A time in steps, as a multiple of 2⁻⁶⁴: sums of it are exact for ever.
type Time = u128;

/// The fraction of a [`Time`].
const FRACTION: u32 = 64;

/// A schedule: the sample time, the latency of observations and the latency of commands.
///
/// Command `k` is computed at the time `k·period`, from the state that was `observation` earlier, and acts from `action`
/// later on until the next one does. Steps split where something happens within them. A command whose observation
/// would lie before the start is not computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Schedule {
    period: Time,
    observation: Time,
    action: Time,
}

/// Error of a schedule.
#[derive(Clone, Copy, Debug, Error, PartialEq)]
pub enum ScheduleError {
    /// A latency is none.
    #[error(
        "the {name} is {value} steps; it must be at least 0 and at most {}",
        Latency::MOST_STEPS
    )]
    Latency {
        /// The name of the value.
        name: &'static str,
        /// In steps.
        value: f64,
    },
    /// A sample time is none.
    #[error(
        "the sample time is {value} steps; it must be at least 1/64 and at most {}",
        Latency::MOST_STEPS
    )]
    Period {
        /// In steps.
        value: f64,
    },
}

/// An event within a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// Command number so and so is computed from the state there.
    Sample(i128),
    /// The command with this number begins to act; a negative one is the initial command.
    Actuate(i128),
}

impl Schedule {
    /// A sample at the beginning of every step, whose command acts at once.
    pub const EVERY_STEP: Schedule = Schedule { period: 1 << FRACTION, observation: 0, action: 0 };

    /// A sample every `period` steps, with both latencies in steps.
    ///
    /// # Errors
    /// [`ScheduleError`] if a value is not a number, negative or too large.
    pub fn new(period: f64, observation: f64, action: f64) -> Result<Self, ScheduleError> {
        let most = Latency::MOST_STEPS as f64;
        if !(1.0 / 64.0..=most).contains(&period) {
            return Err(ScheduleError::Period { value: period });
        }
        let latencies =
            [("latency of the observation", observation), ("latency of the command", action)];
        if let Some(&(name, value)) = latencies.iter().find(|(_, x)| !(0.0..=most).contains(x)) {
            return Err(ScheduleError::Latency { name, value });
        }
        let [period, observation, action] = [period, observation, action].map(time);
        Ok(Schedule { period, observation, action })
    }

    /// A sample at the beginning of every step, whose command has a latency.
    pub fn late(latency: Latency) -> Self {
        Schedule { action: time(latency.steps()), ..Schedule::EVERY_STEP }
    }

    /// Between two samples, in steps.
    #[inline]
    pub fn period(&self) -> f64 {
        self.period as f64 / (1_u128 << FRACTION) as f64
    }

    /// The largest number of commands in transit.
    #[inline]
    pub fn commands_in_transit(&self) -> usize {
        (self.observation + self.action).div_ceil(self.period) as usize
    }

    /// The number of steps between a sample and its command, if both are at the beginning of every
    /// step.
    #[inline]
    pub fn whole_steps(&self) -> Option<usize> {
        let whole = |time: Time| time.trailing_zeros() >= FRACTION;
        let all = self.period == 1 << FRACTION && whole(self.observation) && whole(self.action);
        all.then(|| ((self.observation + self.action) >> FRACTION) as usize)
    }

    /// The events within a step, in order, each with its fraction of the step. Commands from before the start arrive as well: they
    /// stand for the initial command.
    #[inline]
    pub fn events(&self, step: u64) -> impl Iterator<Item = (f64, Event)> {
        let [begin, period, observation, action] =
            [Time::from(step) << FRACTION, self.period, self.observation, self.action]
                .map(Time::cast_signed);
        let end = begin + (1 << FRACTION);
        let next = |time: i128| time.div_euclid(period) + i128::from(time.rem_euclid(period) > 0);
        // Commands whose look, or effect, lies in [begin, end).
        let (mut look, mut act) = (next(begin + observation), next(begin - action));
        core::iter::from_fn(move || {
            let (seen, done) = (look * period - observation, act * period + action);
            let part = |time: i128| (time - begin) as f64 / (1_u128 << FRACTION) as f64;
            // A command that takes no time is computed first.
            if seen < end && seen <= done {
                look += 1;
                Some((part(seen), Event::Sample(look - 1)))
            } else if done < end {
                act += 1;
                Some((part(done), Event::Actuate(act - 1)))
            } else {
                None
            }
        })
    }
}

/// A time that was checked.
fn time(steps: f64) -> Time {
    // Whole steps and their fraction, each exact.
    ((steps.trunc() as Time) << FRACTION) + (steps.fract() * (1_u128 << FRACTION) as f64) as Time
}

#[cfg(test)]
mod tests {
    use super::Event::{Actuate, Sample};
    use super::*;

    fn events(schedule: Schedule, step: u64) -> Vec<(f64, Event)> {
        schedule.events(step).collect()
    }

    #[test]
    fn without_latency_each_step_begins_with_a_look_and_its_effect() {
        assert_eq!(events(Schedule::EVERY_STEP, 7), [(0.0, Sample(7)), (0.0, Actuate(7))]);
        assert_eq!(Schedule::EVERY_STEP.whole_steps(), Some(0));
    }

    #[test]
    fn a_command_acts_when_its_latency_is_over_and_not_before() {
        let late = Schedule::new(1.0, 0.0, 2.25).unwrap();
        // Steps split there before the first command as after it.
        assert_eq!(events(late, 0), [(0.0, Sample(0)), (0.25, Actuate(-2))]);
        assert_eq!(events(late, 1), [(0.0, Sample(1)), (0.25, Actuate(-1))]);
        assert_eq!(events(late, 2), [(0.0, Sample(2)), (0.25, Actuate(0))]);
        assert_eq!(events(late, 5), [(0.0, Sample(5)), (0.25, Actuate(3))]);
        assert_eq!((late.whole_steps(), late.commands_in_transit()), (None, 3));
    }

    #[test]
    fn an_observation_that_is_late_was_made_earlier() {
        let late = Schedule::new(1.0, 1.5, 0.5).unwrap();
        // Command 2 is computed at time 2, from the state at time 0.5; 1 would look at −0.5.
        assert_eq!(events(late, 0), [(0.5, Sample(2)), (0.5, Actuate(0))]);
        assert_eq!(events(late, 2), [(0.5, Sample(4)), (0.5, Actuate(2))]);
    }

    #[test]
    fn samples_need_not_fall_on_steps_and_never_slip() {
        let third = Schedule::new(2.5, 0.0, 1.0).unwrap();
        assert_eq!(events(third, 2), [(0.5, Sample(1))]);
        assert_eq!(events(third, 3), [(0.5, Actuate(1))]);
        // A billion samples later.
        assert_eq!(events(third, 2_500_000_002), [(0.5, Sample(1_000_000_001))]);
        let fast = Schedule::new(0.5, 0.0, 0.0).unwrap();
        let twice = [(0.0, Sample(6)), (0.0, Actuate(6)), (0.5, Sample(7)), (0.5, Actuate(7))];
        assert_eq!(events(fast, 3), twice);
    }

    #[test]
    fn what_is_no_latency_is_refused() {
        for bad in [-1.0, f64::NAN, f64::INFINITY, 5000.0] {
            assert!(matches!(Schedule::new(1.0, bad, 0.0), Err(ScheduleError::Latency { .. })));
            assert!(matches!(Schedule::new(1.0, 0.0, bad), Err(ScheduleError::Latency { .. })));
            assert!(matches!(Schedule::new(bad, 0.0, 0.0), Err(ScheduleError::Period { .. })));
        }
        let error = Schedule::new(1.0, 0.0, -1.0).unwrap_err().to_string();
        assert_eq!(
            error,
            "the latency of the command is -1 steps; it must be at least 0 and at most 4096"
        );
    }
}
