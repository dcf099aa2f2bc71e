//! Clean simulations: measured laws against those of theory.

use libration_energy::{
    DriftCause, EnergyReport, EnergyTrace, FindingKind, OscillationCause, Requirement, audit, page,
};

use crate::molecular_dynamics::{End, lennard_jones};
use crate::programs::{Step, chain, euler, oscillator, rk4, trace, verlet};

pub(crate) fn audited(traces: &[EnergyTrace]) -> EnergyReport {
    audited_over(traces, 1000.0)
}

fn audited_over(traces: &[EnergyTrace], horizon: f64) -> EnergyReport {
    match audit(traces, Requirement { horizon: Some(horizon), ..Requirement::default() }) {
        Ok(report) => report,
        Err(error) => panic!("{error}"),
    }
}

fn oscillators(step: Step, steps: [f64; 3], duration: f64) -> EnergyReport {
    audited(&steps.map(|dt| oscillator(step, dt, duration)))
}

#[test]
fn energies_of_verlet_oscillate_with_order_2_and_do_not_drift() {
    let report = oscillators(verlet, [0.2, 0.1, 0.05], 300.0);
    assert!(report.findings.is_empty(), "{:?}", report.findings);
    assert_eq!(report.oscillation_cause, OscillationCause::Truncation);
    assert_eq!(report.drift_cause, DriftCause::Unresolved);
    // The page has no empty panel.
    let page = page(&report);
    assert!(page.contains("standard deviation") && !page.contains("rate per second"));
    assert!(page.contains("have no fault that was found</h1>"));
    // Verlet conserves ½v² + ½q²(1 − h²/4), so that from q = 1 the energy is ½ − h²/8·(1 − q²): its fluctuation is h²/8·std(q²) with
    // q² = ½ + ½cos 2t, of order 2 without a next term in q; frequencies shift by h²/24, which changes no size.
    for run in &report.runs {
        let predicted = run.dt * run.dt / 8.0 * 0.125_f64.sqrt();
        // A run of 95 half periods is not a whole number of them: 1/(4·95) of the square.
        assert!((run.oscillation.value / predicted - 1.0).abs() < 3e-3, "{:?}", run.oscillation);
        assert!(run.drift_rate.contains(0.0), "{:?}", run.drift_rate);
    }
    let order = report.oscillation_law.unwrap().exponent.value;
    assert!((order - 2.0).abs() < 0.01, "{order}");
}

#[test]
fn the_largest_step_of_verlet_is_that_of_the_conserved_energy() {
    let report = oscillators(verlet, [0.2, 0.1, 0.05], 300.0);
    // The largest deviation is h²/8; 10⁻⁴ of the energy ½ is met by h = √(8·5·10⁻⁵) = 0.02. The search has a grid of 0.1 %.
    let largest = report.largest_dt.unwrap();
    let dt = largest.dt.unwrap();
    assert!((dt / 0.02 - 1.0).abs() < 2e-3, "{dt}");
    assert!(largest.is_extrapolated && largest.low.unwrap() <= dt && dt <= largest.high.unwrap());
    // The same run with this step meets it, and with a step that is 1 % longer it does not.
    let deviation = |dt: f64| {
        let energies = oscillator(verlet, dt, 1000.0).energies;
        energies.iter().fold(0.0_f64, |most, energy| most.max((energy - 0.5).abs())) / 0.5
    };
    assert!(deviation(dt) <= 1e-4 && deviation(1.01 * dt) > 1e-4);
}

#[test]
fn the_energy_of_rk4_drifts_with_order_5_and_the_predicted_rate() {
    let report = oscillators(rk4, [0.2, 0.1, 0.05], 300.0);
    assert_eq!(report.drift_cause, DriftCause::Truncation);
    let kinds: Vec<FindingKind> = report.findings.iter().map(|finding| finding.kind).collect();
    assert_eq!(kinds, [FindingKind::TruncationDrift]);
    assert!(report.holds());
    // |R(ih)|² = 1 − h⁶/72 + h⁸/576 per step: the rate is −½·h⁵/72 at the start, with a next term of relative size h²/8.
    for run in &report.runs {
        let predicted = -0.5 * run.dt.powi(5) / 72.0 * (1.0 - run.dt * run.dt / 8.0);
        // The mean rate over the run is less by half of its decay, h⁵/72·300/2 = 7·10⁻⁴ at h = 0.2, where it is not exponential already.
        assert!((run.drift_rate.value / predicted - 1.0).abs() < 1e-3, "{:?}", run.drift_rate);
    }
    // The exponents between neighbours are 5 less the next term, at most h²/8/ln 2 = 0.7 % at h = 0.2.
    let order = report.drift_law.unwrap().exponent.value;
    assert!((order - 5.0).abs() < 0.01, "{order}");
    // 10⁻⁴ of the energy in 1000 s: h⁵/72·1000 = 10⁻⁴, h = 0.0936.
    let dt = report.largest_dt.unwrap().dt.unwrap();
    assert!((dt / (72e-7_f64).powf(0.2) - 1.0).abs() < 3e-3, "{dt}");
}

#[test]
fn explicit_euler_is_named_with_its_rate() {
    let report = oscillators(euler, [0.02, 0.01, 0.005], 100.0);
    assert_eq!(report.findings[0].kind, FindingKind::FirstOrderDrift);
    assert!(!report.holds() && report.runs.iter().all(|run| run.is_exponential));
    // |1 + ih|² = 1 + h² per step: the energy grows as exp(t·ln(1 + h²)/h).
    for run in &report.runs {
        let predicted = 0.5 * (run.dt * run.dt).ln_1p() / run.dt;
        assert!((run.drift_rate.value / predicted - 1.0).abs() < 1e-9, "{:?}", run.drift_rate);
    }
    assert!(report.largest_dt.unwrap().dt.is_none());
}

#[test]
fn velocities_half_a_step_off_are_an_oscillation_of_order_1() {
    let traces = [0.08, 0.04, 0.02].map(|dt| {
        let (mut q, mut v) = (1.0_f64, -0.5 * dt);
        let start = 0.5 * (q * q + v * v);
        let next = || {
            q += dt * v;
            v -= dt * q;
            0.5 * (q * q + v * v)
        };
        trace("leapfrog", dt, (400.0 / dt).round() as usize, 1, next, start)
    });
    let report = audited(&traces);
    let kinds: Vec<FindingKind> = report.findings.iter().map(|finding| finding.kind).collect();
    assert_eq!(kinds, [FindingKind::FirstOrderOscillation]);
    assert!(report.holds());
}

#[test]
fn without_time_steps_there_is_no_largest_step() {
    let traces = [0.2, 0.1].map(|dt| {
        let whole = oscillator(verlet, dt, 300.0);
        let thin = |values: &[f64]| values.iter().step_by(4).copied().collect();
        let (times, energies) = (thin(&whole.times), thin(&whole.energies));
        EnergyTrace { dt: None, times, energies, ..whole }
    });
    let report = audited(&traces);
    assert!(report.is_dt_assumed && report.largest_dt.is_none());
    assert!(report.answer.contains("dt assumed: the spacing of the samples"), "{}", report.answer);
}

#[test]
fn the_largest_step_of_explicit_euler_is_that_of_its_drift() {
    // A Duffing oscillator: its energy grows by no exact exponential, so that the curvature looks like a walk.
    let duffing: Step = |s, h| *s = [s[0] + h * s[1], s[1] - h * (s[0] + 0.5 * s[0].powi(3))];
    let traces = [0.004, 0.002, 0.001].map(|dt| {
        let mut state = [1.0, 0.0];
        let next = || {
            duffing(&mut state, dt);
            let [q, v]: [f64; 2] = state;
            0.5 * (v * v + q * q) + 0.125 * q.powi(4)
        };
        trace("duffing", dt, (20.0 / dt).round() as usize, 1, next, 0.625)
    });
    let report = audited_over(&traces, 20.0);
    // The energy grows by about 0.95·h per second: 10⁻⁴ of 0.625 in 20 s allows h = 3.3·10⁻⁶, less by the curvature.
    let dt = report.largest_dt.unwrap().dt.unwrap();
    assert!(dt > 1.5e-6 && dt < 4e-6, "{dt}");
}

#[test]
fn chaotic_chains_and_molecular_dynamics_by_verlet_have_order_2_and_no_fault() {
    let chains = [0.1, 0.05, 0.025].map(|dt| chain(dt, 2000.0));
    let particles = [0.008, 0.004, 0.002].map(|dt| lennard_jones(End::Smooth, dt, 200.0));
    for traces in [chains, particles] {
        let report = audited_over(&traces, 100.0);
        assert!(report.holds(), "{:?}", report.findings);
        assert_eq!(report.drift_cause, DriftCause::Unresolved);
        assert_eq!(report.oscillation_cause, OscillationCause::Truncation);
        // Different steps follow different chaotic paths, and a ratio of 4 in steps makes the statistical error of a size small.
        let order = report.oscillation_law.unwrap().exponent;
        assert!(order.contains(2.0) && order.high - order.low < 0.5, "{order:?}");
    }
}

#[test]
fn a_short_run_does_not_resolve_a_drift_and_says_which_run_does() {
    let particles =
        |duration: f64| [0.008, 0.004, 0.002].map(|dt| lennard_jones(End::Smooth, dt, duration));
    let width =
        |report: &EnergyReport| report.runs[0].drift_rate.high - report.runs[0].drift_rate.value;
    let traces = particles(20.0);
    // The oscillation of a step of 0.002 is allowed, that of 0.004 is not, so that the run with 0.002 decides.
    let tolerance = 1e-3;
    let first =
        audit(&traces, Requirement { tolerance: Some(tolerance), ..Requirement::default() })
            .unwrap();
    // A horizon over which the interval is eight times a fifth of the tolerance.
    let allowed = tolerance * first.largest_dt.unwrap().scale;
    let horizon = Some(8.0 * allowed / (5.0 * width(&first)));
    let report =
        audit(&traces, Requirement { tolerance: Some(tolerance), horizon, scale: None }).unwrap();
    assert!(report.findings.iter().any(|finding| finding.kind == FindingKind::ShortRun));
    // Under noise with a short memory the interval falls as the power 3/2 of the duration: 4^(3/2) = 8.
    let duration = report.largest_dt.unwrap().resolving_duration.unwrap();
    assert!((duration / 80.0 - 1.0).abs() < 1e-6, "{duration}");
    // Runs that are as long as the horizon are not told to be longer.
    let strict = audit(
        &traces,
        Requirement { tolerance: Some(0.3 * width(&first)), ..Requirement::default() },
    )
    .unwrap();
    let texts: Vec<&str> = strict.findings.iter().map(|finding| finding.text.as_str()).collect();
    assert!(texts.iter().any(|text| text.contains("runs are as long as the horizon")), "{texts:?}");
    let ratio =
        width(&first) / width(&audit(&particles(duration), Requirement::default()).unwrap());
    // Widths are estimates by at least 12 batches, with an error of 1/√(2·10) = 22 % each; three of both.
    assert!((ratio / 8.0).ln().abs() < 3.0 * 0.22 * 2.0_f64.sqrt(), "{ratio}");
}
