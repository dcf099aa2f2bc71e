//! One quick run of all studies on the default configuration, for every test that looks at one.

use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use std::sync::atomic::AtomicBool;
use std::{env, fs};

use libration_lab::output::Output;
use libration_lab::{STUDIES, session};
use libration_report::Record;
use libration_report::record::{Column, Finding, Series};
use libration_study::{Effort, Lab, Silent};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::{Row, RowAccessor};
use serde_json::Value;

/// The folder of the run, and its records: of the run that `LIBRATION_REPORT` names, if one has been made already.
static RUN: LazyLock<(PathBuf, Vec<Record>)> =
    LazyLock::new(|| match env::var_os("LIBRATION_REPORT") {
        Some(folder) => {
            let folder = PathBuf::from(folder);
            let records = read(&folder);
            (folder, records)
        }
        None => run(),
    });

fn run() -> (PathBuf, Vec<Record>) {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("default-run");
    let _ = fs::remove_dir_all(&folder);
    let (config, stop) = (STUDIES.config(), AtomicBool::new(false));
    let lab = Lab::new(&config, Effort::Quick, &Silent, &stop);
    let results = session::run(&lab, STUDIES.studies, &Output::open(&folder).unwrap()).unwrap();
    (folder, results.studies)
}

/// The records of the run in a folder, with their series.
fn read(folder: &Path) -> Vec<Record> {
    let results = fs::read(folder.join("results.json")).unwrap();
    let mut results: Value = serde_json::from_slice(&results).unwrap();
    let mut records: Vec<Record> = serde_json::from_value(results["studies"].take()).unwrap();
    for record in &mut records {
        let series = record.data.iter().map(|data| series(&data.name, &folder.join(&data.file)));
        record.series = series.collect();
    }
    records
}

/// The series in a Parquet file; the units of its columns are not read.
fn series(name: &str, file: &Path) -> Series {
    let reader = SerializedFileReader::new(fs::File::open(file).unwrap()).unwrap();
    let rows: Vec<Row> = reader.get_row_iter(None).unwrap().map(Result::unwrap).collect();
    let columns = reader.metadata().file_metadata().schema_descr().columns();
    let columns = columns.iter().enumerate().map(|(i, column)| Column {
        name: column.name().to_owned(),
        unit: String::new(),
        values: rows.iter().map(|row| row.get_double(i).unwrap()).collect(),
    });
    Series { name: name.to_owned(), columns: columns.collect() }
}

/// Where it wrote the file of that name.
pub(crate) fn file(name: &str) -> PathBuf {
    RUN.0.join(name)
}

/// Its records, in the order of the studies.
pub(crate) fn records() -> &'static [Record] {
    &RUN.1
}

pub(crate) fn measured(id: &str) -> f64 {
    finding(id).measured
}

pub(crate) fn predicted(id: &str) -> f64 {
    finding(id).predicted.unwrap_or_else(|| panic!("no prediction {id}"))
}

fn finding(id: &str) -> &'static Finding {
    let found = records().iter().find_map(|record| record.finding(id).ok());
    found.unwrap_or_else(|| panic!("no finding {id}"))
}
