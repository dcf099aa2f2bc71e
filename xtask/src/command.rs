//! Programs that a task runs: in the workspace's folder, without standard input.

use std::ffi::OsStr;
use std::io::Read;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread;
use std::time::Duration;

use crate::{Outcome, processor_time, workspace};

/// A command in the workspace's folder that never waits for a keyboard.
pub(crate) fn program(path: impl AsRef<OsStr>) -> Command {
    let mut command = Command::new(path);
    command.current_dir(workspace::root()).stdin(Stdio::null());
    // The first process that imports a module compiles it for all others.
    command.env_remove("PYTHONDONTWRITEBYTECODE");
    command
}

/// The cargo that started this program, with `arguments` separated by blanks.
pub(crate) fn cargo(arguments: &str) -> Command {
    let mut command = program(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.args(arguments.split_whitespace());
    command
}

/// Runs `command` to its end; anything but success is an error.
pub(crate) fn run(command: &mut Command) -> Outcome {
    let status = command.status().map_err(|error| not_started(command, &error))?;
    if status.success() { Ok(()) } else { Err(format!("`{}` failed ({status})", shown(command))) }
}

/// Runs `command` to its end; anything but success without a word is an error.
pub(crate) fn silent(command: &mut Command) -> Outcome {
    let output = command.output().map_err(|error| not_started(command, &error))?;
    let said = [output.stdout, output.stderr].concat();
    if output.status.success() && said.is_empty() {
        return Ok(());
    }
    let said = String::from_utf8_lossy(&said);
    Err(format!("`{}` ended with {} and said {said:?}", shown(command), output.status))
}

/// Result of a program, what it said, and its processor time.
pub(crate) struct Ended {
    pub(crate) outcome: Outcome,
    pub(crate) said: String,
    pub(crate) processor: Duration,
}

/// Runs `command` to its end, and keeps all that it says until then.
pub(crate) fn kept(command: &mut Command) -> Ended {
    let nothing = |error: std::io::Error, command: &Command| Ended {
        outcome: Err(not_started(command, &error)),
        said: String::new(),
        processor: Duration::ZERO,
    };
    let mut child = match command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn() {
        Ok(child) => child,
        Err(error) => return nothing(error, command),
    };
    let (out, err) = (child.stdout.take(), child.stderr.take());
    let said = thread::scope(|scope| {
        let out = scope.spawn(|| all_of(out));
        let err = all_of(err);
        [out.join().unwrap_or_default(), err].concat()
    });
    let processor = processor_time::at_the_end_of(&child);
    let status = match child.wait() {
        Ok(status) => status,
        Err(error) => return nothing(error, command),
    };
    let failed = || Err(format!("`{}` failed ({status})", shown(command)));
    Ended {
        outcome: if status.success() { Ok(()) } else { failed() },
        said: String::from_utf8_lossy(&said).into_owned(),
        processor,
    }
}

/// What a stream says to its end, or until it cannot be read.
fn all_of(stream: Option<impl Read>) -> Vec<u8> {
    let mut said = Vec::new();
    if let Some(mut stream) = stream {
        let _ = stream.read_to_end(&mut said);
    }
    said
}

/// Returns the standard output of `command`.
pub(crate) fn output(command: &mut Command) -> Result<String, String> {
    let output = command.output().map_err(|error| not_started(command, &error))?;
    if !output.status.success() {
        let complaint = String::from_utf8_lossy(&output.stderr);
        return Err(format!("`{}` failed ({})\n{complaint}", shown(command), output.status));
    }
    String::from_utf8(output.stdout)
        .map_err(|_| format!("`{}` printed something that is not UTF-8", shown(command)))
}

fn not_started(command: &Command, error: &std::io::Error) -> String {
    format!("`{}` could not be started: {error}", shown(command))
}

/// The command as one would type it, without the folder of the program.
fn shown(command: &Command) -> String {
    let path = Path::new(command.get_program());
    let name = path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy();
    command
        .get_args()
        .fold(name.into_owned(), |line, argument| format!("{line} {}", argument.to_string_lossy()))
}

#[cfg(test)]
mod tests {
    use super::{cargo, run, silent};

    #[test]
    fn a_command_that_succeeds_with_words_is_not_silent() {
        assert!(run(&mut cargo("--version")).is_ok());
        assert!(silent(&mut cargo("--version")).is_err());
    }
}
