//! How far the work is, told on stderr.

use std::io::{IsTerminal, stderr};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
use libration_lab::Progress;

use crate::terminal;

/// What is told, and where to.
#[derive(Debug)]
pub(crate) enum Reporter {
    /// Bars on a terminal.
    Bars(Bars),
    /// One line for each study.
    Lines,
    /// Nothing.
    Quiet,
}

/// The bars of what has begun and not ended; the last one moves.
#[derive(Debug, Default)]
pub(crate) struct Bars {
    state: Mutex<State>,
}

#[derive(Debug, Default)]
struct State {
    study: String,
    bars: Vec<ProgressBar>,
}

impl Reporter {
    /// Bars if stderr is a terminal, lines if it is not, nothing if `quiet`.
    pub(crate) fn new(quiet: bool) -> Self {
        let dumb = std::env::var_os("TERM").is_some_and(|term| term == "dumb");
        match (quiet, stderr().is_terminal() && !dumb) {
            (true, _) => Reporter::Quiet,
            (false, true) => Reporter::Bars(Bars::default()),
            (false, false) => Reporter::Lines,
        }
    }

    /// Takes the bars off the terminal, as before an error message.
    pub(crate) fn clear(&self) {
        if let Reporter::Bars(bars) = self {
            bars.lock().bars.drain(..).for_each(|bar| bar.finish_and_clear());
        }
    }
}

impl Progress for Reporter {
    fn study(&self, name: &str, number: usize, of: usize) {
        match self {
            Reporter::Bars(bars) => bars.lock().study = format!("{name} ({number} of {of})"),
            Reporter::Lines => terminal::say(&format!("study {number} of {of}: {name}")),
            Reporter::Quiet => {}
        }
    }

    fn begin(&self, what: &str, total: usize) {
        if let Reporter::Bars(bars) = self {
            let mut state = bars.lock();
            let bar = ProgressBar::new(total as u64).with_style(style());
            bar.set_prefix(state.study.clone());
            bar.set_message(what.to_owned());
            bar.enable_steady_tick(Duration::from_millis(200));
            state.bars.push(bar);
        }
    }

    fn advance(&self) {
        if let Reporter::Bars(bars) = self
            && let Some(bar) = bars.lock().bars.last()
        {
            bar.inc(1);
        }
    }

    fn end(&self) {
        if let Reporter::Bars(bars) = self
            && let Some(bar) = bars.lock().bars.pop()
        {
            bar.finish_and_clear();
        }
    }
}

impl Bars {
    fn lock(&self) -> MutexGuard<'_, State> {
        // A study that panicked leaves bars behind that are still whole.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Name of the study, what it does, a bar, time left. Bars have no colour.
fn style() -> ProgressStyle {
    let template = "{prefix}  {msg}  {wide_bar} {pos}/{len}  {eta} left";
    let style = ProgressStyle::with_template(template);
    style.unwrap_or_else(|_| ProgressStyle::default_bar()).progress_chars("━╸─")
}
