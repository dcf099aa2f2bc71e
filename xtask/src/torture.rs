//! `cargo xtask torture`: processes that write are killed, fifty times each, and logs are damaged, a million times each.

use crate::{Outcome, command};

/// Kills of each kind; the tests by themselves do with a few.
const KILLS: &str = "50";

/// Mutations of each sample of a log, more than 10⁷ in total; the tests by themselves do with a few hundred.
const MUTATIONS: &str = "200000";

/// Runs the tests that kill, with many kills, and those that damage logs, with many mutations.
pub(crate) fn run() -> Outcome {
    for tests in [
        "test --package libration-data --test data kills::",
        "test --package libration-cli --test cli kills::",
    ] {
        command::run(command::cargo(tests).env("LIBRATION_KILLS", KILLS))?;
    }
    let logs = "test --release --package libration-logs --test logs mutations::";
    command::run(command::cargo(logs).env("LIBRATION_MUTATIONS", MUTATIONS))
}
