//! Progress of a run, on stderr.

use std::fmt::Write;
use std::io::{IsTerminal, stderr};
use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use indicatif::{HumanDuration, ProgressBar, ProgressState, ProgressStyle};
use libration_report::printable::printable;
use libration_study::Progress;

use crate::terminal;

/// Output of progress.
#[derive(Debug)]
pub(crate) enum Reporter {
    /// Bars on a terminal.
    Bars(Bars),
    /// One line for each study.
    Lines,
    /// Nothing.
    Quiet,
}

/// The bars of unfinished work; the last one moves.
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
        match (quiet, has_bars()) {
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
            Reporter::Bars(bars) => bars.lock().study = format!("{name} {number}/{of}"),
            Reporter::Lines => terminal::say(&format!("study {number} of {of}: {name}")),
            Reporter::Quiet => {}
        }
    }

    fn begin(&self, what: &str, total: usize) {
        if let Reporter::Bars(bars) = self {
            let mut state = bars.lock();
            let bar = ProgressBar::new(total as u64)
                .with_prefix(state.study.clone())
                .with_message(what.to_owned())
                .with_style(style());
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
        // The bars of a study that panicked are still valid.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Whether stderr is a terminal on which a bar can move.
pub(crate) fn has_bars() -> bool {
    let dumb = std::env::var_os("TERM").is_some_and(|term| term == "dumb");
    stderr().is_terminal() && !dumb
}

/// Returns a bar of `total` steps with the time left.
pub(crate) fn steps(total: u64) -> ProgressBar {
    let template = "{bar:20} {percent} %  {human_pos} of {human_len} steps  {left}";
    let style = ProgressStyle::with_template(template);
    let style = style.unwrap_or_else(|_| ProgressStyle::default_bar());
    let style = style.with_key("left", time_left).progress_chars("━╸─");
    let bar = ProgressBar::new(total).with_style(style);
    bar.enable_steady_tick(Duration::from_millis(200));
    bar
}

/// A spinner with a message and the time, for work of unknown length; none if stderr is no terminal.
pub(crate) fn spinner() -> Option<ProgressBar> {
    let style = ProgressStyle::with_template("{spinner} {msg} in {elapsed}");
    let style = style.unwrap_or_else(|_| ProgressStyle::default_spinner());
    has_bars().then(|| {
        let bar = ProgressBar::new_spinner().with_style(style);
        bar.enable_steady_tick(Duration::from_millis(200));
        bar
    })
}

/// Reads a file, with a spinner on a terminal.
pub(crate) fn reading<R>(quiet: bool, file: &Path, read: impl FnOnce() -> R) -> R {
    let bar = (!quiet).then(spinner).flatten();
    if let Some(bar) = &bar {
        bar.set_message(format!("reading {}", printable(&file.to_string_lossy())));
    }
    let result = read();
    if let Some(bar) = bar {
        bar.finish_and_clear();
    }
    result
}

/// Returns the style: study, bar, time left and current work, cut at the width of the terminal.
fn style() -> ProgressStyle {
    let template = "{prefix}  {bar:20} {pos}/{len}  {left}  {wide_msg}";
    let style = ProgressStyle::with_template(template);
    style
        .unwrap_or_else(|_| ProgressStyle::default_bar())
        .with_key("left", time_left)
        .progress_chars("━╸─")
}

/// Writes an estimate of the time left, once there is progress.
fn time_left(state: &ProgressState, out: &mut dyn Write) {
    // An error here would only leave the estimate out.
    let _ = match state.pos() {
        0 => write!(out, "estimating"),
        _ => write!(out, "{:#} left", HumanDuration(state.eta())),
    };
}
