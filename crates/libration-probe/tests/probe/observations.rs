//! Observations of a moment within the last step have an age, or are named as not examined.

use std::cell::RefCell;

use crate::simulators::{Simulator, kinds, pendulum, pendulum_subject};

#[test]
fn an_observation_of_a_moment_within_the_step_has_its_age() {
    // Four inner steps, of which the simulator stores the observation after the first ones.
    for (stored, age) in [(4, 0.0), (3, 0.25), (2, 0.5), (1, 0.75)] {
        let seen = RefCell::new(vec![0.0, 0.0]);
        let mut simulator = Simulator::new(|x, u, dt| {
            let mut x = x.to_vec();
            for k in 1..=4 {
                x = pendulum(&x, u, dt / 4.0);
                if k == stored {
                    seen.replace(x.clone());
                }
            }
            x
        });
        simulator.observe =
            Some(Box::new(|_| vec![seen.borrow()[0].sin(), seen.borrow()[0].cos()]));
        let report = simulator.audit(&pendulum_subject());
        let wanted = if age > 0.0 { vec!["stale-observation"] } else { vec![] };
        assert_eq!(kinds(&report), wanted, "{:?}", report.findings);
        let found = report.memory.unwrap().staleness();
        // The motion bends by ω dt = 3 % within a step.
        assert!((found - age).abs() < 0.03, "{found} {age}");
    }
    // One of the state that is asked for, and one in single precision.
    let seen = RefCell::new(vec![0.0, 0.0]);
    let mut simulator = Simulator::new(|x, u, dt| {
        let next = pendulum(x, u, dt);
        seen.replace(next.clone());
        next
    });
    simulator.observe = Some(Box::new(|x| vec![x[0].cos(), f64::from(seen.borrow()[1] as f32)]));
    assert_eq!(kinds(&simulator.audit(&pendulum_subject())), [""; 0]);
}

#[test]
fn the_age_within_a_step_of_one_length_is_named_as_not_examined() {
    let mut subject = pendulum_subject();
    subject.has_fixed_dt = true;
    let mut simulator = Simulator::new(pendulum);
    simulator.observe = Some(Box::new(<[f64]>::to_vec));
    let report = simulator.audit(&subject);
    let named = "observations that are old by up to a step".to_owned();
    assert!(report.verdict.not_examined.contains(&named), "{}", report.answer);
}
