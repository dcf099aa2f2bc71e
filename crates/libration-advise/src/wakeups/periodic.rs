//! A loop that does nothing but wake up.

use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;

use super::WakeupError;
use super::load::Load;

/// What is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// Wake-ups in a second.
    pub rate: f64,
    /// For how many seconds.
    pub seconds: f64,
    /// Whether all cores work meanwhile.
    pub load: bool,
}

/// Who goes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Priority {
    /// As every program runs.
    Ordinary,
    /// In real time, first in, first out, before all ordinary programs.
    Raised,
}

/// When a loop woke up.
#[derive(Clone, Debug, PartialEq)]
pub struct Wakeups {
    /// Between two deadlines, in nanoseconds.
    pub period: u64,
    /// After the first deadline, in nanoseconds; deadline `k` lies `k` periods after it.
    pub times: Vec<u64>,
    /// Whether it was stopped before its time.
    pub stopped: bool,
}

/// Wake-ups of one measurement: eight bytes each.
const MOST: f64 = 5e7;

/// Fewer say nothing.
pub(super) const FEWEST: usize = 16;

impl Plan {
    /// Checks the numbers.
    ///
    /// # Errors
    /// [`WakeupError::Value`]: the first that cannot be.
    pub fn check(&self) -> Result<(), WakeupError> {
        let Plan { rate, seconds, .. } = *self;
        let wrong = |name, value, allowed: String| Err(WakeupError::Value { name, value, allowed });
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

    /// How often it wakes up.
    fn count(&self) -> usize {
        // A product of decimals may be a rounding short of a whole number.
        (self.seconds * self.rate * (1.0 + 4.0 * f64::EPSILON)) as usize
    }

    /// Runs the loop, on a thread of its own.
    ///
    /// All memory is there before it begins, and between wake-ups it does nothing but read the clock. Deadlines lie on a grid: who is
    /// late is not later the next time.
    ///
    /// # Errors
    /// [`WakeupError`], also if `stop` is set before there is anything to tell.
    pub fn measure(&self, priority: Priority, stop: &AtomicBool) -> Result<Wakeups, WakeupError> {
        self.check()?;
        let period = (1e9 / self.rate).round() as u64;
        let count = self.count();
        // Pages that are written once are there.
        let mut times = vec![u64::MAX; count];
        let _load = self.load.then(Load::begin);
        let woken = thread::scope(|scope| {
            let measuring = scope.spawn(|| {
                if priority == Priority::Raised {
                    raise()?;
                }
                timer::wake_up(period, &mut times, stop).map_err(WakeupError::Timer)
            });
            measuring.join().unwrap_or(Err(WakeupError::Interrupted))
        })?;
        times.truncate(woken);
        if woken < FEWEST {
            return Err(WakeupError::Interrupted);
        }
        Ok(Wakeups { period, times, stopped: stop.load(Ordering::Relaxed) })
    }
}

/// Gives the thread that calls it the highest priority that lets the system live.
#[cfg(unix)]
fn raise() -> Result<(), WakeupError> {
    use thread_priority::{
        RealtimeThreadSchedulePolicy, ThreadPriority, ThreadPriorityValue, ThreadSchedulePolicy,
        set_thread_priority_and_policy, thread_native_id,
    };
    // Above interrupts that run as threads at 50, and below what watches over the system at 99.
    let value = ThreadPriorityValue::try_from(80)
        .map_err(|error| WakeupError::NotAllowed(error.to_string()))?;
    set_thread_priority_and_policy(
        thread_native_id(),
        ThreadPriority::Crossplatform(value),
        ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo),
    )
    .map_err(|error| WakeupError::NotAllowed(error.to_string()))
}

#[cfg(not(unix))]
fn raise() -> Result<(), WakeupError> {
    Err(WakeupError::NotAllowed("it is not known how".into()))
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

    /// Wakes up as often as there is room for, and says how often it did.
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
    //! Sleeps up to a deadline, which elsewhere is all that there is.

    use std::sync::atomic::{AtomicBool, Ordering};
    use std::time::{Duration, Instant};
    use std::{io, thread};

    /// Wakes up as often as there is room for, and says how often it did.
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
