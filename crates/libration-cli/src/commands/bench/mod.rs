//! `libration bench`.

mod rollouts;
mod storage;

use std::error::Error;
use std::fmt::Write;
use std::path::Path;

use libration_env::dataset::DatasetError;
use libration_report::record::{Agreement, Finding, Record, Relation, Table, Undecided};
use libration_study::{Config, Effort, Lab, Machine, Study, StudyError};
use libration_study_batch::bench::{BenchFloat, RolloutCase};
use libration_study_batch::{Rate, Wanted};
use libration_study_batch::{Throughput, bench};
use serde_json::{Value, json};

use super::disagreements::check_findings;
use crate::args::{BenchArgs, simd};
use crate::error::{Failure, is_unusable};
use crate::progress::Reporter;
use crate::{interrupt, terminal};

/// Version of the JSON format.
const SCHEMA: &str = "libration.bench/2";

/// Default numbers of trajectories.
const COUNTS: [usize; 3] = [1_000, 100_000, 10_000_000];

/// Measures the speed of this machine and prints the result.
pub(crate) fn run(args: &BenchArgs, quiet: bool) -> Result<(), Failure> {
    let config = Config::new(args.effort, simd::instruction_set(args.simd)?);
    let wanted = wanted(args)?;
    let reporter = Reporter::new(quiet);
    let stop = interrupt::listen();
    let lab = Lab::new(&config, args.effort, &reporter, stop);
    let mut records = Vec::new();
    let text = if args.storage {
        let folder = args.folder.clone().unwrap_or_else(std::env::temp_dir);
        if !folder.is_dir() {
            let name = folder.display();
            return Err(Failure::usage(format!(
                "`{name}` (--folder) is not a folder; expected an existing folder"
            )));
        }
        let rates = bench::storage(&lab, &folder);
        reporter.clear();
        let rates = rates.map_err(|error| failure(error, Some(&folder)))?;
        if args.json { storage::json(&rates) } else { storage::text(&rates) }
    } else if args.rollouts {
        let rates = bench::rollouts(&lab, &cases(args));
        reporter.clear();
        let rates = rates.map_err(|error| failure(error, None))?;
        if args.json { rollouts::json(&rates) } else { rollouts::text(&rates) }
    } else if wanted.is_empty() {
        let record = Throughput.run(&lab);
        reporter.clear();
        let record = record.map_err(|error| failure(error, None))?;
        let text = if args.json { report_json(&record) } else { report_text(&record) };
        records.push(record);
        text
    } else {
        let rates = libration_study_batch::ladder(&lab, &wanted);
        reporter.clear();
        let rates = rates.map_err(|error| failure(error, None))?;
        if args.json { rates_json(&rates) } else { rates_text(&rates) }
    };
    terminal::print(&text)?;
    check_findings(&records)
}

/// Returns the measurements of --implementation.
fn wanted(args: &BenchArgs) -> Result<Vec<Wanted>, Failure> {
    let counts = if args.count.is_empty() { &COUNTS[..] } else { &args.count };
    let floats = if args.dtype.is_empty() { &BenchFloat::ALL[..] } else { &args.dtype };
    let mut wanted = Vec::new();
    for &implementation in &args.implementation {
        for &float in floats {
            for &count in counts {
                let one = Wanted { implementation, float, count };
                one.check().map_err(|error| {
                    Failure::usage(format!("{count} trajectories (--num-trajectories): {error}"))
                })?;
                if !wanted.contains(&one) {
                    wanted.push(one);
                }
            }
        }
    }
    Ok(wanted)
}

/// Returns the rollouts to measure; with effort quick only those below 256 MiB.
fn cases(args: &BenchArgs) -> Vec<RolloutCase> {
    if !args.case.is_empty() {
        return args.case.clone();
    }
    let most = if args.effort == Effort::Quick { 1 << 28 } else { usize::MAX };
    RolloutCase::ALL.into_iter().filter(|case| case.bytes() < most).collect()
}

/// Converts an error; `folder` is that of --folder.
fn failure(error: StudyError, folder: Option<&Path>) -> Failure {
    match error {
        StudyError::Interrupted => Failure::Interrupted("interrupted".to_owned()),
        StudyError::Other(error) if is_about(&*error, folder) => {
            Failure::usage(format!("{error} (--folder)"))
        }
        error => Failure::run(error),
    }
}

/// Whether an error concerns the folder of --folder.
fn is_about(error: &(dyn Error + 'static), folder: Option<&Path>) -> bool {
    let error = error.downcast_ref::<DatasetError>();
    error.zip(folder).is_some_and(|(error, folder)| is_unusable(error, folder))
}

fn report_json(record: &Record) -> String {
    let all = json!({
        "schema": SCHEMA,
        "machine": Machine::detect(),
        "findings": record.findings,
        "tables": record.tables,
    });
    format!("{all:#}\n")
}

fn report_text(record: &Record) -> String {
    let mut text = String::new();
    for table in &record.tables {
        // Writing to a String cannot fail.
        let _ = write!(text, "{}\n{}\n", table.name, columns(&lines(table)));
    }
    let _ = write!(text, "ratios\n{}", columns(&ratios(record)));
    text
}

/// Returns the ratios with a verdict, and those that were too noisy for one.
fn ratios(record: &Record) -> Vec<Vec<String>> {
    let head = ["finding", "measured", "at least", "verdict"].map(String::from).to_vec();
    let verdict = |finding: &Finding| match finding.verdict {
        Agreement::Agrees => Some("reached"),
        Agreement::Disagrees => Some("missed"),
        Agreement::Measured => match finding.undecided.as_ref()? {
            Undecided::Noisy(_) => Some("too noisy; repeat the run"),
            Undecided::Beyond(_) => Some("not reached"),
        },
    };
    let ratios = record.findings.iter().filter(|f| f.unit == "1" && f.relation != Relation::AtMost);
    let rows = ratios.filter_map(|finding| {
        let wanted = finding.predicted.map_or_else(|| "—".to_owned(), |bar| format!("{bar}"));
        let cells = [finding.id.clone(), format!("{:.3}", finding.measured), wanted];
        let verdict = verdict(finding)?.to_owned();
        Some(cells.into_iter().chain([verdict]).collect())
    });
    std::iter::once(head).chain(rows).collect()
}

/// Returns the head and the rows of a table, typeset as on the page.
fn lines(table: &Table) -> Vec<Vec<String>> {
    let rows = table.rows.iter().map(|row| row.iter().map(|cell| cell.typeset(3)).collect());
    std::iter::once(table.columns.clone()).chain(rows).collect()
}

fn rates_json(rates: &[Rate]) -> String {
    let rate = |rate: &Rate| -> Value {
        json!({
            "implementation": rate.implementation.name(),
            "dtype": rate.float.name(),
            "count": rate.count,
            "steps_per_second": rate.median,
            "spread": rate.spread,
        })
    };
    let rates: Vec<Value> = rates.iter().map(rate).collect();
    format!("{:#}\n", json!({ "schema": SCHEMA, "machine": Machine::detect(), "rates": rates }))
}

fn rates_text(rates: &[Rate]) -> String {
    let head = ["implementation", "float", "trajectories", "10⁹ steps/s", "spread"];
    let row = |rate: &Rate| {
        vec![
            rate.implementation.name().to_owned(),
            rate.float.name().to_owned(),
            rate.count.to_string(),
            format!("{:.3}", rate.median / 1e9),
            format!("{:.3}", rate.spread / 1e9),
        ]
    };
    let head = vec![head.map(String::from).to_vec()];
    columns(&head.into_iter().chain(rates.iter().map(row)).collect::<Vec<_>>())
}

/// Aligns the columns of lines.
fn columns(lines: &[Vec<String>]) -> String {
    let count = lines.first().map_or(0, Vec::len);
    // Columns are counted in characters.
    let width = |i: usize| lines.iter().map(|line| line[i].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..count).map(width).collect();
    let mut text = String::new();
    for line in lines {
        let padded = line.iter().zip(&widths).map(|(entry, &width)| format!("{entry:width$}"));
        let _ = writeln!(text, "  {}", padded.collect::<Vec<_>>().join("  ").trim_end());
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_aligned() {
        let lines = [["a", "Δt"], ["long", "1"]].map(|line| line.map(String::from).to_vec());
        assert_eq!(columns(&lines), "  a     Δt\n  long  1\n");
    }
}
