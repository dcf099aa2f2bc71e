//! Traces that no audit can use: each error says what is wrong.

use libration_energy::{EnergyTrace, Requirement, audit};

use crate::programs::{oscillator, verlet};

fn good() -> Vec<EnergyTrace> {
    vec![oscillator(verlet, 0.1, 100.0), oscillator(verlet, 0.05, 100.0)]
}

fn message(traces: &[EnergyTrace]) -> String {
    match audit(traces, Requirement::default()) {
        Ok(report) => panic!("{}", report.answer),
        Err(error) => error.to_string(),
    }
}

#[test]
fn unusable_traces_are_refused_with_the_reason() {
    assert!(message(&good()[..1]).contains("expected at least 2"));
    let changed = |change: &dyn Fn(&mut EnergyTrace)| {
        let mut traces = good();
        change(&mut traces[1]);
        message(&traces)
    };
    let mut same = good();
    same[0].dt = Some(0.05);
    same[1].dt = Some(0.05);
    let same = message(&same);
    assert!(same.contains("have the same time step, 0.05 s"), "{same}");
    assert!(changed(&|trace| trace.energies[7] = f64::NAN).contains("the energy of sample 8"));
    assert!(changed(&|trace| trace.times[7] = f64::INFINITY).contains("the time of sample 8"));
    assert!(changed(&|trace| trace.times[7] = 0.0).contains("do not increase at sample 8"));
    assert!(changed(&|trace| trace.energies.fill(0.5)).contains("is constant: 0.5"));
    let short = changed(&|trace| {
        trace.times.truncate(100);
        trace.energies.truncate(100);
    });
    assert!(short.contains("has 100 samples; expected at least 128"), "{short}");
    let cut = changed(&|trace| {
        trace.times.truncate(1500);
        trace.energies.truncate(1500);
    });
    assert!(cut.contains("expected runs of the same duration within 5 %"), "{cut}");
    assert!(changed(&|trace| trace.times.truncate(2000)).contains("2000 times and 2001 energies"));
    assert!(changed(&|trace| trace.dt = Some(-1.0)).contains("is -1; expected a positive"));
    assert!(changed(&|trace| trace.dt = Some(1.0)).contains("expected at least a step between"));
    let uneven = changed(&|trace| {
        trace.dt = None;
        // Every 40th sample is early by half an interval: an rms of 0.5·√(2/40) = 11 %.
        trace.times.iter_mut().skip(40).step_by(40).for_each(|time| *time -= 0.025);
    });
    assert!(uneven.contains("differ by") && uneven.contains("with --dt"), "{uneven}");
    let huge = changed(&|trace| trace.energies.iter_mut().for_each(|energy| *energy *= 1e300));
    assert!(huge.contains("too large for an audit"), "{huge}");
}

#[test]
fn any_finite_energies_are_audited_without_a_panic() {
    // Steps, spikes, tiny and alternating energies.
    let shapes: [fn(usize) -> f64; 6] = [
        |i| f64::from(i < 400),
        |i| if i == 300 { 1e150 } else { 0.0 },
        |i| 1e-300 * i as f64,
        |i| if i % 2 == 0 { 1.0 } else { -1.0 },
        |i| (i as f64).exp().min(1e100),
        |i| 1.0 + 1e-16 * (i as f64).sin() + f64::EPSILON * f64::from(i == 5),
    ];
    for shape in shapes {
        let trace = |dt: f64| {
            let times: Vec<f64> = (0..1000).map(|i| i as f64).collect();
            let energies = (0..1000).map(shape).collect();
            EnergyTrace { title: format!("{dt}"), dt: Some(dt), times, energies }
        };
        if let Ok(report) = audit(&[trace(0.5), trace(1.0)], Requirement::default()) {
            assert!(!report.answer.is_empty());
        }
    }
}

#[test]
fn a_requirement_is_a_positive_number() {
    let requirement = Requirement { tolerance: Some(-1.0), ..Requirement::default() };
    assert!(audit(&good(), requirement).unwrap_err().to_string().contains("tolerance is -1"));
    let requirement = Requirement { horizon: Some(f64::NAN), ..Requirement::default() };
    assert!(audit(&good(), requirement).unwrap_err().to_string().contains("horizon is NaN"));
}
