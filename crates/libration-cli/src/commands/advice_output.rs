//! Output of advice.

use libration_advise::{AdviseError, Doubt};
use libration_report::verdict::{self, Verdict};
use libration_work::Work;
use serde::Serialize;

use super::log_warnings;
use super::result_file::ResultFile;
use super::time_stamps::RecordNotes;
use crate::args::AdviseArgs;
use crate::error::Failure;
use crate::progress::Reporter;
use crate::{interrupt, terminal};

/// Forms of a kind of advice.
pub(super) struct AdviceOutput<A> {
    /// The whole text.
    pub(super) describe: fn(&A) -> String,
    /// A screen of it.
    pub(super) summarise: fn(&A, &AdviseArgs) -> String,
    pub(super) page: fn(&A) -> String,
    pub(super) verdict: fn(&A) -> &Verdict,
    pub(super) warnings: fn(&mut A) -> &mut Vec<String>,
    /// Makes the verdict unknown.
    pub(super) doubt: fn(&mut A, Doubt),
}

impl<A: Serialize> AdviceOutput<A> {
    /// Prints the warnings about the log, computes advice, prints it as text or JSON, and writes its page if the options ask for one.
    pub(super) fn deliver(
        &self,
        args: &AdviseArgs,
        quiet: bool,
        notes: RecordNotes,
        compute: impl FnOnce(&Work<'_>) -> Result<A, AdviseError>,
    ) -> Result<(), Failure> {
        let file = ResultFile::create("--page", args.page.as_deref())?;
        let (doubt, warning) = notes.doubt.unzip();
        let log_warnings: Vec<String> = notes.warnings.into_iter().chain(warning).collect();
        let log = args.jitter_file.as_deref();
        let log_warnings =
            log.map_or_else(Vec::new, |path| log_warnings::warn(path, &log_warnings));
        let reporter = Reporter::new(quiet);
        let advice = interrupt::compute(|stop| compute(&Work::new(&reporter, stop)));
        reporter.clear();
        if let (Err(_), Some(page)) = (&advice, &args.page) {
            terminal::warn(&format!("`{}` (--page) is not written", page.display()));
        }
        let mut advice = advice.map_err(failure)?;
        if let Some(doubt) = doubt {
            (self.doubt)(&mut advice, doubt);
        }
        // The text leaves out what is on stderr.
        let text = match args.verbose {
            true => (self.describe)(&advice),
            false => (self.summarise)(&advice, args),
        };
        (self.warnings)(&mut advice).splice(0..0, log_warnings);
        let text = match args.json {
            true => serde_json::to_string_pretty(&advice).map_err(Failure::run)? + "\n",
            false => text,
        };
        terminal::print(&text)?;
        file.write(|| (self.page)(&advice))?;
        match verdict::exit_code([(self.verdict)(&advice)]) {
            verdict::GOOD => Ok(()),
            _ => Err(Failure::Disagreement),
        }
    }
}

/// The failure of an error of advice.
pub(super) fn failure(error: AdviseError) -> Failure {
    match error {
        AdviseError::Interrupted(error) => Failure::Interrupted(error.to_string()),
        AdviseError::Value { name, value, allowed } => {
            let flag = match name.rsplit('.').next().unwrap_or(name) {
                "cost" => "cost-weights",
                flag => flag,
            };
            Failure::usage(format!("--{flag} is {value:?}; expected {allowed}"))
        }
        error @ (AdviseError::Unstable { .. }
        | AdviseError::LatencyTooLong(_)
        | AdviseError::Ensemble(_)) => Failure::run(error),
        error => Failure::usage(error),
    }
}
