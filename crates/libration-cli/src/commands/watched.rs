//! A simulator under audit, with its progress and a limit of time.

use std::time::{Duration, Instant};

use indicatif::ProgressBar;
use libration::linear::Matrix;
use libration_probe::{BlackBox, BlackBoxError};
use libration_report::notation::plural;

use crate::progress;
use crate::terminal;

/// Time between lines of progress.
const PAUSE: Duration = Duration::from_secs(10);

/// A black box whose calls are counted and end with a limit of time.
pub(super) struct Watched {
    black_box: Box<dyn BlackBox>,
    start: Instant,
    limit: Duration,
    steps: u64,
    bar: Option<ProgressBar>,
    /// When the next line is due; none without lines.
    next_line: Option<Instant>,
}

impl Watched {
    /// A black box of an audit that began at `start`.
    pub(super) fn new(
        black_box: Box<dyn BlackBox>,
        start: Instant,
        limit: Duration,
        quiet: bool,
    ) -> Self {
        let bar = (!quiet).then(progress::spinner).flatten();
        let next_line = (!quiet && bar.is_none()).then(|| Instant::now() + PAUSE);
        Watched { black_box, start, limit, steps: 0, bar, next_line }
    }

    fn tell(&mut self) {
        if let Some(bar) = &self.bar {
            bar.set_message(self.steps());
        }
        if self.next_line.is_some_and(|due| Instant::now() >= due) {
            self.next_line = Some(Instant::now() + PAUSE);
            let seconds = self.start.elapsed().as_secs_f64();
            terminal::say(&format!("{} in {seconds:.0} s", self.steps()));
        }
    }

    fn steps(&self) -> String {
        plural(usize::try_from(self.steps).unwrap_or(usize::MAX), "step")
    }

    /// The error of an audit that its limit of time ends.
    fn ended(&self, why: &str) -> BlackBoxError {
        BlackBoxError::Failed(format!(
            "the audit was ended after {} s and {} (--time-limit){why}; expected a faster step, or a longer limit",
            self.limit.as_secs_f64(),
            self.steps()
        ))
    }

    /// An error of the simulator; a limit of time by its option.
    fn named(&self, error: BlackBoxError) -> BlackBoxError {
        match error {
            BlackBoxError::TimeLimit { program } => {
                self.ended(&format!(": `{program}` gave no answer to the next one"))
            }
            error => error,
        }
    }
}

impl Drop for Watched {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

impl BlackBox for Watched {
    fn step(
        &mut self,
        states: &Matrix,
        actions: &Matrix,
        dt: f64,
    ) -> Result<Matrix, BlackBoxError> {
        if self.start.elapsed() > self.limit {
            return Err(self.ended(""));
        }
        self.tell();
        let next = self.black_box.step(states, actions, dt).map_err(|error| self.named(error))?;
        self.steps += states.rows() as u64;
        Ok(next)
    }

    fn is_batched(&self) -> bool {
        self.black_box.is_batched()
    }

    fn observe(&mut self, states: &Matrix) -> Result<Option<Matrix>, BlackBoxError> {
        self.black_box.observe(states)
    }

    fn energies(&mut self, states: &Matrix) -> Result<Option<Vec<f64>>, BlackBoxError> {
        self.black_box.energies(states).map_err(|error| self.named(error))
    }

    fn restart(&mut self) -> Result<bool, BlackBoxError> {
        self.black_box.restart().map_err(|error| self.named(error))
    }
}
