//! `libration rollout`, `libration join` and `libration verify`.

use std::path::Path;

use libration::ensemble::Execution;
use libration_env::dataset;
use libration_env::dataset::{
    Dataset, DatasetError, EquationSource, JoinJob, Transfer, VerifyOptions, WriteJob,
};
use libration_lab::ReportCheck;
use libration_report::printable::printable;
use libration_report::verdict::{Outcome, Verdict};
use libration_settings::ConfigCommand;

use super::dataset_progress::{Watcher, failed, shown};
use super::repeat_command::with_flag;
use super::{config_file, verify_report};
use crate::args::{JoinArgs, RolloutArgs, VerifyArgs};
use crate::error::Failure;
use crate::terminal;

/// Writes a data set, or resumes one.
pub(crate) fn run(args: &RolloutArgs, quiet: bool) -> Result<(), Failure> {
    if args.print_config {
        return Ok(terminal::print(dataset::DEFAULT)?);
    }
    let Some(out) = &args.out else {
        return Err(Failure::usage("--out is missing; expected a folder"));
    };
    let parse = |text: &str, name: &str| match &args.system {
        Some(system) => dataset::parse_of(EquationSource::File(system), &args.set, text, name),
        None => dataset::parse(text, name),
    };
    let dataset = match &args.config {
        Some(path) => config_file::read(path, |text, name| {
            parse(text, name).inspect(|_| {
                config_file::note_ignored_keys(text, ConfigCommand::ROLLOUT, quiet);
            })
        })?,
        None if args.system.is_none() => Dataset::default(),
        None => parse("", "defaults").map_err(|error| Failure::usage(error.message()))?,
    };
    let dataset = match args.transitions {
        Some(count) => dataset.transitions(count).map_err(|error| {
            Failure::usage(format!("{count} transitions (--transitions): {error}"))
        })?,
        None => dataset,
    };
    for caveat in dataset.caveats().iter().filter(|_| !quiet) {
        terminal::say(&format!("note: {caveat}"));
    }
    let job = WriteJob {
        dataset: &dataset,
        format: args.format,
        shard: args.shard,
        out,
        resume: args.resume,
        execution: threads(args.threads)?,
    };
    let watcher = Watcher::new(quiet, out, dataset.share(args.shard));
    let written = dataset::write(&job, &watcher);
    finish(quiet, written.map(|manifest| manifest.chunks.len()), &watcher, out)
}

/// Joins the shards of a data set.
pub(crate) fn join(args: &JoinArgs, quiet: bool) -> Result<(), Failure> {
    let transfer = if args.link { Transfer::Link } else { Transfer::Copy };
    let job = JoinJob { parts: &args.parts, out: &args.out, transfer, resume: args.resume };
    let watcher = Watcher::new(quiet, &args.out, 0);
    let joined = dataset::join(&job, &watcher);
    finish(quiet, joined.map(|manifest| manifest.chunks.len()), &watcher, &args.out)
}

/// Says how much of a data set is in its folder; `chunks` is the number of chunks.
fn finish(
    quiet: bool,
    chunks: Result<usize, DatasetError>,
    watcher: &Watcher,
    out: &Path,
) -> Result<(), Failure> {
    watcher.clear();
    let (count, bytes) = watcher.totals();
    let chunks = chunks.map_err(|error| match error {
        DatasetError::Interrupted => Failure::Interrupted(format!(
            "interrupted; `{}` holds {count} transitions; help: continue with `{}`",
            out.display(),
            with_flag("--resume"),
        )),
        error => failed(error, out),
    })?;
    if !quiet {
        terminal::print(&format!(
            "{count} transitions in {chunks} {}, {:.3} GB, after {:.1} s of this run: {}\n",
            if chunks == 1 { "chunk" } else { "chunks" },
            bytes as f64 / 1e9,
            watcher.seconds(),
            out.display()
        ))?;
    }
    Ok(())
}

/// Checks a data set; recomputes all of it with `--replay`, and broken chunks with `--repair`.
pub(crate) fn verify(args: &VerifyArgs, quiet: bool) -> Result<(), Failure> {
    if ReportCheck::is_report(&args.folder) {
        if args.replay || args.repair {
            return Err(Failure::usage(
                "--replay and --repair are for data sets; a report is always recomputed",
            ));
        }
        return verify_report::run(&args.folder, quiet);
    }
    let execution = if args.replay || args.repair { Some(threads(args.threads)?) } else { None };
    let how = VerifyOptions {
        replay: execution.as_ref().filter(|_| args.replay),
        repair: execution.as_ref().filter(|_| args.repair),
    };
    let watcher = Watcher::new(quiet, &args.folder, 0);
    let checked = dataset::verify(&args.folder, how, &watcher);
    watcher.clear();
    let dataset::Verification { manifest, flaws, not_examined } =
        checked.map_err(|error| match error {
            DatasetError::Interrupted => Failure::Interrupted("interrupted".to_owned()),
            error => failed(error, &args.folder),
        })?;
    for flaw in &flaws {
        terminal::error(&shown(flaw, &args.folder));
    }
    if !flaws.is_empty() {
        if !args.repair && flaws.iter().any(|flaw| flaw.broken) {
            let folder = args.folder.to_string_lossy();
            let folder = shlex::try_quote(&folder).unwrap_or_default();
            terminal::say(&format!(
                "help: `libration verify --repair {folder}` recomputes broken chunks and replaces them"
            ));
        }
        return Err(Failure::Disagreement);
    }
    if !quiet {
        let what = match args.replay {
            true => "as the manifest and the settings say",
            false => "with the checksums of the manifest",
        };
        let files = manifest.chunks.iter().map(|chunk| chunk.files.len()).sum::<usize>();
        let evidence = format!(
            "{} chunks, {files} files, {:.3} GB: all {what}",
            manifest.chunks.len(),
            manifest.bytes() as f64 / 1e9
        );
        let verdict = Verdict::new(Outcome::NoFault, evidence);
        let verdict = not_examined.into_iter().fold(verdict, Verdict::without);
        let limits = verdict.limits();
        for line in [&verdict.evidence, &limits].into_iter().filter(|line| !line.is_empty()) {
            terminal::print(&format!("{}\n", printable(line)))?;
        }
    }
    Ok(())
}

fn threads(threads: usize) -> Result<Execution, Failure> {
    Execution::serial().threads(threads).map_err(|error| Failure::ensemble(&error))
}
