//! A simulator under audit, with its progress and a limit of time.

use std::time::{Duration, Instant};

use indicatif::ProgressBar;
use libration::linear::Matrix;
use libration_probe::{BlackBox, BlackBoxError};

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
    pub(super) fn new(black_box: Box<dyn BlackBox>, limit: Duration, quiet: bool) -> Self {
        let bar = (!quiet).then(progress::spinner).flatten();
        let start = Instant::now();
        let next_line = (!quiet && bar.is_none()).then(|| start + PAUSE);
        Watched { black_box, start, limit, steps: 0, bar, next_line }
    }

    fn tell(&mut self) {
        if let Some(bar) = &self.bar {
            bar.set_message(format!("{} steps", self.steps));
        }
        if self.next_line.is_some_and(|due| Instant::now() >= due) {
            self.next_line = Some(Instant::now() + PAUSE);
            let seconds = self.start.elapsed().as_secs_f64();
            terminal::say(&format!("{} steps in {seconds:.0} s", self.steps));
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
            return Err(BlackBoxError::Failed(format!(
                "the audit was ended after {} s and {} steps (--time-limit); expected a faster step, or a longer limit",
                self.limit.as_secs_f64(),
                self.steps
            )));
        }
        self.steps += states.rows() as u64;
        self.tell();
        self.black_box.step(states, actions, dt)
    }

    fn is_batched(&self) -> bool {
        self.black_box.is_batched()
    }

    fn observe(&mut self, states: &Matrix) -> Result<Option<Matrix>, BlackBoxError> {
        self.black_box.observe(states)
    }

    fn energies(&mut self, states: &Matrix) -> Result<Option<Vec<f64>>, BlackBoxError> {
        self.black_box.energies(states)
    }

    fn restart(&mut self) -> Result<bool, BlackBoxError> {
        self.black_box.restart()
    }
}
