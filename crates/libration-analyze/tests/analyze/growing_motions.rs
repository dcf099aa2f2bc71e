//! Steps on plants with motions that grow.

use std::sync::atomic::AtomicBool;

use libration::linear::{LinearPlant, Matrix};
use libration::{AnyMethod, ImplicitMethod, Method};
use libration_analyze::Stepping;
use libration_analyze::linear_analysis::{LinearRequest, analyze};
use libration_report::verdict::{Outcome, Verdict};

/// The verdict on steps of `dt` seconds on a plant with this matrix.
fn verdict_on(rows: &[Vec<f64>], method: impl Into<AnyMethod>, dt: f64) -> Verdict {
    let n = rows.len();
    let column = Matrix::from_fn(n, 1, |_, _| 1.0);
    let plant = LinearPlant::new(
        Matrix::from_rows(rows).unwrap(),
        column,
        Matrix::identity(n),
        Matrix::zeros(n, 1),
    );
    let stepping = Stepping::from(method.into());
    let request = LinearRequest::open_loop(plant.unwrap(), dt, Some(stepping)).unwrap();
    analyze(&request, &AtomicBool::new(false)).unwrap().verdicts.step.unwrap()
}

/// The stability functions at `z = 3` by hand: backward Euler `1/(1 − z)`, the midpoint `(1 + z/2)/(1 − z/2)`, explicit Euler `1 + z`; an
/// exact step multiplies by `e³ = 20.09`.
#[test]
fn steps_that_damp_or_turn_a_growing_motion_do_not_resolve_it() {
    let growing = [vec![1.0]];
    for (method, dt, own) in [
        (AnyMethod::from(ImplicitMethod::BackwardEuler), 3.0, "−0.5"),
        (ImplicitMethod::ImplicitMidpoint.into(), 3.0, "−5"),
        (ImplicitMethod::BackwardEuler.into(), 30.0, "−0.03448"),
        (Method::ExplicitEuler.into(), 3.0, "4"),
    ] {
        let verdict = verdict_on(&growing, method, dt);
        assert_eq!(verdict.outcome, Outcome::NotResolved, "{method:?} {dt}: {verdict}");
        assert!(verdict.evidence.contains(&format!("multiplies it by {own},")), "{verdict}");
    }
    // A slow growth under a fast rotation, and beside a mode that grows fast: the steps have 1 − (ωh)⁶/144, and 1 + hσ.
    let turning = |growth: f64| vec![vec![growth, -10.0], vec![10.0, growth]];
    let slow = verdict_on(&turning(1e-3), Method::Rk4, 0.1);
    assert_eq!(slow.outcome, Outcome::NotResolved, "{slow}");
    let beside = vec![vec![5.0, 0.0, 0.0], vec![0.0, 0.1, -9.0], vec![0.0, 9.0, 0.1]];
    let beside = verdict_on(&beside, Method::ExplicitEuler, 0.02);
    assert_eq!(beside.outcome, Outcome::NotResolved, "{beside}");
    // Steps within a few per cent of the exact growth follow it, and are stable.
    for (rows, method, dt) in [
        (growing.to_vec(), AnyMethod::from(ImplicitMethod::BackwardEuler), 0.1),
        (growing.to_vec(), ImplicitMethod::ImplicitMidpoint.into(), 0.5),
        (growing.to_vec(), Method::Rk4.into(), 3.0),
        (turning(1.0), Method::Rk4.into(), 0.02),
        (vec![vec![0.0, 1.0], vec![4.0, 0.0]], Method::VelocityVerlet.into(), 0.1),
        (vec![vec![-1.0]], ImplicitMethod::BackwardEuler.into(), 30.0),
    ] {
        let verdict = verdict_on(&rows, method, dt);
        assert_eq!(verdict.outcome, Outcome::Stable, "{rows:?} {method:?} {dt}: {verdict}");
    }
}
