//! One quick run of all studies on the default configuration, for every test that looks at one.

use std::fs;
use std::path::PathBuf;
use std::sync::LazyLock;
use std::sync::atomic::AtomicBool;

use libration_lab::output::Output;
use libration_lab::{STUDIES, session};
use libration_report::Record;
use libration_report::record::Finding;
use libration_study::{Effort, Lab, Silent};

/// The folder that was written, and the records that it was written from.
static RUN: LazyLock<(PathBuf, Vec<Record>)> = LazyLock::new(|| {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("default-run");
    let _ = fs::remove_dir_all(&folder);
    let (config, stop) = (STUDIES.config(), AtomicBool::new(false));
    let lab = Lab::new(&config, Effort::Quick, &Silent, &stop);
    let results = session::run(&lab, STUDIES.studies, &Output::open(&folder).unwrap()).unwrap();
    (folder, results.studies)
});

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
