//! Runs that do not converge are no evidence, and honest runs are not accused.

use libration_energy::{EnergyReport, EnergyTrace, FindingKind, Requirement, audit};
use libration_report::verdict::Outcome;

use crate::honest::{
    System, ball, double_pendulum, duffing, henon_heiles, kepler, pendulum, reflected, stiff,
    verlet, wall,
};
use crate::programs::{self, chain, oscillator, rk4};

/// Runs by velocity Verlet with a step, its half and its quarter; each step is in the log.
fn runs<const N: usize>(system: &System<N>, dt: f64, duration: f64) -> [EnergyTrace; 3] {
    [dt, dt / 2.0, dt / 4.0].map(|dt| verlet(system, dt, duration, 1))
}

fn mapped(mut traces: [EnergyTrace; 3], change: impl Fn(f64) -> f64) -> [EnergyTrace; 3] {
    for trace in &mut traces {
        trace.energies.iter_mut().for_each(|energy| *energy = change(*energy));
    }
    traces
}

fn audited(traces: &[EnergyTrace]) -> EnergyReport {
    match audit(traces, Requirement::default()) {
        Ok(report) => report,
        Err(error) => panic!("{error}"),
    }
}

fn six_digits(x: f64) -> f64 {
    match format!("{x:.5e}").parse() {
        Ok(x) => x,
        Err(error) => panic!("{error}"),
    }
}

fn single(x: f64) -> f64 {
    f64::from(x as f32)
}

#[test]
fn close_encounters_that_no_step_resolves_are_no_fault_of_the_energy_and_no_clean_bill() {
    // The pericentre passes in r/v = 2 ms. The first step of dt adds (dt/2·r⁻²)²/2 to the energy −0.995: 3.1 at dt = 2 ms, so that the
    // orbit is another one, and the runs are at its pericentre at other times.
    for (distance, speed, dt) in [
        (0.02, 9.9, 0.002),
        (0.02, 9.9, 0.004),
        (0.02, 9.9, 0.001),
        (0.02, 9.5, 0.002),
        (0.05, 6.2, 0.01),
        (0.01, 14.0, 0.001),
        (1.0, 0.1, 0.004),
    ] {
        let report = audited(&runs(&kepler(distance, speed), dt, 60.0));
        let case = format!("{distance} {speed} {dt}: {}", report.answer);
        assert_eq!(report.verdict.outcome, Outcome::Unknown, "{case}");
        assert!(
            report.findings.iter().any(|finding| finding.kind == FindingKind::NotConverged),
            "{case}"
        );
        assert!(!report.answer.contains("no fault"), "{case}");
    }
    // A constant of the potential changes nothing.
    let raised = mapped(runs(&kepler(0.02, 9.9), 0.002, 60.0), |energy| energy + 100.0);
    assert_eq!(audited(&raised).verdict.outcome, Outcome::Unknown);
}

#[test]
fn an_orbit_that_leaves_wrongly_is_no_clean_bill() {
    for (distance, speed, dt) in [
        (0.02, 9.9, 0.02),
        (0.02, 9.9, 0.04),
        (0.02, 9.9, 0.01),
        (1.0, 0.1, 0.02),
        (1.0, 0.03, 0.004),
    ] {
        let report = audited(&runs(&kepler(distance, speed), dt, 60.0));
        let verdict = &report.verdict;
        assert_eq!(verdict.outcome, Outcome::Unknown, "{distance} {dt}: {}", report.answer);
        assert!(verdict.evidence.contains("does not resolve the energy"), "{}", verdict.evidence);
    }
    // A ball on a spring with three steps per contact at the longest step leaves with a thousand times its energy.
    let report = audited(&runs(&ball(1.0, 0.0), 0.019, 200.0));
    assert_eq!(report.verdict.outcome, Outcome::Unknown, "{}", report.answer);
}

#[test]
fn honest_runs_of_smooth_stiff_chaotic_and_colliding_systems_are_not_accused() {
    let oscillators = |step| [0.2, 0.1, 0.05].map(|dt| oscillator(step, dt, 100.0));
    let fine = || [0.01, 0.005, 0.0025].map(|dt| oscillator(programs::verlet, dt, 30.0));
    let orbit = || runs(&kepler(0.4, 2.0), 0.01, 60.0);
    let flyby = System { start: ([-5.0, 1.0], [1.0, 0.0]), ..kepler(1.0, 1.0) };
    let all: [(&str, [EnergyTrace; 3]); 23] = [
        ("oscillator", oscillators(programs::verlet)),
        ("oscillator by RK4", oscillators(rk4)),
        ("oscillator of energy 0", mapped(oscillators(programs::verlet), |energy| energy - 0.5)),
        ("oscillator, six digits", mapped(oscillators(programs::verlet), six_digits)),
        ("oscillator, single precision", mapped(oscillators(programs::verlet), single)),
        ("fine steps, six digits", mapped(fine(), six_digits)),
        ("fine steps, single precision", mapped(fine(), single)),
        ("pendulum", runs(&pendulum(2.5), 0.1, 100.0)),
        ("pendulum from level", runs(&pendulum(std::f64::consts::FRAC_PI_2), 0.1, 100.0)),
        ("pendulum from near the top", runs(&pendulum(3.13), 0.02, 40.0)),
        ("double pendulum", [0.04, 0.02, 0.01].map(|dt| double_pendulum(dt, 100.0))),
        ("ball on a spring", runs(&ball(1.0, 0.0), 0.002, 30.0)),
        ("ball, one bounce", runs(&ball(1.0, 0.0), 0.002, 3.5)),
        ("ball, reflected", [0.01, 0.005, 0.0025].map(|dt| reflected(dt, 50.0))),
        ("wall, once", runs(&wall(), 0.02, 20.0)),
        ("stiff springs", runs(&stiff(), 0.004, 20.0)),
        ("orbit", orbit()),
        ("orbit, six digits", mapped(orbit(), six_digits)),
        ("orbit, single precision", mapped(orbit(), single)),
        ("orbit of eccentricity 0.9", runs(&kepler(0.1, 19_f64.sqrt()), 0.001, 20.0)),
        ("flyby", runs(&flyby, 0.02, 15.0)),
        ("Hénon and Heiles", runs(&henon_heiles(), 0.1, 300.0)),
        ("Duffing", runs(&duffing(), 0.05, 100.0)),
    ];
    for (name, traces) in all {
        let report = audited(&traces);
        assert_eq!(report.verdict.outcome, Outcome::NoFault, "{name}: {}", report.answer);
    }
    // Parts of a long chaotic motion: none is out of line.
    let chains = [0.1, 0.05, 0.025].map(|dt| chain(dt, 2000.0));
    for part in 0..4 {
        let cut = chains.clone().map(|chain| {
            let length = chain.times.len() / 4;
            let range = part * length..(part + 1) * length;
            let (times, energies) =
                (chain.times[range.clone()].to_vec(), chain.energies[range].to_vec());
            EnergyTrace { times, energies, ..chain }
        });
        let found = audited(&cut).findings;
        let is_new = |kind| matches!(kind, FindingKind::LocalDeviation | FindingKind::NotConverged);
        assert!(!found.iter().any(|finding| is_new(finding.kind)), "{part}: {found:?}");
    }
}
