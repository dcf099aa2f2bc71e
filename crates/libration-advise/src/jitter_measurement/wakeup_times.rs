//! Wake-ups of an empty periodic loop.

use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use super::JitterMeasurementError;
use super::load::Load;

/// The plan of a measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// Wake-ups per second.
    pub rate: f64,
    /// The duration, in s.
    pub seconds: f64,
    /// Whether all cores are busy during the measurement.
    pub load: bool,
}

/// The scheduling priority.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Priority {
    /// The default priority.
    Ordinary,
    /// Real-time priority, first in, first out.
    Raised,
}

/// The times of wake-ups.
#[derive(Clone, Debug, PartialEq)]
pub struct WakeupTimes {
    /// The interval between deadlines, in ns.
    pub period: u64,
    /// Times after the first deadline, in ns; deadline `k` is `k` periods after it.
    pub times: Vec<u64>,
    /// Whether the measurement was stopped early.
    pub stopped: bool,
}

/// Largest number of wake-ups of a measurement.
const MOST: f64 = 5e7;

/// Smallest number of wake-ups of a measurement.
pub(super) const FEWEST: usize = 16;

impl Plan {
    /// Checks the numbers.
    ///
    /// # Errors
    /// [`JitterMeasurementError::Value`]: the first invalid number.
    pub fn check(&self) -> Result<(), JitterMeasurementError> {
        let Plan { rate, seconds, .. } = *self;
        let wrong = |name, value, allowed: String| {
            Err(JitterMeasurementError::Value { name, value, allowed })
        };
        if !(0.1..=100_000.0).contains(&rate) {
            return wrong("rate", rate, "from 0.1 to 100000 Hz".into());
        }
        let (least, most) = (FEWEST as f64 / rate, (MOST / rate).min(86_400.0));
        if !(least..=most).contains(&seconds) {
            let allowed = format!("from {least} to {most} s, of {FEWEST} to {MOST} wake-ups");
            return wrong("seconds", seconds, allowed);
        }
        Ok(())
    }

    /// The number of wake-ups.
    fn count(&self) -> usize {
        // A product of decimals may be a rounding short of a whole number.
        (self.seconds * self.rate * (1.0 + 4.0 * f64::EPSILON)) as usize
    }

    /// Runs the loop on a separate thread.
    ///
    /// Memory is allocated before the loop, which only reads the clock. Deadlines are on a grid, so that lateness does not
    /// accumulate.
    ///
    /// # Errors
    /// [`JitterMeasurementError`], also if `stop` is set before there are enough wake-ups.
    pub fn measure(
        &self,
        priority: Priority,
        stop: &AtomicBool,
    ) -> Result<WakeupTimes, JitterMeasurementError> {
        self.check()?;
        let period = (1e9 / self.rate).round() as u64;
        let count = self.count();
        // Writing the pages allocates them.
        let mut times = vec![u64::MAX; count];
        let _load = self.load.then(Load::begin);
        let woken = thread::scope(|scope| {
            let measuring = scope.spawn(|| {
                if priority == Priority::Raised {
                    raise()?;
                }
                timer::wake_up(period, &mut times, stop).map_err(JitterMeasurementError::Timer)
            });
            measuring.join().unwrap_or(Err(JitterMeasurementError::Interrupted))
        })?;
        times.truncate(woken);
        if woken < FEWEST {
            return Err(JitterMeasurementError::Interrupted);
        }
        Ok(WakeupTimes { period, times, stopped: stop.load(Ordering::Relaxed) })
    }
}

/// Raises the priority of the calling thread.
#[cfg(unix)]
fn raise() -> Result<(), JitterMeasurementError> {
    use thread_priority::{
        RealtimeThreadSchedulePolicy, ThreadPriority, ThreadPriorityValue, ThreadSchedulePolicy,
        set_thread_priority_and_policy, thread_native_id,
    };
    // Above threaded interrupts at 50, and below the watchdogs of the system at 99.
    let value = ThreadPriorityValue::try_from(80)
        .map_err(|error| JitterMeasurementError::NotAllowed(error.to_string()))?;
    set_thread_priority_and_policy(
        thread_native_id(),
        ThreadPriority::Crossplatform(value),
        ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo),
    )
    .map_err(|error| JitterMeasurementError::NotAllowed(error.to_string()))
}

#[cfg(not(unix))]
fn raise() -> Result<(), JitterMeasurementError> {
    Err(JitterMeasurementError::NotAllowed("not supported on this platform".into()))
}

#[cfg(target_os = "linux")]
mod timer {
    //! Absolute deadlines on the monotonic clock.

    use std::io;
    use std::sync::atomic::{AtomicBool, Ordering};

    use rustix::io::Errno;
    use rustix::thread::{ClockId, clock_nanosleep_absolute};
    use rustix::time::{Timespec, clock_gettime};

    const SECOND: u64 = 1_000_000_000;

    fn now() -> u64 {
        let time = clock_gettime(ClockId::Monotonic);
        time.tv_sec as u64 * SECOND + time.tv_nsec as u64
    }

    /// Wakes up once per element of `times` and returns the number of wake-ups.
    pub(super) fn wake_up(period: u64, times: &mut [u64], stop: &AtomicBool) -> io::Result<usize> {
        let first = now() + 2 * period;
        for (k, time) in times.iter_mut().enumerate() {
            let deadline = first + k as u64 * period;
            let at =
                Timespec { tv_sec: (deadline / SECOND) as i64, tv_nsec: (deadline % SECOND) as _ };
            // A signal ends the sleep too early.
            while let Err(error) = clock_nanosleep_absolute(ClockId::Monotonic, &at) {
                if error != Errno::INTR {
                    return Err(error.into());
                }
                if stop.load(Ordering::Relaxed) {
                    return Ok(k);
                }
            }
            *time = now().saturating_sub(first);
            if stop.load(Ordering::Relaxed) {
                return Ok(k + 1);
            }
        }
        Ok(times.len())
    }
}

#[cfg(not(target_os = "linux"))]
mod timer {
    //! Sleeps up to a deadline, for platforms without absolute deadlines.

    use std::sync::atomic::{AtomicBool, Ordering};
    use std::time::{Duration, Instant};
    use std::{io, thread};

    /// Wakes up once per element of `times` and returns the number of wake-ups.
    pub(super) fn wake_up(period: u64, times: &mut [u64], stop: &AtomicBool) -> io::Result<usize> {
        let first = Instant::now() + Duration::from_nanos(2 * period);
        for (k, time) in times.iter_mut().enumerate() {
            let deadline = first + Duration::from_nanos(k as u64 * period);
            thread::sleep(deadline.saturating_duration_since(Instant::now()));
            *time = Instant::now().saturating_duration_since(first).as_nanos() as u64;
            if stop.load(Ordering::Relaxed) {
                return Ok(k + 1);
            }
        }
        Ok(times.len())
    }
}
