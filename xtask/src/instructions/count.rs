//! Instructions, counted by valgrind.

use std::path::{Path, PathBuf};

use super::kernel::Kernel;
use crate::{Outcome, command, workspace};

/// The program that is counted: an example of the engine.
const PROGRAM: &str = "kernels";

/// Trajectories: a multiple of the widths that blocks have with AVX2, so that no lane idles.
const TRAJECTORIES: u64 = 960;

/// Steps of the shorter of two runs; the longer takes twice as many.
const STEPS: u64 = 200;

const VALGRIND: &str = "valgrind";

const MISSING: &str = "valgrind, which counts the instructions, was not found.
On Debian and Ubuntu it is a package: `apt install valgrind`.";

/// Fails where valgrind does not run.
pub(super) fn require_valgrind() -> Outcome {
    let version = command::output(command::program(VALGRIND).arg("--version"));
    version.map(drop).map_err(|_| MISSING.to_owned())
}

/// Compiles the program as it would be shipped.
pub(super) fn build() -> Result<PathBuf, String> {
    command::run(&mut command::cargo(&format!(
        "build --release --package libration --example {PROGRAM}"
    )))?;
    Ok(workspace::built(&format!("release/examples/{PROGRAM}")))
}

/// Instructions per trajectory and step: the difference of two runs, in which all that is done once
/// cancels.
pub(super) fn per_step(program: &Path, kernel: &Kernel) -> Result<f64, String> {
    let short = instructions(program, kernel, STEPS)?;
    let long = instructions(program, kernel, 2 * STEPS)?;
    Ok(long.saturating_sub(short) as f64 / (TRAJECTORIES * STEPS) as f64)
}

/// Instructions of a whole run. Valgrind knows AVX2, but not AVX-512.
fn instructions(program: &Path, kernel: &Kernel, steps: u64) -> Result<u64, String> {
    let mut count = command::program(VALGRIND);
    // Nothing is asked of the caches.
    count.args(["--tool=cachegrind", "--cache-sim=no", "--cachegrind-out-file=/dev/null"]);
    count.arg(program).args([kernel.system, kernel.method, kernel.float, "avx2"]);
    count.args([TRAJECTORIES, steps].map(|number| number.to_string()));
    let output = count.output().map_err(|error| format!("{VALGRIND} did not start: {error}"))?;
    let report = String::from_utf8_lossy(&output.stderr);
    if !output.status.success() {
        return Err(format!("{kernel} under valgrind failed ({})\n{report}", output.status));
    }
    total(&report).ok_or_else(|| format!("valgrind says nothing of instructions:\n{report}"))
}

/// The number in the line `==1234== I   refs:      231,482` of cachegrind's report.
fn total(report: &str) -> Option<u64> {
    let line = report.lines().find_map(|line| {
        let (name, number) = line.split_once("refs:")?;
        name.split_whitespace().next_back().filter(|&name| name == "I").map(|_| number)
    })?;
    line.trim().replace(',', "").parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_total_is_that_of_instructions() {
        let report = "==7== Cachegrind, a cache and branch-prediction profiler\n\
                      ==7== \n==7== I   refs:      1,231,482\n==7== D   refs:      9\n";
        assert_eq!(total(report), Some(1_231_482));
        assert_eq!(total("==7== I refs:        12"), Some(12));
        assert_eq!(total("==7== nothing"), None);
        assert_eq!(total("==7== D   refs:      9"), None);
    }
}
