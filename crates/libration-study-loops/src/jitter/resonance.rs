//! Periodic jitter: parametric resonance at twice the angle of a step.

use std::f64::consts::{SQRT_2, TAU};

use libration::analysis::StepNoise;
use libration::control::clock::Sinusoidal;
use libration::ensemble::{All, Setup};
use libration::integrator::SymplecticEuler;
use libration::system::BaselineOnly;
use libration::{Method, State};
use libration_report::record::{Finding, Record, Series, Tolerance};
use libration_study::{Lab, StudyError};

use super::SEED;
use super::setting::{FREE, Setting, Theory};
use crate::loop_ensemble::run_snapshots;

/// `ωΔt`.
const Z: f64 = 0.95;

const RMS: f64 = 0.05;

/// Steps to a period of the swings that are tried, or to a whole number of them.
const PERIOD: u64 = 1024;

/// Periods of [`PERIOD`] steps on either side of the resonance.
const ASIDE: u64 = 10;

/// Of these a finding is made of the resonance, of those so far from it, and of the outermost.
const INSIDE: u64 = 2;

/// Beyond this logarithm of a size only the fastest direction is left.
const SETTLED: f64 = 20.0;

/// Measures growth over the frequency of the swing.
pub(super) fn measure(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let dt = Z / lab.config.oscillator.omega();
    let setting = Setting::new(lab.config, Method::SymplecticEuler, dt, RMS);
    let Some(theory) = setting.theory() else { return Ok(()) };
    if !lab.config.integrators.contains(&setting.method) {
        return Ok(());
    }
    let resonant = 2.0 * theory.resonance.angle.to_f64() / TAU * PERIOD as f64;
    let nearest = resonant.round() as u64;
    let turns: Vec<u64> = (nearest - ASIDE..=nearest + ASIDE).collect();
    let half = PERIOD * lab.effort.choose(4, 8, 32);
    let found = lab.sweep("parametric resonance", &turns, |&turns| {
        let wave = |n: u64| (TAU * (turns * n % PERIOD) as f64 / PERIOD as f64).sin();
        let ratios: Vec<f64> = (0..PERIOD).map(|n| 1.0 + SQRT_2 * RMS * wave(n)).collect();
        let radius = setting.plant().periodic_radius(FREE, &ratios);
        Ok((radius.ln().to_f64(), growth(lab, &setting, &theory, rate(turns), half)?))
    })?;
    let mid = theory.resonance.resonance_growth(RMS);
    for (turns, (predicted, measured)) in turns.iter().zip(&found) {
        let name = match (turns.abs_diff(nearest), *turns < nearest) {
            (0, _) => "at",
            (INSIDE, true) => "just-below",
            (INSIDE, false) => "just-above",
            (ASIDE, true) => "below",
            (ASIDE, false) => "above",
            _ => continue,
        };
        let ratio = rate(*turns) / (2.0 * theory.resonance.angle.to_f64());
        let tolerance = match predicted * half as f64 > SETTLED {
            true => Tolerance::absolute(
                f64::EPSILON * (turns * half) as f64,
                "rounding of the phase of the swing; all but the fastest direction is e⁻²⁰ of the state",
            ),
            false => Tolerance::absolute(
                5.0 / half as f64,
                "beside the resonance ln |y| swings, by less than 5",
            ),
        };
        record.find(Finding::predicted(
            format!("jitter.resonance.{name}"),
            format!(
                "symplectic Euler, ωΔt = {Z}, σ = 5 %, a sine of {ratio:.3} times twice the angle of a step: growth of \
                 ln |y| in a step"
            ),
            "1",
            *predicted,
            *measured,
            tolerance,
        ));
    }
    if let Some((_, peak)) = found.get(ASIDE as usize) {
        record.find(Finding::predicted(
            "jitter.resonance.weak",
            "the same at the resonance, beside aσ/√2",
            "1",
            mid,
            *peak,
            Tolerance::relative(
                2.0 * RMS + (rate(1) / 4.0 / mid).powi(2),
                "the next term of the jitter, and the square of what is left to the nearest of 1024 frequencies",
            ),
        ));
        let white = theory.rate;
        record.find(Finding::measured(
            "jitter.resonance.beside-white",
            "growth under a sine at the resonance, in units of that under white jitter of the same σ",
            "1",
            peak / white,
        ));
    }
    record.series.extend(series(&turns, &found, &theory));
    Ok(())
}

/// Radians a step of a swing with so many turns in [`PERIOD`] steps.
fn rate(turns: u64) -> f64 {
    TAU * turns as f64 / PERIOD as f64
}

/// The growth of `ln |y|` in a step, of the start that grows most.
fn growth(
    lab: &Lab<'_>,
    setting: &Setting,
    theory: &Theory,
    rate: f64,
    half: u64,
) -> Result<f64, StudyError> {
    let omega = setting.model.omega2.sqrt();
    let around = (0..8).map(|i| (TAU * f64::from(i) / 16.0).sin_cos());
    let starts: Vec<_> = around.map(|(v, q)| State { q: [q], v: [v * omega] }).collect();
    let clock = Sinusoidal { rms: RMS, rate, phase: 0.0 };
    let setup = Setup::new(All(BaselineOnly(setting.model)), SymplecticEuler).clock(clock);
    let seen = run_snapshots(lab, setup, (setting.dt, SEED), &starts, &[half, 2 * half])?;
    let sizes: Vec<Vec<f64>> = seen.iter().map(|s| s.logarithms(|y| theory.form.at(y))).collect();
    let [middle, end] = &sizes[..] else { return Ok(f64::NAN) };
    let growths = middle.iter().zip(end).map(|(a, b)| (b - a) / 2.0 / half as f64);
    Ok(growths.fold(f64::NEG_INFINITY, f64::max))
}

fn series(turns: &[u64], found: &[(f64, f64)], theory: &Theory) -> [Series; 2] {
    let middle = 2.0 * theory.resonance.angle.to_f64();
    let (peak, white) = (
        theory.resonance.resonance_growth(RMS),
        theory.resonance.weak_growth(StepNoise::white(RMS)),
    );
    let at: Vec<f64> = turns.iter().map(|&t| rate(t)).collect();
    // The averaged equation of the resonance: the size grows by √(g² − δ²) where half the detuning is δ.
    let reach = (rate(ASIDE) * 1.05).max(4.0 * peak);
    let fine: Vec<f64> = (-200..=200).map(|i| middle + reach * f64::from(i) / 200.0).collect();
    let weak = |psi: &f64| (peak * peak - (psi - middle).powi(2) / 4.0).max(0.0).sqrt();
    let weak = fine.iter().map(weak).collect();
    let count = at.len();
    [
        Series::new("resonance")
            .with("rate", "rad", at)
            .with("predicted", "1", found.iter().map(|(p, _)| *p).collect())
            .with("measured", "1", found.iter().map(|(_, m)| *m).collect())
            .with("white", "1", vec![white; count])
            .with("twice-angle", "rad", vec![middle; count]),
        Series::new("resonance-weak").with("rate", "rad", fine).with("growth", "1", weak),
    ]
}
