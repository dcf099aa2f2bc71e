//! Timing of contestants in alternation, so that load of the machine affects all of them.

use std::hint::black_box;
use std::sync::atomic::{Ordering, compiler_fence};
use std::time::Instant;

use libration_study::{Lab, StudyError};

/// A measured piece of work.
pub(crate) struct Contestant<'a> {
    /// Repeats the work a number of times.
    run: Box<dyn FnMut(u64) + 'a>,
    /// Amount of one repetition, in the unit of the rates.
    work: f64,
}

impl<'a> Contestant<'a> {
    /// One that does `work` units of work with each time that `run` is told to do.
    pub(crate) fn new(work: f64, run: impl FnMut(u64) + 'a) -> Self {
        Contestant { run: Box::new(run), work }
    }

    /// Seconds for so many times.
    fn time(&mut self, times: u64) -> f64 {
        // Nothing of the work may be moved out from between the two looks at the clock.
        compiler_fence(Ordering::SeqCst);
        let begun = Instant::now();
        (self.run)(black_box(times));
        compiler_fence(Ordering::SeqCst);
        begun.elapsed().as_secs_f64()
    }
}

/// Returns the number of repetitions that fill a turn of a duration, by what `time` takes for some.
fn calibrated<E>(seconds: f64, mut time: impl FnMut(u64) -> Result<f64, E>) -> Result<u64, E> {
    // The first turn warms caches and branch predictors up.
    let mut times = 1;
    let mut took = time(times)?;
    took = took.min(time(times)?);
    while took < seconds / 4.0 && times < 1 << 40 {
        let missing = (seconds / took.max(1e-9)).clamp(2.0, 64.0);
        times = (times as f64 * missing) as u64;
        took = time(times)?;
    }
    Ok(((times as f64 * seconds / took) as u64).max(1))
}

/// Number and duration of turns.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turns {
    /// Number of turns of each contestant.
    pub(crate) rounds: usize,
    /// Least duration of a turn in s.
    pub(crate) seconds: f64,
}

/// Lets contestants take turns, and gives the rates of each: units of work per second, round by round.
///
/// # Errors
/// If the run is to stop.
pub(crate) fn race(
    lab: &Lab<'_>,
    turns: Turns,
    contestants: &mut [Contestant<'_>],
) -> Result<Vec<Rates>, StudyError> {
    let mut times = Vec::with_capacity(contestants.len());
    for contestant in &mut *contestants {
        times.push(calibrated(turns.seconds, |times| {
            lab.check()?;
            Ok::<_, StudyError>(contestant.time(times))
        })?);
    }
    let mut rates = vec![Vec::with_capacity(turns.rounds); contestants.len()];
    for round in 0..turns.rounds {
        for turn in 0..contestants.len() {
            lab.check()?;
            // Each is the first as often as the others.
            let i = (round + turn) % contestants.len();
            let seconds = contestants[i].time(times[i]);
            rates[i].push(contestants[i].work * times[i] as f64 / seconds);
        }
    }
    Ok(rates.into_iter().map(Rates).collect())
}

/// Rates of one contestant, round by round; or ratios of rates.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Rates(Vec<f64>);

impl Rates {
    /// Those of rounds that were timed elsewhere.
    pub(crate) fn of(rounds: Vec<f64>) -> Self {
        Rates(rounds)
    }

    /// The middle one.
    pub(crate) fn median(&self) -> f64 {
        self.quantile(0.5)
    }

    /// The distance between the quartiles, between which half of the rounds lie.
    pub(crate) fn spread(&self) -> f64 {
        self.quantile(0.75) - self.quantile(0.25)
    }

    /// Returns the number of rounds.
    pub(crate) fn rounds(&self) -> usize {
        self.0.len()
    }

    /// Combines these rates with others, round by round.
    pub(crate) fn with(&self, other: &Rates, combine: impl Fn(f64, f64) -> f64) -> Rates {
        Rates(self.0.iter().zip(&other.0).map(|(&own, &other)| combine(own, other)).collect())
    }

    /// Combines these rates with two others, round by round.
    pub(crate) fn with_two(
        &self,
        [one, two]: [&Rates; 2],
        combine: impl Fn(f64, f64, f64) -> f64,
    ) -> Rates {
        let others = one.0.iter().zip(&two.0);
        let all = self.0.iter().zip(others);
        Rates(all.map(|(&own, (&one, &two))| combine(own, one, two)).collect())
    }

    /// The times of a unit of work, or the inverse ratios.
    pub(crate) fn inverted(&self) -> Rates {
        Rates(self.0.iter().map(|rate| rate.recip()).collect())
    }

    /// The ratios to other rates, each to that of the same round.
    pub(crate) fn over(&self, other: &Rates) -> Rates {
        self.with(other, |own, other| own / other)
    }

    /// These in another unit, `factor` of which are one of the old.
    pub(crate) fn scaled(&self, factor: f64) -> Rates {
        Rates(self.0.iter().map(|rate| rate * factor).collect())
    }

    fn quantile(&self, share: f64) -> f64 {
        let mut sorted = self.0.clone();
        sorted.sort_by(f64::total_cmp);
        let at = share * (sorted.len().max(1) - 1) as f64;
        let value = |i: usize| sorted.get(i).copied().unwrap_or(f64::NAN);
        let (low, high) = (value(at.floor() as usize), value(at.ceil() as usize));
        low + (high - low) * at.fract()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_in_the_middle_and_the_spread_between_the_quartiles() {
        let rates = Rates(vec![4.0, 1.0, 100.0, 2.0, 3.0]);
        assert_eq!([rates.median(), rates.spread()], [3.0, 2.0]);
        assert_eq!(Rates(vec![1.0, 2.0]).median(), 1.5);
    }

    #[test]
    fn ratios_are_taken_round_by_round_so_that_common_noise_cancels() {
        let noisy = Rates(vec![10.0, 5.0, 20.0]);
        assert_eq!(noisy.over(&Rates(vec![5.0, 2.5, 10.0])).spread(), 0.0);
    }

    #[test]
    fn a_turn_is_filled_by_as_many_times_as_fit_whatever_the_first_time_takes() {
        let mut first = true;
        let times = calibrated(0.01, |times| {
            let cold = if std::mem::take(&mut first) { 0.5 } else { 0.0 };
            Ok::<_, StudyError>(cold + 2e-4 * times as f64)
        });
        // 0.01 s / 0.2 ms, one less where the quotient is rounded down.
        assert!((49..=50).contains(&times.expect("nothing fails")));
    }
}
