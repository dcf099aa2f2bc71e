//! Failures of a command and their exit codes.

use std::fmt::Display;
use std::io;
use std::io::ErrorKind;
use std::path::Path;
use std::process::ExitCode;

use libration::ensemble::{EnsembleError, InsufficientMemory, MOST_THREADS};
use libration_env::dataset::{DataError, DatasetError};

use crate::{interrupt, terminal};

/// Exit code of a failed run, and of one whose findings disagree.
pub(crate) const FAILED: u8 = 1;
/// Exit code of wrong input.
const USAGE: u8 = 2;
/// Exit code of a run that the user stopped: 128 and the number of SIGINT.
pub(crate) const INTERRUPTED: u8 = 130;

/// Failure of a command, or a result that disagrees.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The command line is wrong, or requests help; clap has the text.
    Arguments(clap::Error),
    /// The input is wrong. Rendered text, perhaps in colour, without a heading.
    Usage(String),
    /// The input is wrong; the text has its own heading and source lines.
    Shown(String),
    /// The run failed.
    Run(String),
    /// The user stopped the run.
    Interrupted(String),
    /// Findings disagree; their messages are already printed.
    Disagreement,
}

impl Failure {
    /// Returns a failure of wrong input.
    pub(crate) fn usage(message: impl Display) -> Self {
        Failure::Usage(message.to_string())
    }

    /// Returns a failed run.
    pub(crate) fn run(message: impl Display) -> Self {
        Failure::Run(message.to_string())
    }

    /// Returns a failure of too little memory: wrong input if this machine can never have it, else a failed run.
    pub(crate) fn out_of_memory(shortage: &InsufficientMemory, message: impl Display) -> Self {
        if shortage.is_beyond_machine() { Failure::usage(message) } else { Failure::run(message) }
    }

    /// Converts an error of an ensemble.
    pub(crate) fn ensemble(error: &EnsembleError) -> Self {
        match error {
            EnsembleError::Memory(shortage) => Failure::out_of_memory(shortage, error),
            EnsembleError::Threads { threads, .. } if *threads <= MOST_THREADS => {
                Failure::run(format!("{error}; help: lower --threads"))
            }
            error => Failure::usage(error),
        }
    }

    /// Prints the failure on stderr and returns the exit code.
    pub(crate) fn report(self) -> ExitCode {
        match self {
            Failure::Arguments(error) => {
                let printed = error.print();
                match printed {
                    // A failed write to stderr has no other place for a message.
                    _ if error.use_stderr() => ExitCode::from(USAGE),
                    Err(error) if error.kind() != ErrorKind::BrokenPipe => {
                        Failure::from(error).report()
                    }
                    _ => ExitCode::SUCCESS,
                }
            }
            Failure::Usage(message) => {
                terminal::error(&message);
                ExitCode::from(USAGE)
            }
            Failure::Shown(text) => {
                terminal::show(&text);
                ExitCode::from(USAGE)
            }
            Failure::Run(message) => {
                terminal::error(&message);
                ExitCode::from(FAILED)
            }
            Failure::Interrupted(message) => {
                terminal::say(&message);
                ExitCode::from(interrupt::exit_code())
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

/// Whether the folder of a data set, its manifest or that of a shard is unusable. That is wrong input, unlike a full disk.
pub(crate) fn is_unusable(error: &DatasetError, folder: &Path) -> bool {
    let DatasetError::Data(DataError::Io { path, source, .. }) = error else { return false };
    let named = path == folder || path.file_name().is_some_and(|name| name == "manifest.jsonl");
    let kinds = [
        ErrorKind::NotFound,
        ErrorKind::PermissionDenied,
        ErrorKind::AlreadyExists,
        ErrorKind::NotADirectory,
        ErrorKind::IsADirectory,
        ErrorKind::ReadOnlyFilesystem,
        ErrorKind::InvalidFilename,
        ErrorKind::FileTooLarge,
        ErrorKind::InvalidInput,
    ];
    named && kinds.contains(&source.kind())
}
