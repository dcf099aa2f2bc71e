//! Verdicts follow the evidence, at settings far from the default.

use std::sync::atomic::AtomicBool;

use libration_lab::STUDIES;
use libration_report::Record;
use libration_report::record::{Claim, ClaimVerdict};
use libration_study::{Config, Effort, Lab, Silent, Study};
use libration_study_motion::{DriftSettings, StabilitySettings};

fn run(study: &dyn Study, config: &Config) -> Record {
    let stop = AtomicBool::new(false);
    study.run(&Lab::new(config, Effort::Quick, &Silent, &stop)).unwrap()
}

fn stability(tolerance: f64, steps: u64) -> Record {
    let stability = StabilitySettings { tolerances: vec![tolerance], steps: vec![steps] };
    run(&libration_study_motion::Stability, &STUDIES.config().with(stability))
}

fn claim<'a>(record: &'a Record, id: &str) -> Option<&'a Claim> {
    record.claims.iter().find(|claim| claim.id == id)
}

#[test]
fn which_step_is_largest_depends_on_the_criterion_whichever_is_tried() {
    // Beyond and before N*(ε); without a tolerance RK4’s is always larger.
    for tolerance in [0.1, 0.001] {
        let record = stability(tolerance, 10_000);
        for id in ["C30", "C35", "C80"] {
            let claim = claim(&record, id).unwrap();
            assert_eq!(claim.verdict, ClaimVerdict::Conditional, "{tolerance}: {claim:?}");
            assert!(claim.because.contains("boundedness"), "{}", claim.because);
        }
    }
    let before = stability(0.001, 10_000);
    let c70 = claim(&before, "C70").unwrap();
    assert!(c70.verdict == ClaimVerdict::Conditional && c70.because.contains("beyond"), "{c70:?}");
}

#[test]
fn a_tolerance_that_bounds_nothing_decides_nothing_about_verlet() {
    let record = stability(1000.0, 1000);
    for id in ["C30", "C35", "C70", "C80"] {
        assert!(claim(&record, id).is_none(), "{id}");
    }
    let c28 = claim(&record, "C28").unwrap();
    assert!(c28.verdict == ClaimVerdict::Refuted && c28.because.contains("larger step"), "{c28:?}");
}

#[test]
fn runs_of_a_few_steps_judge_no_claim_about_long_ones() {
    for (dt, steps) in [(1e-3, 1), (0.6, 3)] {
        let drift = DriftSettings { dt: vec![dt], steps };
        let record = run(&libration_study_motion::Drift, &STUDIES.config().with(drift));
        for id in ["C10", "C12", "C15", "C22", "C33", "C34"] {
            assert!(claim(&record, id).is_none(), "{id} after {steps} steps");
        }
    }
}

#[test]
fn a_gain_of_energy_is_no_loss_of_rk4() {
    // On both sides of z = 2√2.
    let drift = DriftSettings { dt: vec![0.89, 0.9], steps: 1000 };
    let record = run(&libration_study_motion::Drift, &STUDIES.config().with(drift));
    let c15 = claim(&record, "C15").unwrap();
    assert!(c15.findings.iter().all(|id| !id.contains("dt-0.9.")), "{:?}", c15.findings);
}
