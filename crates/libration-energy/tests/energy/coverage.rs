//! How often intervals hold, and how often a clean run is accused.

use libration_energy::{EnergyTrace, Requirement, audit};

use crate::programs::Noise;

/// Samples of a trace.
const SAMPLES: usize = 8_000;
/// Correlation time in samples: neighbours agree to 98 %, and a naive interval is ten times too narrow.
const MEMORY: f64 = 50.0;
/// Triples of traces.
const TRIPLES: usize = 400;

/// Correlated noise (autoregressive, of order 1) with the size of an oscillation of order 2, on an oscillation and a drift.
fn clean(noise: &mut Noise, dt: f64, drift: f64) -> EnergyTrace {
    let factor = (-1.0 / MEMORY).exp();
    let kick = (1.0 - factor * factor).sqrt();
    let mut slow = noise.normal();
    let phase = 6.0 * noise.uniform();
    let size = dt * dt;
    let times: Vec<f64> = (0..SAMPLES).map(|i| 0.1 * i as f64).collect();
    let energy = |t: &f64| {
        slow = factor * slow + kick * noise.normal();
        10.0 + size * (slow + (3.7 * t + phase).sin()) + drift * t
    };
    let energies = times.iter().map(energy).collect();
    EnergyTrace { title: format!("dt {dt}"), dt: Some(dt), times, energies }
}

#[test]
fn intervals_of_drift_rates_of_strongly_correlated_energies_hold_in_95_percent_of_runs() {
    let mut noise = Noise(0x9e37_79b9_7f4a_7c15);
    let (mut covered, mut naive, mut runs) = (0_u32, 0_u32, 0_u32);
    let mut accused = 0;
    for _ in 0..TRIPLES {
        let traces = [0.1, 0.05, 0.025].map(|dt| clean(&mut noise, dt, 0.0));
        let report = audit(&traces, Requirement::default()).unwrap();
        accused += usize::from(!report.holds());
        for run in &report.runs {
            runs += 1;
            covered += u32::from(run.drift_rate.contains(0.0));
            // Ordinary least squares: the standard deviation of the slope of white noise.
            let white = run.oscillation.value * (12.0 / SAMPLES as f64).sqrt() / run.duration;
            naive += u32::from(run.drift_rate.value.abs() < 1.96 * white);
        }
    }
    let share = f64::from(covered) / f64::from(runs);
    println!(
        "covered {share}, naive {}, accused {accused} of {TRIPLES}",
        f64::from(naive) / f64::from(runs)
    );
    // Of 1200 runs the share has the standard deviation √(0.95·0.05/1200) = 0.63 %; three of them are 1.9 %.
    assert!((share - 0.95).abs() < 0.019, "{share}");
    // The noise of the mean is √(2·50) = 10 times that of white noise, so that |slope| < 0.196 standard deviations: 16 %.
    assert!(f64::from(naive) / f64::from(runs) < 0.3);
    // A fault requires a drift at the level 10⁻⁴ in one of three runs: 0.12 of 400 triples, so that 2 have a probability below 1 %.
    assert!(accused <= 1, "{accused}");
}
