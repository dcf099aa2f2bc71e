//! Correlated jitter: growth from the spectrum at twice the angle of a step.

use libration::Method;
use libration::analysis::StepNoise;
use libration::control::clock::Correlated;
use libration::ensemble::{All, Setup};
use libration::integrator::SymplecticEuler;
use libration::system::BaselineOnly;
use libration_report::record::{Finding, Record, Series, Tolerance};
use libration_study::{Lab, StudyError};

use super::setting::{Setting, Theory};
use super::{SEED, start};
use crate::loop_ensemble::run_snapshots;
use crate::sample::{ERRORS, Sample};

/// Steps `ωΔt`, which turn by half a radian and by one.
const Z: [f64; 2] = [0.3, 0.95];

/// Correlations of one step with the next.
const CORRELATIONS: [f64; 7] = [-0.8, -0.5, -0.2, 0.0, 0.2, 0.5, 0.8];

const RMS: f64 = 0.01;

/// Measures the walk for each correlation.
pub(super) fn measure(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    if !lab.config.integrators.contains(&Method::SymplecticEuler) {
        return Ok(());
    }
    let theories = Z.map(|z| setting(lab, z).theory());
    let trials = [0, 1].map(|i| CORRELATIONS.map(|correlation| (i, correlation))).concat();
    let starts = vec![start(lab); lab.effort.choose(128, 1024, 4096)];
    let steps = lab.effort.choose(2000, 10_000, 20_000);
    let found = lab.sweep("jitter with memory", &trials, |&(i, correlation)| {
        let setting = setting(lab, Z[i]);
        let (Some(theory), Some(noise)) = (theories[i], noise(correlation)) else {
            return Ok(None);
        };
        let clock = Correlated { rms: RMS, correlation };
        let setup = Setup::new(All(BaselineOnly(setting.model)), SymplecticEuler).clock(clock);
        let seen = run_snapshots(lab, setup, (setting.dt, SEED), &starts, &[steps])?;
        let walk = seen.iter().flat_map(|s| s.logarithms(|y| theory.form.at(y)));
        let walk = Sample::of(&walk.map(|x| x / 2.0).collect::<Vec<_>>());
        Ok(Some((theory, noise, walk)))
    })?;
    for (i, z) in Z.into_iter().enumerate() {
        let mut measured = Vec::new();
        for ((at, correlation), found) in trials.iter().zip(&found) {
            let Some((theory, noise, walk)) = found.as_ref().filter(|_| *at == i) else { continue };
            let growth = walk.deviation.powi(2) / steps as f64;
            measured.push((*correlation, growth));
            let angle = theory.resonance.angle.to_f64();
            let memory = angle * (1.0 - correlation.abs());
            // A variance is known half as well as a deviation.
            let part = 2.0 * ERRORS * walk.error_of_deviation() + (RMS / memory).powi(2);
            let why = "four standard errors of a variance, and the square of the jitter beside the angle in \
                       which it is forgotten";
            record.find(Finding::predicted(
                format!("jitter.memory.z-{z}.correlation-{correlation}"),
                format!(
                    "symplectic Euler, ωΔt = {z}, σ = 1 %, correlation {correlation}: variance of ln |y| a step, ½a²S(2θ)"
                ),
                "1",
                theory.variance(*noise),
                growth,
                Tolerance::relative(part, why),
            ));
        }
        if let Some(theory) = &theories[i] {
            record.series.extend(series(z, theory, &measured));
        }
    }
    Ok(())
}

fn setting(lab: &Lab<'_>, z: f64) -> Setting {
    let dt = z / lab.config.oscillator.omega();
    Setting::new(lab.config, Method::SymplecticEuler, dt, RMS)
}

fn noise(correlation: f64) -> Option<StepNoise> {
    StepNoise::autoregressive(RMS, correlation)
}

/// In units of what jitter without memory leaves.
fn series(z: f64, theory: &Theory, measured: &[(f64, f64)]) -> [Series; 2] {
    let white = theory.variance(StepNoise::white(RMS));
    let fine: Vec<f64> = (-95..=95).map(|i| f64::from(i) / 100.0).collect();
    let curve = fine.iter().map(|&c| noise(c).map_or(f64::NAN, |n| theory.variance(n) / white));
    let (at, growth): (Vec<f64>, Vec<f64>) =
        measured.iter().map(|(at, growth)| (at, growth / white)).unzip();
    let curve = curve.collect();
    [
        Series::new(format!("memory-{z}-predicted"))
            .with("correlation", "1", fine)
            .with("growth", "1", curve),
        Series::new(format!("memory-{z}")).with("correlation", "1", at).with("growth", "1", growth),
    ]
}
