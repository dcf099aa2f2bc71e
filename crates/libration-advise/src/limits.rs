//! Limits of each imperfection of a loop.

use libration::linear::{LatencyWindow, LinearLoopError, LoopTiming};

use super::imperfection::Imperfection;
use super::request::{Measure, Tolerance};
use super::subject::Subject;
use super::timed_loop::TimedLoop;

/// The limit of an imperfection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Limit {
    /// The loop is unstable without the imperfection.
    None,
    /// The largest stable size.
    Value(f64),
    /// No limit up to this size, the largest tried.
    Beyond(f64),
}

/// Smallest largest tried latency, in periods.
const MOST_PERIODS: f64 = 160.0;

/// Largest tried latency, in periods, unless more is stated.
const TRIED_PERIODS: f64 = 240.0;

/// Latency in periods below which times of a period are taken for the same: a shorter limit is none.
const RESOLUTION: f64 = 2e-12;

/// Smallest number of tried sizes before the first unstable one is bisected.
const TRIED: u32 = 64;

/// Latency in periods above which nine digits suffice.
const LONG: f64 = 32.0;

/// Whole periods on both sides of which latencies are tried, of a plant with a direct path.
const WHOLE: u32 = 64;

/// Largest tried probability of a loss.
pub(super) const MOST_LOSS: f64 = 1.0 - 1e-9;

/// Number of bisections: to the digits of a float.
const HALVINGS: u32 = 48;

impl TimedLoop {
    /// The largest tried size.
    pub(super) fn largest(&self, subject: Subject) -> f64 {
        let stated = self.stated_size(subject);
        match subject.kind {
            // The stated size and some more.
            Imperfection::Latency | Imperfection::OutputLatency => {
                let stated = stated / self.period();
                (1.5 * stated).clamp(MOST_PERIODS, TRIED_PERIODS.max(stated))
            }
            // Above it, most steps of a Gaussian law are zero or twice too long. A record may exceed it.
            Imperfection::Jitter => (2.0 * stated).max(1.0),
            Imperfection::Skew if stated < 0.0 => 0.999,
            Imperfection::Skew => 8.0,
            Imperfection::Loss => MOST_LOSS,
        }
    }

    /// The largest size with which the loop is stable, in the mean square for random imperfections.
    pub(super) fn stable_up_to(
        &self,
        subject: Subject,
        windows: Option<&[LatencyWindow]>,
    ) -> Result<Limit, LinearLoopError> {
        Ok(match self.found_up_to(subject, windows)? {
            Limit::Value(size) if subject.is_latency() && size < RESOLUTION => Limit::Value(0.0),
            found => found,
        })
    }

    fn found_up_to(
        &self,
        subject: Subject,
        windows: Option<&[LatencyWindow]>,
    ) -> Result<Limit, LinearLoopError> {
        let largest = self.largest(subject);
        let within = |end: Option<f64>| match end.filter(|end| *end <= largest) {
            Some(end) => Limit::Value(end),
            None => Limit::Beyond(largest),
        };
        if let (Imperfection::Latency, Some(critical)) = (subject.kind, self.critical_latency) {
            return Ok(within(critical.0));
        }
        let Some(windows) = windows else {
            return self.holds_up_to(subject, |with| self.decays(with));
        };
        if !self.decays(&self.ideal())? {
            return Ok(Limit::None);
        }
        Ok(match windows.first() {
            Some(first) if first.from == 0.0 => within(first.to),
            _ => Limit::Value(0.0),
        })
    }

    /// The largest size with a tolerated cost; none without a tolerance of the cost.
    pub(super) fn tolerated_up_to(
        &self,
        subject: Subject,
        tolerance: Tolerance,
    ) -> Result<Option<Limit>, LinearLoopError> {
        if tolerance.of != Measure::Cost {
            return Ok(None);
        }
        let ideal = self.cost(&self.ideal())?;
        let limit = self
            .holds_up_to(subject, |with| Ok(self.cost(with)? <= (1.0 + tolerance.most) * ideal))?;
        Ok(Some(limit))
    }

    /// The tried sizes in rising order, including the stated one.
    pub(super) fn tried_sizes(
        &self,
        subject: Subject,
        largest: f64,
    ) -> Result<Vec<f64>, LinearLoopError> {
        // The plant turns by a part of a radian between two sizes: most windows of instability are wider.
        const PART: f64 = 0.25;
        let turn = self.rate() * self.period();
        let even = |count: u32| (1..=count).map(move |i| largest * f64::from(i) / f64::from(count));
        let fine = ((turn * largest / PART).ceil() as u32).clamp(TRIED, 32 * TRIED);
        let late = subject.is_latency();
        let mut sizes: Vec<f64> = match subject.kind {
            Imperfection::Skew => even(fine).collect(),
            // Each trial passes through the whole record.
            Imperfection::Jitter if self.timing.record.is_some() => even(TRIED / 4).collect(),
            Imperfection::Jitter | Imperfection::Loss => even(TRIED).collect(),
            // Quarters of a period, then whole ones.
            Imperfection::Latency | Imperfection::OutputLatency => {
                let direct = self.has_direct_path();
                let step = |at: f64| match (self.is_sampled(), direct) {
                    (true, _) => 1.0,
                    // A direct path shows commands that take over at whole periods: windows beside these may be narrow.
                    (_, true) => (PART / turn).clamp(0.01, if at < 8.0 { 0.02 } else { 0.25 }),
                    _ => (PART / turn).clamp(0.01, if at < 8.0 { 0.25 } else { 1.0 }),
                };
                let next = |at: &f64| Some(at + step(*at)).filter(|next| *next < largest);
                core::iter::successors(Some(step(0.0)), next).chain([largest]).collect()
            }
        };
        let stated = match (late, self.stated_size(subject)) {
            (true, seconds) => self.latency(seconds / self.period())?.steps(),
            (false, size) => size.abs(),
        };
        if late && self.has_direct_path() {
            let whole = (1..=WHOLE).map(f64::from).filter(|whole| *whole + 1e-9 < largest);
            sizes.extend(whole.flat_map(|whole| [whole - 1e-9, whole, whole + 1e-9]));
        }
        sizes.extend(Some(stated).filter(|size| (0.0..largest).contains(size)));
        sizes.sort_by(f64::total_cmp);
        Ok(sizes)
    }

    fn holds_up_to(
        &self,
        subject: Subject,
        holds: impl Fn(&LoopTiming) -> Result<bool, LinearLoopError>,
    ) -> Result<Limit, LinearLoopError> {
        let at = |size: f64| holds(&self.single(subject, size)?);
        let late = subject.is_latency();
        if !at(0.0)? {
            return Ok(Limit::None);
        }
        let largest = self.largest(subject);
        let mut low = 0.0;
        for size in self.tried_sizes(subject, largest)? {
            match at(size) {
                Ok(true) => {
                    low = size;
                    continue;
                }
                Ok(false) => {}
                // The rest is too large to analyse.
                Err(LinearLoopError::Size { .. }) => return Ok(Limit::Beyond(low)),
                Err(error) => return Err(error),
            }
            if late && self.is_sampled() {
                return Ok(Limit::Value(low));
            }
            let mut high = size;
            let replays = subject.kind == Imperfection::Jitter && self.timing.record.is_some();
            for _ in 0..if replays { HALVINGS / 2 } else { HALVINGS } {
                // Long queues are costly.
                if late && high > LONG && high - low < 1e-9 * high {
                    break;
                }
                let middle = 0.5 * (low + high);
                if at(middle)? { low = middle } else { high = middle }
            }
            return Ok(Limit::Value(low));
        }
        Ok(Limit::Beyond(largest))
    }
}
