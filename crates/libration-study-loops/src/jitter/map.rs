//! Growth over time step and jitter: of a free oscillator, and of one with a damper.

use libration::analysis::StepNoise;
use libration::control::clock::{Gaussian, Jittered};
use libration::control::controller::StateFeedback;
use libration::control::{Feedback, Jitter};
use libration::ensemble::{All, Setup};
use libration::integrator::VelocityVerlet;
use libration::system::BaselineOnly;
use libration::{Method, State};
use libration_report::record::{Finding, Record, Relation, Series, Tolerance};
use libration_study::{Lab, StudyError};

use super::margin::{margin, plant};
use super::setting::{FREE, Setting};
use super::{SEED, free, start};
use crate::loop_ensemble::{Snapshot, run_snapshots};
use crate::sample::Sample;

/// The ends of the map: `ωΔt`, and the standard deviation of a step.
const Z: [f64; 2] = [0.2, 1.95];
const RMS: [f64; 2] = [0.01, 0.3];

/// Growth in a step below which a run of a million steps keeps its energy within a factor e.
pub(super) const BOUNDED: f64 = 0.5e-6;

/// Part of the cells that may lie on the other side of a boundary: those which it cuts.
const CUT: f64 = 0.06;

/// Where the boundary of the damped loop is looked for, as `ωΔt`, and how often that is halved.
const BRACKET: [f64; 2] = [1.0, 1.95];
const BISECTIONS: u32 = 4;

/// `K_d` of the damper in units of `ω`.
const DAMPING: f64 = 0.06;

pub(super) fn damping(lab: &Lab<'_>) -> Feedback {
    Feedback { position: 0.0, velocity: DAMPING * lab.config.oscillator.omega() }
}

/// Runs the oscillator with its damper under jitter.
pub(super) fn damped(
    lab: &Lab<'_>,
    dt: f64,
    rms: f64,
    starts: &[State<f64, 1>],
    at: &[u64],
) -> Result<Vec<Snapshot>, StudyError> {
    let setup = Setup::new(All(BaselineOnly(lab.config.oscillator.system())), VelocityVerlet)
        .controller(StateFeedback::to_origin(damping(lab)))
        .clock(Jittered(Gaussian(rms)));
    run_snapshots(lab, setup, (dt, SEED), starts, at)
}

/// Measures both maps.
pub(super) fn measure(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    if !lab.config.integrators.contains(&Method::VelocityVerlet) {
        return Ok(());
    }
    let [columns, rows] = lab.effort.choose([12, 8], [36, 24], [72, 48]);
    let omega = lab.config.oscillator.omega();
    let dt: Vec<f64> = spread(Z, columns, false).iter().map(|z| z / omega).collect();
    let rms = spread(RMS, rows, true);
    let cells: Vec<(f64, f64)> =
        rms.iter().flat_map(|&rms| dt.iter().map(move |&dt| (dt, rms))).collect();
    let starts = vec![start(lab); 64];
    let steps = lab.effort.choose(400, 2000, 10_000);
    let found = lab.sweep("maps of growth", &cells, |&(dt, rms)| {
        let setting = Setting::new(lab.config, Method::VelocityVerlet, dt, rms);
        let size = |y: &State<f64, 1>| setting.model.omega2 * y.q[0] * y.q[0] + y.v[0] * y.v[0];
        let free = match setting.form() {
            None => f64::NAN,
            Some(form) => {
                let seen = free(lab, &setting, setting.model, &starts, &[steps])?;
                walk(&seen, |y| form.at(y), steps)
            }
        };
        let seen = damped(lab, dt, rms, &starts, &[steps / 2, steps])?;
        Ok([free, rate(&seen, size, steps)])
    })?;
    let [free, damped] = [0, 1].map(|i| found.iter().map(|f| f[i]).collect::<Vec<f64>>());
    let column = |i: usize| cells.iter().map(|&(dt, rms)| [dt, rms][i]).collect();
    let with = |name: &str, growth: Vec<f64>| {
        let cells = Series::new(name).with("dt", "s", column(0)).with("rms", "1", column(1));
        cells.with("growth", "1", growth)
    };
    let lines = lines(lab)?;
    if let Some(finding) = sides(&cells, &damped, &lines[1]) {
        record.find(finding);
    }
    record.series.push(with("map-free", free));
    record.series.push(with("map-damped", damped));
    record.series.extend(lines);
    Ok(())
}

/// Values from one end to the other.
fn spread([low, high]: [f64; 2], count: u32, log: bool) -> Vec<f64> {
    let share = |i: u32| f64::from(i) / f64::from(count - 1);
    let at = |s: f64| if log { low * (high / low).powf(s) } else { low + (high - low) * s };
    (0..count).map(|i| at(share(i))).collect()
}

/// `γ` from the variance of a walk, which shows it long before the mean does; where it has shown, from the mean.
fn walk(seen: &[Snapshot], size: impl Fn(&State<f64, 1>) -> f64, steps: u64) -> f64 {
    let Some(last) = seen.last() else { return f64::NAN };
    let ends = Sample::of(&last.logarithms(size).iter().map(|x| x / 2.0).collect::<Vec<_>>());
    let by_variance = ends.deviation.powi(2) / steps as f64;
    if by_variance * steps as f64 > 4.0 { ends.mean / steps as f64 } else { by_variance }
}

/// The mean growth of `ln |y|` in a step over the second half.
fn rate(seen: &[Snapshot], size: impl Fn(&State<f64, 1>) -> f64, steps: u64) -> f64 {
    let [middle, end] = seen else { return f64::NAN };
    let [middle, end] = [middle, end].map(|s| Sample::of(&s.logarithms(&size)).mean);
    (end - middle) / steps as f64
}

/// Boundaries in theory: where a free run of a million steps is no longer bounded, where the typical run of the damped loop
/// begins to grow, and where its mean square does.
fn lines(lab: &Lab<'_>) -> Result<[Series; 3], StudyError> {
    let omega = lab.config.oscillator.omega();
    let dt: Vec<f64> =
        spread(Z, lab.effort.choose(8, 16, 60), false).iter().map(|z| z / omega).collect();
    let found = lab.sweep("boundaries", &dt, |&dt| {
        let unit = Setting::new(lab.config, Method::VelocityVerlet, dt, 1.0);
        let resonance = unit.plant().resonance(FREE);
        let growth = resonance.map_or(f64::NAN, |r| r.weak_growth(StepNoise::white(1.0)));
        Ok([(BOUNDED / growth).sqrt(), margin(lab, dt).unwrap_or(f64::NAN)])
    })?;
    let rms = spread(RMS, lab.effort.choose(4, 7, 24), true);
    let typical = lab.sweep("where typical runs grow", &rms, |&rms| Ok(typical(lab, rms)))?;
    let line = |name: &str, dt: Vec<f64>, rms: Vec<f64>| {
        Series::new(name).with("dt", "s", dt).with("rms", "1", rms)
    };
    let of = |i: usize| found.iter().map(|f| f[i]).collect();
    Ok([
        line("boundary-free", dt.clone(), of(0)),
        line("boundary-typical", typical, rms),
        line("boundary-mean-square", dt, of(1)),
    ])
}

/// The time step at which the typical run of the damped loop begins to grow, where its Lyapunov exponent vanishes.
fn typical(lab: &Lab<'_>, rms: f64) -> f64 {
    // A step that no longer turns the state is beyond.
    let exponent = |dt: f64| {
        plant(lab, dt)
            .lyapunov_exponent(damping(lab), Jitter::Gaussian(rms))
            .unwrap_or(f64::INFINITY)
    };
    let [mut low, mut high] = BRACKET.map(|z| z / lab.config.oscillator.omega());
    let (mut falls, mut grows) = (exponent(low), exponent(high));
    if falls > 0.0 || grows <= 0.0 {
        return f64::NAN;
    }
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        match exponent(middle) {
            x if x > 0.0 => (high, grows) = (middle, x),
            x => (low, falls) = (middle, x),
        }
    }
    // The rest is nearly straight.
    if grows.is_finite() { low - falls * (high - low) / (grows - falls) } else { high }
}

/// How many cells of the map of the damped loop lie on the wrong side of its boundary.
fn sides(cells: &[(f64, f64)], growth: &[f64], line: &Series) -> Option<Finding> {
    let (x, y) = (line.column("dt").ok()?, line.column("rms").ok()?);
    let boundary = |rms: f64| {
        let i = y.windows(2).position(|pair| pair[0] <= rms && rms <= pair[1])?;
        let share = (rms / y[i]).ln() / (y[i + 1] / y[i]).ln();
        Some(x[i] + share * (x[i + 1] - x[i])).filter(|dt| dt.is_finite())
    };
    let sided = cells
        .iter()
        .zip(growth)
        .filter_map(|(&(dt, rms), growth)| Some((dt > boundary(rms)?) != (*growth > 0.0)));
    let wrong: Vec<bool> = sided.collect();
    let part = wrong.iter().filter(|&&wrong| wrong).count() as f64 / wrong.len().max(1) as f64;
    Some(Finding::related(
        "jitter.map.sides",
        "velocity Verlet with a damper: part of the cells of the map on the wrong side of the predicted boundary",
        "1",
        Relation::AtMost,
        0.0,
        part,
        Tolerance::absolute(
            CUT,
            "cells that the boundary cuts, where growth is smaller than it is known",
        ),
    ))
}
