//! The processes that a program starts: they end with it.

use std::process::{Child, Command};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The identifiers of the groups that run.
static GROUPS: Mutex<Vec<u32>> = Mutex::new(Vec::new());

fn groups() -> MutexGuard<'static, Vec<u32>> {
    GROUPS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A program and all processes that it starts. They do not get the Ctrl-C of a terminal.
#[derive(Debug)]
pub(crate) struct ProcessGroup {
    /// That of the program.
    id: u32,
}

impl ProcessGroup {
    /// Starts a program in a group of its own.
    ///
    /// # Errors
    /// The program does not start.
    pub(crate) fn start(command: &mut Command) -> std::io::Result<(Child, Self)> {
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(command, 0);
        let mut groups = groups();
        let child = command.spawn()?;
        let id = child.id();
        groups.push(id);
        Ok((child, ProcessGroup { id }))
    }

    /// Ends all processes of the group, once: another process may have the identifier later.
    pub(crate) fn end(&self) {
        let mut groups = groups();
        if let Some(i) = groups.iter().position(|id| *id == self.id) {
            groups.swap_remove(i);
            end(self.id);
        }
    }
}

impl Drop for ProcessGroup {
    fn drop(&mut self) {
        self.end();
    }
}

/// Ends all programs before the end of this process. A thread that starts or ends a program later waits for that end.
pub fn end_programs() {
    let groups = groups();
    groups.iter().for_each(|id| end(*id));
    core::mem::forget(groups);
}

#[cfg(unix)]
fn end(id: u32) {
    use rustix::process::{Pid, Signal, kill_process_group};
    let id = i32::try_from(id).ok().and_then(Pid::from_raw);
    // A group that has ended needs no signal.
    let _ = id.map(|id| kill_process_group(id, Signal::KILL));
}

/// A program is killed alone.
#[cfg(not(unix))]
fn end(_: u32) {}
