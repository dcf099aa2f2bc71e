//! `cargo xtask torture`: processes that write are killed, fifty times each.

use crate::{Outcome, command};

/// Kills of each kind; the tests by themselves do with a few.
const KILLS: &str = "50";

/// Runs the tests that kill, with many kills.
pub(crate) fn run() -> Outcome {
    for tests in [
        "test --package libration-data --test data kills::",
        "test --package libration-cli --test cli kills::",
    ] {
        command::run(command::cargo(tests).env("LIBRATION_KILLS", KILLS))?;
    }
    Ok(())
}
