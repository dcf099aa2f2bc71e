//! How often intervals hold, and how often a clean run is accused.

use libration_energy::{EnergyTrace, Finding, FindingKind, Requirement, audit};

use libration_report::verdict::Outcome;

use crate::programs::{Noise, trace};

/// Samples of a trace.
const SAMPLES: usize = 8_000;
/// Triples of traces.
const TRIPLES: usize = 500;

/// Correlated noise (autoregressive, of order 1) with a memory in samples and the size of an oscillation of order 2, on an
/// oscillation.
fn clean(noise: &mut Noise, dt: f64, memory: f64) -> EnergyTrace {
    let factor = (-1.0 / memory).exp();
    let kick = (1.0 - factor * factor).sqrt();
    let mut slow = noise.normal();
    let phase = 6.0 * noise.uniform();
    let size = dt * dt;
    let times: Vec<f64> = (0..SAMPLES).map(|i| 0.1 * i as f64).collect();
    let energy = |t: &f64| {
        slow = factor * slow + kick * noise.normal();
        10.0 + size * (slow + (3.7 * t + phase).sin())
    };
    let energies = times.iter().map(energy).collect();
    EnergyTrace { title: format!("dt {dt}"), dt: Some(dt), times, energies }
}

/// Parts of all runs.
struct Shares {
    /// Intervals that contain the rate.
    covered: f64,
    /// The same of ordinary least squares.
    naive: f64,
    /// Triples with a fault.
    accused: usize,
    /// Triples of which nothing is known.
    unknown: usize,
}

fn measured(memory: f64) -> Shares {
    let mut noise = Noise(0x9e37_79b9_7f4a_7c15);
    let (mut covered, mut naive, mut accused, mut unknown) = (0_u32, 0_u32, 0, 0);
    for _ in 0..TRIPLES {
        let traces = [0.1, 0.05, 0.025].map(|dt| clean(&mut noise, dt, memory));
        let Ok(report) = audit(&traces, Requirement::default()) else { panic!("no audit") };
        accused += usize::from(report.verdict.outcome == Outcome::Fault);
        unknown += usize::from(report.verdict.outcome == Outcome::Unknown);
        for run in &report.runs {
            covered += u32::from(run.drift_rate.contains(0.0));
            // The standard deviation of the slope of white noise.
            let white = run.oscillation.value * (12.0 / SAMPLES as f64).sqrt() / run.duration;
            naive += u32::from(run.drift_rate.value.abs() < 1.96 * white);
        }
    }
    let share = |count: u32| f64::from(count) / (3 * TRIPLES) as f64;
    Shares { covered: share(covered), naive: share(naive), accused, unknown }
}

/// Three standard deviations of a share of 95 % of 1500 runs: 3·√(0.95·0.05/1500).
const TOLERANCE: f64 = 0.017;

#[test]
fn intervals_of_drift_rates_of_correlated_energies_hold_in_95_percent_of_runs() {
    let Shares { covered, naive, accused, unknown } = measured(50.0);
    assert!((covered - 0.95).abs() < TOLERANCE, "{covered}");
    // The noise of the slope is √(2·50) = 10 times that of white noise, and the windows make it √(35/18) times as large. The oscillation adds
    // half to the variance that a naive interval takes for white: it covers 1.96·√1.5/13.9 = 0.172 deviations, 13.7 % of the runs. Three
    // standard deviations of that share are 2.7 %.
    assert!((naive - 0.137).abs() < 0.027, "{naive}");
    // A fault requires a drift at the level 10⁻⁴ in one of three runs: 0.15 of 500 triples, so that 2 have a probability of 1 %.
    assert!(accused <= 1, "{accused}");
    // The spread falls sixteenfold from the longest to the shortest step, which sizes without an interval tell, too.
    assert!(unknown <= 1, "{unknown}");
}

#[test]
fn intervals_are_not_too_narrow_if_batches_are_only_seven_times_as_long_as_the_memory() {
    // The shortest trace that allows: 8000/12/7. The noise then looks like a walk in some runs, which only widens their intervals.
    let Shares { covered, accused, unknown, .. } = measured(100.0);
    assert!(covered > 0.95 - TOLERANCE, "{covered}");
    assert!(accused <= 1, "{accused}");
    // A noise that looks like a walk in one run has no law of its walk.
    assert!(unknown <= TRIPLES / 50, "{unknown}");
}

/// How often intervals of the oscillation hold, how many runs have one, and the pairs with a fault.
fn oscillations(memory: f64) -> (f64, u32, usize) {
    const PAIRS: usize = 100;
    let mut noise = Noise(0x2545_f491_4f6c_dd1d);
    let (mut covered, mut bounded, mut accused) = (0_u32, 0_u32, 0);
    let factor = (-1.0 / memory).exp();
    for _ in 0..PAIRS {
        // Langevin's thermostat: a stationary energy of standard deviation 1, whatever the step.
        let traces = [1.0, 0.5].map(|dt| {
            let mut energy = noise.normal();
            let next = || {
                energy = factor * energy + (1.0 - factor * factor).sqrt() * noise.normal();
                100.0 + energy
            };
            let trace = trace("memory", 1.0, SAMPLES, 1, next, 100.0);
            EnergyTrace { dt: Some(dt), ..trace }
        });
        let Ok(report) = audit(&traces, Requirement::default()) else { panic!("no audit") };
        for run in &report.runs {
            covered += u32::from(run.oscillation.contains(1.0));
            bounded += u32::from(run.oscillation.high.is_finite());
        }
        let is_rounding = |finding: &Finding| finding.kind == FindingKind::RoundingWalk;
        accused += usize::from(report.findings.iter().any(is_rounding));
    }
    (f64::from(covered) / (2 * PAIRS) as f64, bounded, accused)
}

#[test]
fn oscillations_with_a_long_memory_have_no_interval_and_those_with_a_short_one_have_one_that_holds()
{
    let (covered, bounded, accused) = oscillations(250.0);
    // 32 memories of 200 runs.
    assert!(covered > 0.9 && bounded < 20, "{covered} {bounded}");
    assert!(accused <= 1, "{accused}");
    let (covered, bounded, accused) = oscillations(20.0);
    // 400 memories: three standard deviations of a share of 200 are 4.6 %.
    assert!(covered > 0.95 - 0.046 && bounded > 180, "{covered} {bounded}");
    assert!(accused <= 1, "{accused}");
}
