//! Programs that a task runs: in the workspace's folder, without standard input.

use std::ffi::OsStr;
use std::fs::{self, File};
use std::io;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use crate::scratch::Scratch;
use crate::{Outcome, processor_time, workspace};

/// Time after which a program that still runs hangs: the slowest takes a fourth of it on a slow machine.
pub(crate) const LONGEST: Duration = Duration::from_secs(30 * 60);

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

/// Runs `command` to its end, and keeps all that it says until then. Whatever takes longer than `longest` is killed.
pub(crate) fn kept(command: &mut Command, longest: Duration) -> Ended {
    ended(command, longest).unwrap_or_else(|error| Ended {
        outcome: Err(not_started(command, &error)),
        said: String::new(),
        processor: Duration::ZERO,
    })
}

fn ended(command: &mut Command, longest: Duration) -> io::Result<Ended> {
    // No pipe: what a killed program has started would keep it open.
    let folder =
        Scratch::new(&format!("said-{:?}", thread::current().id())).map_err(io::Error::other)?;
    let path = folder.path().join("said");
    let file = File::create(&path)?;
    let mut child = command.stdout(file.try_clone()?).stderr(file).spawn()?;
    let processor = processor_time::at_the_end_of(&child, Instant::now() + longest);
    if processor.is_none() {
        child.kill()?;
    }
    let status = child.wait()?;
    let outcome = match processor {
        None => Err(format!("`{}` hung and was killed after {longest:?}", shown(command))),
        Some(_) if status.success() => Ok(()),
        Some(_) => Err(format!("`{}` failed ({status})", shown(command))),
    };
    let said = String::from_utf8_lossy(&fs::read(path)?).into_owned();
    Ok(Ended { outcome, said, processor: processor.unwrap_or_default() })
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

fn not_started(command: &Command, error: &io::Error) -> String {
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
    use std::time::{Duration, Instant};

    use super::{LONGEST, cargo, kept, program, run, silent};

    #[test]
    fn a_command_that_succeeds_with_words_is_not_silent() {
        assert!(run(&mut cargo("--version")).is_ok());
        assert!(silent(&mut cargo("--version")).is_err());
    }

    #[test]
    fn what_both_streams_say_is_kept() {
        let ended = kept(&mut cargo("--version"), LONGEST);
        assert!(ended.said.starts_with("cargo "), "{}", ended.said);
        let ended = kept(&mut cargo("--wrong"), LONGEST);
        assert!(ended.said.contains("--wrong") && ended.outcome.is_err(), "{}", ended.said);
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn a_program_that_hangs_is_killed_and_named_with_what_it_said() {
        // The second one outlives it, and holds its streams.
        let mut hanging = program("sh");
        hanging.args(["-c", "echo started; sleep 5 & wait"]);
        let start = Instant::now();
        let ended = kept(&mut hanging, Duration::from_millis(100));
        assert!(start.elapsed() < Duration::from_secs(4));
        assert!(ended.outcome.unwrap_err().contains("hung and was killed after 100ms"));
        assert_eq!(ended.said, "started\n");
    }
}
