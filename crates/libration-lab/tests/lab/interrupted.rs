//! A run that is stopped keeps the studies that it finished.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use libration_lab::output::Output;
use libration_lab::page::Page;
use libration_lab::record::RecordError;
use libration_lab::session::{self, SessionError};
use libration_lab::study::StudyError;
use libration_lab::{Config, Effort, Lab, Progress, Record, Study};

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
    let (config, stop) = (Config::default(), AtomicBool::new(false));
    let user = Impatient {
        patience,
        done: AtomicUsize::new(0),
        studies: AtomicUsize::new(0),
        stop: &stop,
    };
    let lab = Lab::new(&config, Effort::Quick, &user, &stop);
    let outcome = session::run(&lab, &[&Hundred("first"), &Hundred("second")], &output);
    let results = std::fs::read(output.path("results.json")).unwrap();
    (outcome.map(|r| r.studies.len()), serde_json::from_slice(&results).unwrap())
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
    assert!(matches!(outcome, Err(SessionError::Interrupted)), "{outcome:?}");
    assert_eq!(results["complete"], false);
    assert_eq!(results["studies"].as_array().unwrap().len(), 1);
    assert_eq!(results["studies"][0]["name"], "first");
}

#[test]
fn an_older_report_is_gone_and_an_unfinished_one_says_so() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("patience-0");
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("report.html"), "an older report").unwrap();
    assert!(run(0).0.is_ok(), "nobody stops a run before its first part");
    assert!(!std::fs::read_to_string(folder.join("report.html")).unwrap().contains("incomplete"));
    // Stopped within the first study, and within the second.
    for (patience, report) in [(10, false), (120, true)] {
        let folder =
            PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("patience-{patience}"));
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join("report.html"), "an older report").unwrap();
        assert!(run(patience).0.is_err());
        let found = std::fs::read_to_string(folder.join("report.html"));
        assert_eq!(found.is_ok(), report);
        assert!(found.is_err() || found.unwrap().contains("This report is incomplete"));
    }
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
