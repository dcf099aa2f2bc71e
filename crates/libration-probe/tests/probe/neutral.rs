//! Plants without the neutral positions of a free base.

use libration::linear::{Complex64, Matrix, eigenvalues};
use libration_probe::Subject;

use super::simulators::Simulator;

/// Two masses that a spring joins, with friction of each: nothing depends on where both are.
fn pair(x: &[f64], u: &[f64], dt: f64) -> Vec<f64> {
    let spring = 50.0 * (x[0] - x[1]);
    let v = [x[2] + dt * (u[0] - spring - 0.5 * x[2]), x[3] + dt * (spring / 2.0 - 0.3 * x[3])];
    vec![x[0] + dt * v[0], x[1] + dt * v[1], v[0], v[1]]
}

/// The same with a third position that is neutral alone, whose velocity fades.
fn with_base(x: &[f64], u: &[f64], dt: f64) -> Vec<f64> {
    let mut next = pair(&[x[0], x[1], x[3], x[4]], u, dt);
    let w = x[5] - dt * 2.0 * x[5];
    next.insert(2, x[2] + dt * w);
    next.push(w);
    next
}

fn sorted(matrix: &Matrix) -> Vec<Complex64> {
    let mut all = eigenvalues(matrix).unwrap();
    all.sort_by(|a, b| (a.re, a.im).partial_cmp(&(b.re, b.im)).unwrap());
    all
}

#[test]
fn a_plant_without_neutral_positions_has_all_other_modes_and_the_same_inputs() {
    type Step = fn(&[f64], &[f64], f64) -> Vec<f64>;
    for (step, states, neutral) in [(pair as Step, 4, 1), (with_base as Step, 6, 2)] {
        let subject = Subject::new("masses", vec![0.0; states], vec![0.0], 0.01);
        let report = Simulator::new(step).audit(&subject);
        let found = report.without_neutral().unwrap();
        assert_eq!((found.left_out.len(), found.kept.len()), (neutral, states - neutral));
        assert_eq!(report.neutral_states().len(), neutral);
        let whole = sorted(&report.modified_flow.as_ref().unwrap().a);
        let left = sorted(&found.plant.a);
        // The zeros of the neutral positions come last but for rounding: all other modes decay.
        for (own, other) in left.iter().zip(&whole) {
            assert!((own - other).norm() < 1e-6 * other.norm().max(1.0), "{left:?} {whole:?}");
        }
        assert!(whole[states - neutral..].iter().all(|s| s.norm() < 1e-6));
        assert_eq!(found.plant.b.rows(), states - neutral);
    }
    // A pendulum has no neutral position.
    let hanging = |x: &[f64], _: &[f64], dt: f64| {
        let v = x[1] - dt * (9.0 * x[0].sin() + 0.1 * x[1]);
        vec![x[0] + dt * v, v]
    };
    let report = Simulator::new(hanging).audit(&Subject::new("p", vec![0.0; 2], vec![], 0.01));
    assert!(report.neutral_states().is_empty());
}
