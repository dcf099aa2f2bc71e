//! The mean over an ensemble with different clocks.

use std::f64::consts::{E, SQRT_2};

use libration::State;
use libration::analysis::{QuadraticForm, UpdateMatrix};
use libration::control::Jitter;
use libration::integrator::VelocityVerlet;
use libration::number::Wide;
use libration_report::notation::count;
use libration_report::record::{Finding, Record, Series, Table, Tolerance};
use libration_study::{Lab, StudyError};

use super::{Clocks, DT, SEED, plant, run, start};
use crate::loop_ensemble::Snapshot;
use crate::sample::Sample;

/// The standard deviation of the rates.
const RMS: f64 = 0.01;

/// Where an ensemble with uneven steps is compared with one of different rates: `ωΔt`, and the deviation of both.
const COMPARED: (f64, f64) = (0.3, 0.05);

/// Parts of the time to 1/e at which means are compared with theory.
const PARTS: [f64; 6] = [0.1, 0.25, 0.5, 0.75, 1.0, 1.25];

/// Samples of the mean for each 1/e time.
const SAMPLES: u64 = 40;

/// One ensemble.
struct Ensemble {
    name: &'static str,
    title: &'static str,
    clocks: Clocks,
    dt: f64,
    /// The steps after which theory has its mean at 1/e.
    steps: f64,
    /// The mean as a part of its first amplitude after so many times to 1/e.
    falls: fn(f64) -> f64,
}

/// The mean over uniform rates, where `share` of the time to 1/e has passed: `sin y/y`, which is 1/e at the end of it.
fn sinc(share: f64) -> f64 {
    let mut x = 2.2;
    for _ in 0..40 {
        x -= (f64::sin(x) - x / E) / (f64::cos(x) - 1.0 / E);
    }
    let y = share * x;
    if y == 0.0 { 1.0 } else { y.sin() / y }
}

fn ensembles(lab: &Lab<'_>) -> Vec<Ensemble> {
    let steps = |dt: f64, law: Jitter| plant(lab, dt).dephasing_steps(law).map(|n| n.to_f64());
    let (z, rms) = COMPARED;
    let dt = z / lab.config.oscillator.omega();
    // How fast the angle follows the step: a Gaussian ensemble is at 1/e where its phases are √2 wide.
    let walk = steps(dt, Jitter::Gaussian(rms)).map(|n| SQRT_2 / n);
    let of = |name, title, clocks, dt, steps, falls| {
        Some(Ensemble { name, title, clocks, dt, steps: steps?, falls })
    };
    let skewed = Clocks::skewed;
    let gaussian: fn(f64) -> f64 = |t| (-t * t).exp();
    let laws = [Jitter::Gaussian(RMS), Jitter::Uniform(RMS)];
    [
        of("gaussian", "Gaussian rates", skewed(laws[0]), DT, steps(DT, laws[0]), gaussian),
        of("uniform", "uniform rates", skewed(laws[1]), DT, steps(DT, laws[1]), sinc),
        of(
            "rates",
            "Gaussian rates, 5 %",
            skewed(Jitter::Gaussian(rms)),
            dt,
            steps(dt, Jitter::Gaussian(rms)),
            gaussian,
        ),
        of(
            "jitter",
            "independent jitter, 5 %",
            Clocks::jittered(rms),
            dt,
            walk.map(|walk| 2.0 / (walk * walk)),
            |t| (-t).exp(),
        ),
    ]
    .into_iter()
    .flatten()
    // As long as phases are followed over fewer steps than anybody waits for.
    .filter(|e| e.steps > 20.0 && e.steps < 2e5)
    .collect()
}

/// Follows all ensembles.
pub(super) fn measure(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let all = ensembles(lab);
    let trajectories = lab.effort.choose(1024, 4096, 16_384);
    let starts = vec![start(lab); trajectories];
    let found = lab.sweep("ensembles that fall apart", &all, |ensemble| {
        let regular = (1..=SAMPLES * 3 / 2).map(|i| ensemble.steps * i as f64 / SAMPLES as f64);
        let parts = PARTS.iter().map(|part| part * ensemble.steps);
        let mut at: Vec<u64> = regular.chain(parts).map(|n| n.round() as u64).collect();
        at.sort_unstable();
        at.dedup();
        let model = lab.config.oscillator.system();
        run(lab, model, ensemble.clocks, (ensemble.dt, SEED), &starts, &at)
    })?;
    let columns = ["clocks", "Δt (s)", "steps to 1/e", "predicted"];
    let mut table = Table::new("falling apart", &columns);
    let mut times = Vec::new();
    for (ensemble, seen) in all.iter().zip(&found) {
        if ensemble.clocks.jitter == 0.0 {
            means(lab, ensemble, seen, record);
        }
        let amplitudes = amplitudes(lab, ensemble, seen);
        if let Some(time) = crossing(&amplitudes) {
            let known = 3.0 * E / (2.0 * trajectories as f64).sqrt();
            record.find(Finding::predicted(
                format!("asynchrony.{}.steps", ensemble.name),
                format!(
                    "{}, Δt = {:.4} s: steps until the amplitude of the mean over {} trajectories is 1/e",
                    ensemble.title,
                    ensemble.dt,
                    count(trajectories as u64)
                ),
                "steps",
                ensemble.steps,
                time,
                Tolerance::relative(
                    known + RMS,
                    "three standard errors of the mean, which falls at least as fast as 1/t there, and what is \
                     left out of the angle’s dependence on the step",
                ),
            ));
            times.push((ensemble.name, time));
            table.push([
                ensemble.title.into(),
                ensemble.dt.into(),
                time.into(),
                ensemble.steps.into(),
            ]);
        }
        record.series.push(series(ensemble, &amplitudes));
    }
    let time = |name: &str| times.iter().find(|(n, _)| *n == name).map(|(_, time)| *time);
    if let Some((jitter, rates)) = time("jitter").zip(time("rates")) {
        record.find(Finding::measured(
            "asynchrony.jitter.slower",
            "how many times as long independent jitter takes as rates that differ by as much",
            "1",
            jitter / rates,
        ));
    }
    record.tables.push(table);
    Ok(())
}

/// Means at some steps, beside theory.
fn means(lab: &Lab<'_>, ensemble: &Ensemble, seen: &[Snapshot], record: &mut Record) {
    let plant = plant(lab, ensemble.dt);
    for part in PARTS {
        let steps = (part * ensemble.steps).round() as u64;
        let Some(seen) = seen.iter().find(|s| s.step == steps) else { continue };
        let found = Sample::of(&seen.directions().iter().map(|y| y.q[0]).collect::<Vec<_>>());
        let wanted = plant.asynchronous_mean(&start(lab), ensemble.clocks.skew, steps).q[0];
        record.find(Finding::predicted(
            format!("asynchrony.{}.mean-{part}", ensemble.name),
            format!(
                "{}, Δt = {:.4} s: mean position after {} steps, {part} of the time to 1/e",
                ensemble.title,
                ensemble.dt,
                count(steps)
            ),
            "m",
            wanted,
            found.mean,
            Tolerance::absolute(3.0 * found.error(), "three standard errors of the mean"),
        ));
    }
}

/// Steps, and the amplitude of the mean as a part of the first.
fn amplitudes(lab: &Lab<'_>, ensemble: &Ensemble, seen: &[Snapshot]) -> Vec<(f64, f64)> {
    let model = lab.config.oscillator.system();
    let step = UpdateMatrix::of_step(VelocityVerlet, model, &State::origin(), ensemble.dt);
    let form = QuadraticForm::carried_by(&step).map(Wide::to_f64);
    let first = form.at(&start(lab));
    let amplitude = |seen: &Snapshot| {
        let states = seen.directions();
        let mean = |of: fn(&State<f64, 1>) -> f64| {
            states.iter().map(of).sum::<f64>() / states.len() as f64
        };
        let mean = State { q: [mean(|y| y.q[0])], v: [mean(|y| y.v[0])] };
        (seen.step as f64, (form.at(&mean) / first).sqrt())
    };
    seen.iter().map(amplitude).collect()
}

/// Returns the step at which the amplitude first falls below 1/e.
fn crossing(amplitudes: &[(f64, f64)]) -> Option<f64> {
    let pairs = amplitudes.windows(2).find(|pair| pair[1].1 < 1.0 / E)?;
    let [(n, a), (m, b)] = [pairs[0], pairs[1]];
    Some(n + (m - n) * (a - 1.0 / E) / (a - b))
}

fn series(ensemble: &Ensemble, amplitudes: &[(f64, f64)]) -> Series {
    let (steps, measured): (Vec<f64>, Vec<f64>) = amplitudes.iter().copied().unzip();
    let predicted = steps.iter().map(|n| (ensemble.falls)(n / ensemble.steps)).map(f64::abs);
    let predicted = predicted.collect();
    Series::new(format!("mean-{}", ensemble.name))
        .with("steps", "1", steps)
        .with("measured", "1", measured)
        .with("predicted", "1", predicted)
}
