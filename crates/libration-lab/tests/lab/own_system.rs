//! A system of the user's own, through the studies that take any.

use std::sync::atomic::AtomicBool;

use libration::system::{DampedOscillator, Duffing};
use libration::{Method, State};
use libration_lab::STUDIES;
use libration_report::Record;
use libration_study::{Config, Effort, Lab, Silent, Study};
use libration_study_motion::{Convergence, Nonlinear, Problem};

#[track_caller]
fn all_agree(records: &[Record], what: &str) {
    let broken: Vec<_> = records.iter().flat_map(Record::disagreements).collect();
    assert!(broken.is_empty(), "{what}: {broken:#?}");
}

#[test]
fn a_system_of_ones_own_goes_through_the_same_studies() {
    // A single well, whose orbits are closed; its small oscillations have the frequency √2.
    let well = Duffing { alpha: 2.0, beta: 1.0 };
    let start = State { q: [1.2], v: [0.4] };
    let problem =
        Problem::new("my well", well, start, 3.6).with_equilibrium(State::<f64, 1>::origin());
    let own = [problem];
    let config = Config { integrators: Method::ALL.to_vec(), ..STUDIES.config() };
    let stop = AtomicBool::new(false);
    let lab = Lab::new(&config, Effort::Quick, &Silent, &stop);
    let records =
        [Convergence::of(&own).run(&lab).unwrap(), Nonlinear::of(&own).run(&lab).unwrap()];
    all_agree(&records, "a system of one’s own");
    let of = |record: &Record, id: &str| record.finding(id).unwrap().clone();
    let order = of(&records[0], "convergence.my-well.yoshida4.global-order");
    assert_eq!(order.predicted, Some(4.0));
    let limit = of(&records[1], "nonlinear.my-well.leapfrog.small-limit");
    assert!((limit.measured - 2.0_f64.sqrt()).abs() < 1e-3, "{limit:?}");
    for record in &records {
        assert!(record.findings.iter().all(|f| f.id.contains(".my-well.")));
        let mut page = libration_report::page::Page::default();
        match record.name.as_str() {
            "convergence" => Convergence::of(&own).render(record, &mut page).unwrap(),
            _ => Nonlinear::of(&own).render(record, &mut page).unwrap(),
        }
        assert!(page.figures().count() >= 2);
    }
}

#[test]
fn a_force_that_depends_on_the_velocity_has_the_order_of_a_step_in_1024_bits() {
    let damped = DampedOscillator { omega2: 1.0, gamma: 0.3 };
    let start = State { q: [1.0], v: [0.2] };
    let problem = Problem::new("damped", damped, start, 6.3);
    let own = [problem];
    let config = STUDIES.config();
    let stop = AtomicBool::new(false);
    let lab = Lab::new(&config, Effort::Quick, &Silent, &stop);
    let record = Convergence::of(&own).run(&lab).unwrap();
    let order = |method: &str| {
        record.finding(&format!("convergence.damped.{method}.global-order")).unwrap().clone()
    };
    assert_eq!(order("velocity-verlet").predicted, Some(1.0));
    assert_eq!(order("rk4").predicted, Some(4.0));
    all_agree(std::slice::from_ref(&record), "damped");
}
