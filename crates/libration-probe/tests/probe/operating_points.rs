//! Equilibria that were searched for: far from the request, that a run leaves, and that stand.

use libration_probe::{OperatingPoint, ProbeReport, Subject};
use libration_report::verdict::Outcome;

use crate::simulators::{Simulator, damped_pendulum, kinds};

/// An equilibrium at this change of the pendulum in parts of that of a near one, and whether a run from the request stays.
fn point(relative_change: f64, stands: bool) -> OperatingPoint {
    let change = 0.5 * relative_change;
    serde_json::from_value(serde_json::json!({
        "method": "Newton's method",
        "changes": [change],
        "largest": {"name": "pendulum", "unit": "rad", "change": change},
        "relative_change": relative_change,
        "residual": 0.0,
        "gained": [],
        "lost": [],
        "run": {"seconds": 5.0, "stands": stands, "least_factor": null, "tried_up_to": 1.0},
    }))
    .unwrap()
}

/// A damped pendulum: it hangs at 0, and is upright at π.
fn audit(angle: f64, point: OperatingPoint) -> ProbeReport {
    let mut subject = Subject::new("pendulum", vec![angle, 0.0], vec![0.0], 0.01);
    subject.operating_point = Some(point);
    Simulator::new(|x, u, dt| damped_pendulum(0.5, x, u, dt)).audit(&subject)
}

fn fault(report: &ProbeReport) -> &str {
    assert_eq!(report.verdict.outcome, Outcome::Fault, "{}", report.answer);
    let found = report.findings.iter().find(|finding| finding.kind.name() == "operating-point");
    let found = found.unwrap_or_else(|| panic!("{:?}", kinds(report)));
    assert!(found.is_fault);
    &found.text
}

#[test]
fn a_point_that_is_far_or_does_not_stand_is_a_fault_and_one_that_stands_is_none() {
    for near in [0.01, 0.1, 1.0] {
        let report = audit(0.0, point(near, true));
        assert_eq!(
            (kinds(&report), report.verdict.outcome),
            (vec![], Outcome::NoFault),
            "{}",
            report.answer
        );
    }
    let far = audit(0.0, point(1.2, true));
    let text = fault(&far);
    assert!(text.contains("not the requested one") && text.contains("0.6 rad"), "{text}");
    let falls = audit(0.0, point(0.1, false));
    let text = fault(&falls);
    assert!(text.contains("does not hold the requested state"), "{text}");
    assert!(text.contains("a run of 5 s from the request leaves its surroundings"), "{text}");
}

#[test]
fn an_upright_pendulum_is_unstable_in_the_system_itself() {
    let report = audit(core::f64::consts::PI, point(0.1, true));
    let text = fault(&report);
    // s² + s/2 − 9 = 0.
    let growth = -0.25 + (0.0625 + 9.0_f64).sqrt();
    assert!((growth - 2.76).abs() < 5e-3);
    assert!(text.contains("unstable in the system itself: a mode grows at 2.76 1/s"), "{text}");
}
