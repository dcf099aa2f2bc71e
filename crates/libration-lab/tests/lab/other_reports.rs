//! Reports on other configurations than the default: what they cannot show or judge, they say.

use std::collections::HashSet;
use std::fs;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

use libration::Method;
use libration_lab::output::Output;
use libration_lab::session::unjudged;
use libration_lab::{STUDIES, session};
use libration_study::{Config, Effort, Lab, Silent, Spring, Study};
use libration_study_motion::{DriftSettings, ErrorSettings, NonlinearSettings};
use serde_json::Value;

/// `results.json` and the page of a quick run.
fn report(name: &str, config: &Config, studies: &[&dyn Study]) -> (Value, String) {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    let stop = AtomicBool::new(false);
    let lab = Lab::new(config, Effort::Quick, &Silent, &stop);
    session::run(&lab, studies, &Output::open(&folder).unwrap()).unwrap();
    let read = |file: &str| fs::read_to_string(folder.join(file)).unwrap();
    (serde_json::from_str(&read("results.json")).unwrap(), read("report.html"))
}

/// The default, but for runs short enough for a test.
fn short() -> Config {
    STUDIES
        .config()
        .with(DriftSettings { dt: vec![1e-3, 1e-2], steps: 2_000 })
        .with(ErrorSettings { dt: 1e-3, steps: 2_000 })
        .with(NonlinearSettings { turns: 100, ..STUDIES.config().get::<NonlinearSettings>() })
}

#[test]
fn a_claim_that_cannot_be_judged_is_listed_with_the_reason() {
    let config = Config { oscillator: Spring { m: 1.0, k: 1.0 }, ..short() };
    let (results, page) = report(
        "stiffness-1",
        &config,
        &[&libration_study_motion::Drift, &libration_study_motion::Error],
    );
    let unjudged = results["unjudged"].as_array().unwrap();
    // The source claims nothing of another oscillator, and its page has no ledger.
    assert!(!page.contains("id=\"ledger\""));
    let (_, page) = report(
        "short",
        &short(),
        &[&libration_study_motion::Drift, &libration_study_motion::Error],
    );
    let ledger = page.split("id=\"ledger\"").nth(1).unwrap().split("</section>").next().unwrap();
    let listed = ledger.split("Not judged with this configuration").nth(1).unwrap();
    for id in ["C03", "C16", "C19", "C25", "C73", "C74", "C75", "C76", "C77", "C78", "C79"] {
        let claim = unjudged.iter().find(|claim| claim["id"] == id).unwrap();
        assert!(claim["because"].as_str().unwrap().contains("the source’s own run"), "{claim}");
    }
    assert!(listed.contains("<span id=\"C74\">"));
    // Those of studies that were not run take a line, and are no alarm.
    assert!(listed.contains("Only some studies were run"));
    assert!(!listed.contains("<span id=\"C09\">"));
    assert!(unjudged.iter().any(|claim| claim["id"] == "C09"));
    // Judged, not judged and never tried: each of the source's claims is in one of the lists.
    let judged = results["studies"].as_array().unwrap().iter();
    let judged = judged.flat_map(|study| study["claims"].as_array().unwrap());
    let lists = judged.chain(unjudged).chain(results["claims_without_study"].as_array().unwrap());
    let ids: Vec<&str> = lists.map(|claim| claim["id"].as_str().unwrap()).collect();
    assert_eq!((ids.len(), ids.iter().collect::<HashSet<_>>().len()), (101, 101), "{ids:?}");
}

#[test]
fn a_ledger_in_which_nothing_could_be_judged_is_there_all_the_same() {
    let (_, page) = report("nothing-judged", &short(), &[&libration_study_motion::Error]);
    assert!(page.contains("No claim of the source report was judged"));
    assert!(page.contains("<span id=\"C74\">"));
}

#[test]
fn a_report_on_one_integrator_shows_no_empty_figure_and_no_empty_answer() {
    for method in [Method::Leapfrog, Method::ExplicitEuler] {
        let config = Config { integrators: vec![method], ..short() };
        let (results, page) = report(
            &format!("only-{}", method.name()),
            &config,
            &[
                &libration_study_motion::Spectrum,
                &libration_study_motion::Drift,
                &libration_study_motion::Nonlinear::FROM_CONFIGURATION,
            ],
        );
        assert!(page.contains(" · 1 integrator · "));
        let figures: Vec<&str> = page.split("<figure ").skip(1).collect();
        assert!(figures.len() >= 3);
        for figure in figures {
            let name = figure.split('"').nth(1).unwrap();
            let marks = figure.split("</figure>").next().unwrap().matches("class=\"ink-").count();
            assert!(marks > 0 || figure.contains("<image"), "{}: {name} is empty", method.name());
        }
        let head = page.split("<h2").next().unwrap();
        assert!(!head.contains(": ;") && !head.contains(": ."), "{head}");
        let figures = results["studies"].as_array().unwrap().iter();
        let mut ids = figures.flat_map(|study| study["figures"].as_array().unwrap());
        assert!(ids.all(|figure| figure["id"] != "nonlinear-portraits"));
    }
}

/// Here and not beside `unjudged`: the program of the unit tests would hold every study for it.
#[test]
fn a_claim_that_is_not_judged_says_why() {
    let because = |config: &Config, id: &str, studies: &[&dyn Study]| {
        let all = unjudged(config, studies, &[]);
        all.into_iter().find(|claim| claim.id == id).map(|claim| claim.because)
    };
    let all = STUDIES.studies;
    let leapfrog = Config { integrators: vec![Method::Leapfrog], ..STUDIES.config() };
    let why = because(&leapfrog, "C16", all).unwrap_or_default();
    assert!(why.ends_with("not in the configuration: velocity Verlet, RK4"), "{why}");
    let why = because(&STUDIES.config(), "C16", all).unwrap_or_default();
    assert!(why.contains("the source’s own run"), "{why}");
    let why = because(&STUDIES.config(), "C16", &[]).unwrap_or_default();
    assert_eq!(why, "its study, `drift`, was not run");
}
