//! What can end a run, and the exit code of each.

use std::fmt::Display;
use std::io;
use std::io::ErrorKind;
use std::path::Path;
use std::process::ExitCode;

use libration::ensemble::{EnsembleError, InsufficientMemory, MOST_THREADS};
use libration_env::dataset::{DataError, DatasetError};

use crate::terminal;

/// Exit code of a failed run, and of one whose findings disagree.
pub(crate) const FAILED: u8 = 1;
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

    /// Not enough memory: wrong input if this machine could never have it, a failed run otherwise.
    pub(crate) fn room(room: &InsufficientMemory, message: impl Display) -> Self {
        if room.is_beyond_machine() { Failure::usage(message) } else { Failure::run(message) }
    }

    /// An ensemble cannot be made: the system refuses, or the input is wrong.
    pub(crate) fn ensemble(error: &EnsembleError) -> Self {
        match error {
            EnsembleError::Memory(room) => Failure::room(room, error),
            EnsembleError::Threads { threads, .. } if *threads <= MOST_THREADS => {
                Failure::run(format!("{error}; lower --threads"))
            }
            error => Failure::usage(error),
        }
    }

    /// Says on stderr what happened; gives the exit code.
    pub(crate) fn report(self) -> ExitCode {
        match self {
            Failure::Arguments(error) => {
                let printed = error.print();
                match printed {
                    // If this cannot be written, nobody is left to tell.
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

/// Whether an error says that the folder that was given, or its manifest, cannot be used: wrong input, unlike a disk that is full.
pub(crate) fn is_unusable(error: &DatasetError, folder: &Path) -> bool {
    let DatasetError::Data(DataError::Io { path, source, .. }) = error else { return false };
    let named = path == folder || *path == folder.join("manifest.jsonl");
    let kinds = [
        ErrorKind::NotFound,
        ErrorKind::PermissionDenied,
        ErrorKind::AlreadyExists,
        ErrorKind::NotADirectory,
        ErrorKind::IsADirectory,
        ErrorKind::ReadOnlyFilesystem,
        ErrorKind::InvalidFilename,
        ErrorKind::FileTooLarge,
    ];
    named && kinds.contains(&source.kind())
}
