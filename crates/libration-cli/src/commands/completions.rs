//! `libration completions`.

use clap::CommandFactory;

use crate::args::{Arguments, CompletionsArgs};
use crate::error::Failure;
use crate::terminal;

/// Prints the completion script of a shell.
pub(crate) fn run(args: &CompletionsArgs) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Arguments::command(), "libration", &mut script);
    terminal::print(&String::from_utf8_lossy(&script))?;
    Ok(())
}
