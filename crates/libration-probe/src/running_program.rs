//! A program that runs, with its input, its output and its messages.

use std::ffi::OsString;
use std::io::BufReader;
use std::process::{Child, ChildStdin, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, channel, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

use crate::BlackBoxError;
use crate::child_streams::{read_line, show_messages};
use crate::process_group::ProcessGroup;

/// The time in which messages must have arrived after the end of a program, whose own children may hold the pipe.
const LAST_MESSAGES: Duration = Duration::from_millis(200);
/// The time in which a program that closes its output or input must have ended, to be reported with its status.
const LAST_STATUS: Duration = Duration::from_millis(200);
/// Lines that wait to be read.
const MOST_LINES: usize = 4;

/// Environment variables of a program that differ from those of this process; without a value, it does not have them.
pub type Environment = Vec<(&'static str, Option<OsString>)>;

/// A program that was started, with what it reads and writes. Its end comes with this value.
#[derive(Debug)]
pub(crate) struct RunningProgram {
    child: Child,
    group: ProcessGroup,
    pub(crate) input: Option<ChildStdin>,
    pub(crate) lines: Receiver<Result<String, String>>,
    /// Disconnected when all messages are shown.
    messages: Receiver<()>,
}

impl Drop for RunningProgram {
    fn drop(&mut self) {
        // A program that reads to the end of its input ends now; any other is killed.
        drop(self.input.take());
        // Before its identifier is free for another group.
        self.group.end();
        let _ = self.child.kill();
        let _ = self.child.wait();
        let _ = self.messages.recv_timeout(LAST_MESSAGES);
    }
}

impl RunningProgram {
    /// Starts a program whose first word is its name.
    pub(crate) fn start(
        words: &[String],
        environment: &Environment,
    ) -> Result<Self, BlackBoxError> {
        let failed = |why: &dyn core::fmt::Display| {
            let program = words.first().map_or("", String::as_str);
            BlackBoxError::Failed(format!("cannot start `{program}`: {why}"))
        };
        let (program, arguments) = words.split_first().ok_or_else(|| failed(&"no program"))?;
        let mut command = Command::new(program);
        command.args(arguments).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        for (name, value) in environment {
            match value {
                Some(value) => command.env(name, value),
                None => command.env_remove(name),
            };
        }
        let (mut child, group) =
            ProcessGroup::start(&mut command).map_err(|error| failed(&error))?;
        let (input, output) = (child.stdin.take(), child.stdout.take());
        let output = output.ok_or_else(|| failed(&"it has no standard output"))?;
        let (send, lines) = sync_channel(MOST_LINES);
        thread::Builder::new()
            .spawn(move || {
                let mut output = BufReader::new(output);
                loop {
                    let line = read_line(&mut output);
                    let is_last = line.is_err();
                    // Nobody listens after the end of an audit.
                    if send.send(line).is_err() || is_last {
                        return;
                    }
                }
            })
            .map_err(|error| failed(&error))?;
        let (done, messages) = channel();
        let errors = child.stderr.take();
        thread::Builder::new()
            .spawn(move || {
                let _open = done;
                errors.map(show_messages)
            })
            .map_err(|error| failed(&error))?;
        Ok(RunningProgram { child, group, input, lines, messages })
    }

    /// The status of a program that ends now or in a moment; none if it still runs.
    pub(crate) fn last_status(&mut self) -> Option<ExitStatus> {
        let end = Instant::now() + LAST_STATUS;
        loop {
            if let Some(status) = self.child.try_wait().ok().flatten() {
                self.group.end();
                return Some(status);
            }
            if Instant::now() >= end {
                return None;
            }
            thread::sleep(Duration::from_millis(2));
        }
    }
}
