//! A run that is stopped keeps the studies that it finished.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use libration_lab::output::Output;
use libration_lab::session::{Cause, SessionError};
use libration_lab::{STUDIES, session};
use libration_report::Record;
use libration_report::page::Page;
use libration_report::record::RecordError;
use libration_study::{Effort, Lab, Progress, Study, StudyError};
use serde_json::json;

/// Sweeps over a hundred items.
struct Hundred(&'static str);

impl Study for Hundred {
    fn name(&self) -> &'static str {
        self.0
    }
    fn question(&self) -> &'static str {
        "How long is a hundred?"
    }
    fn run(&self, lab: &Lab<'_>) -> Result<Record, StudyError> {
        lab.sweep("counting", &[(); 100], |()| Ok(()))?;
        Ok(Record::new(self.0, self.question()))
    }
    fn render(&self, _: &Record, _: &mut Page) -> Result<(), RecordError> {
        Ok(())
    }
}

/// A user who stops the run when `patience` parts are done.
struct Impatient<'a> {
    patience: usize,
    done: AtomicUsize,
    studies: AtomicUsize,
    stop: &'a AtomicBool,
}

impl Progress for Impatient<'_> {
    fn study(&self, _: &str, number: usize, of: usize) {
        assert_eq!(of, 2);
        assert_eq!(number, self.studies.fetch_add(1, Ordering::Relaxed) + 1);
    }
    fn begin(&self, what: &str, total: usize) {
        assert_eq!((what, total), ("counting", 100));
    }
    fn advance(&self) {
        if self.done.fetch_add(1, Ordering::Relaxed) + 1 == self.patience {
            self.stop.store(true, Ordering::Relaxed);
        }
    }
    fn end(&self) {}
}

/// Runs two studies under a user of that patience; gives the outcome and `results.json`.
fn run(patience: usize) -> (Result<usize, SessionError>, serde_json::Value) {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("patience-{patience}"));
    let output = Output::open(folder).unwrap();
    let (config, stop) = (STUDIES.config(), AtomicBool::new(false));
    let user = Impatient {
        patience,
        done: AtomicUsize::new(0),
        studies: AtomicUsize::new(0),
        stop: &stop,
    };
    let lab = Lab::new(&config, Effort::Quick, &user, &stop);
    let outcome = session::run(&lab, &[&Hundred("first"), &Hundred("second")], &output);
    let results = std::fs::read(output.path("results.json"));
    let results = results.map(|bytes| serde_json::from_slice(&bytes).unwrap());
    (outcome.map(|r| r.studies.len()), results.unwrap_or_default())
}

#[test]
fn a_patient_user_gets_both_studies() {
    let (outcome, results) = run(1000);
    assert_eq!(outcome.unwrap(), 2);
    assert_eq!(results["complete"], true);
    assert_eq!(results["studies"][1]["name"], "second");
}

#[test]
fn a_study_that_was_stopped_is_not_in_the_results_but_those_before_it_are() {
    let (outcome, results) = run(110);
    let cause = outcome.map_err(|error| *error.cause);
    assert!(matches!(cause, Err(Cause::Interrupted)), "{cause:?}");
    assert_eq!(results["complete"], false);
    assert_eq!(results["studies"].as_array().unwrap().len(), 1);
    assert_eq!(results["studies"][0]["name"], "first");
}

#[test]
fn an_older_report_stays_until_a_run_ends_and_an_unfinished_one_is_beside_it_and_says_so() {
    // Stopped never, within the first study, and within the second.
    for (patience, kept) in [(1001, None), (10, Some(false)), (120, Some(true))] {
        let folder =
            PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("patience-{patience}"));
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join("report.html"), "an older report").unwrap();
        let error = run(patience).0.err();
        let found = std::fs::read_to_string(folder.join("report.html")).unwrap();
        let aside = folder.join("libration-unfinished");
        let Some(kept) = kept else {
            assert!(found.contains("<html") && !found.contains("incomplete") && !aside.exists());
            continue;
        };
        assert_eq!(found, "an older report");
        assert_eq!(error.unwrap().kept, kept.then(|| aside.clone()));
        let partial = std::fs::read_to_string(aside.join("report.html"));
        assert_eq!(partial.is_ok(), kept);
        assert!(partial.is_err() || partial.unwrap().contains("This report is incomplete"));
    }
}

#[test]
fn a_run_that_was_killed_while_it_replaced_files_is_ended_by_the_next() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("killed");
    let _ = std::fs::remove_dir_all(&folder);
    let aside = folder.join("libration-unfinished");
    let write = |path: &str, text: &str| {
        let path = folder.join(path);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    };
    let results = |name: &str, data: &[&str]| {
        let data: Vec<_> = data.iter().map(|file| json!({ "name": "x", "file": file })).collect();
        let study = json!({ "name": name, "figures": [], "data": data });
        let schema = libration_lab::results::SCHEMA;
        json!({ "schema": schema, "complete": true, "studies": [study] }).to_string()
    };
    // Of the newer run one file of two is in place.
    let (older, newer) = (["data/stays", "data/goes"], ["data/stays", "data/comes"]);
    older.iter().for_each(|file| write(file, "older"));
    write("data/mine", "mine");
    write("results.json", &results("older", &older));
    write("report.html", "older");
    write("data/stays", "newer");
    write("libration-unfinished/data/comes", "newer");
    write("libration-unfinished/results.json", &results("newer", &newer));
    write("libration-unfinished/report.html", "newer");
    drop(Output::open(&folder).unwrap());
    let read = |file: &str| std::fs::read_to_string(folder.join(file)).ok();
    for file in ["data/stays", "data/comes", "report.html"] {
        assert_eq!(read(file).as_deref(), Some("newer"), "{file}");
    }
    assert_eq!(read("results.json"), Some(results("newer", &newer)));
    assert_eq!((read("data/goes"), read("data/mine").as_deref()), (None, Some("mine")));
    assert!(!aside.exists());
}

#[test]
fn one_run_at_a_time_has_a_folder() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("locked");
    let first = Output::open(&folder).unwrap();
    let refused = Output::open(&folder).unwrap_err();
    assert!(refused.to_string().contains("another run writes there"), "{refused}");
    drop(first);
    assert!(Output::open(&folder).is_ok());
}

#[test]
fn a_folder_that_cannot_take_the_files_is_refused_before_any_work() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("half");
    for (name, is_folder) in [
        ("figures", false),
        ("report.html", true),
        ("results.json", true),
        ("data/x.parquet", true),
    ] {
        std::fs::remove_dir_all(&folder).ok();
        std::fs::create_dir_all(&folder).unwrap();
        let path = folder.join(name);
        match is_folder {
            true => std::fs::create_dir_all(&path).unwrap(),
            false => std::fs::write(&path, "").unwrap(),
        }
        assert!(Output::open(&folder).is_err(), "{name}");
    }
}
