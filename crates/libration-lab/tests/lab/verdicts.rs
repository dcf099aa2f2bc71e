//! Verdicts follow the evidence, at settings far from the default.

use std::sync::atomic::AtomicBool;

use libration_lab::config::{Drift, Stability};
use libration_lab::record::{Claim, ClaimVerdict};
use libration_lab::{Config, Effort, Lab, Record, Silent, Study, studies};

fn run(study: &dyn Study, config: &Config) -> Record {
    let stop = AtomicBool::new(false);
    study.run(&Lab::new(config, Effort::Quick, &Silent, &stop)).unwrap()
}

fn stability(tolerance: f64, steps: u64) -> Record {
    let stability = Stability { tolerances: vec![tolerance], steps: vec![steps] };
    run(&studies::Stability, &Config { stability, ..Config::default() })
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
        let drift = Drift { dt: vec![dt], steps };
        let record = run(&studies::Drift, &Config { drift, ..Config::default() });
        for id in ["C10", "C12", "C15", "C22", "C33", "C34"] {
            assert!(claim(&record, id).is_none(), "{id} after {steps} steps");
        }
    }
}

#[test]
fn a_gain_of_energy_is_no_loss_of_rk4() {
    // On both sides of z = 2√2.
    let drift = Drift { dt: vec![0.89, 0.9], steps: 1000 };
    let record = run(&studies::Drift, &Config { drift, ..Config::default() });
    let c15 = claim(&record, "C15").unwrap();
    assert!(c15.findings.iter().all(|id| !id.contains("dt-0.9.")), "{:?}", c15.findings);
}
