//! What can end a run, and the exit code of each.

use std::fmt::Display;
use std::io;
use std::process::ExitCode;

use crate::terminal;

/// Exit code of a failed run, and of one whose findings disagree.
const FAILED: u8 = 1;
/// Exit code of wrong input.
const USAGE: u8 = 2;
/// Exit code of a run that the user stopped: 128 and the number of SIGINT.
pub(crate) const INTERRUPTED: u8 = 130;

/// Why the command ends before its natural end, or after it with a bad result.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The command line is wrong, or asks for help; clap words it.
    Arguments(clap::Error),
    /// The input is wrong. Rendered text, perhaps in colour, without a heading.
    Usage(String),
    /// The input is wrong; the text has its own heading and source lines.
    Shown(String),
    /// The run failed.
    Run(String),
    /// The user stopped the run.
    Interrupted(String),
    /// Findings disagree; they have been named already.
    Disagreement,
}

impl Failure {
    /// Wrong input.
    pub(crate) fn usage(message: impl Display) -> Self {
        Failure::Usage(message.to_string())
    }

    /// A failed run.
    pub(crate) fn run(message: impl Display) -> Self {
        Failure::Run(message.to_string())
    }

    /// Says on stderr what happened; gives the exit code.
    pub(crate) fn report(self) -> ExitCode {
        match self {
            Failure::Arguments(error) => {
                // Nobody is left to tell if this cannot be written.
                let _ = error.print();
                if error.use_stderr() { ExitCode::from(USAGE) } else { ExitCode::SUCCESS }
            }
            Failure::Usage(message) => {
                terminal::error(&message);
                ExitCode::from(USAGE)
            }
            Failure::Shown(text) => {
                terminal::say(&text);
                ExitCode::from(USAGE)
            }
            Failure::Run(message) => {
                terminal::error(&message);
                ExitCode::from(FAILED)
            }
            Failure::Interrupted(message) => {
                terminal::say(&message);
                ExitCode::from(INTERRUPTED)
            }
            Failure::Disagreement => ExitCode::from(FAILED),
        }
    }
}

impl From<clap::Error> for Failure {
    fn from(error: clap::Error) -> Self {
        Failure::Arguments(error)
    }
}

/// An error of writing results to stdout.
impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        Failure::Run(format!("cannot write to standard output: {error}"))
    }
}
