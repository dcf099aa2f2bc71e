//! Growth over time step and jitter: of a free oscillator, and of one with a damper.

use libration::analysis::{Feedback, Jitter, StepNoise};
use libration::control::clock::{Gaussian, Jittered};
use libration::control::controller::StateFeedback;
use libration::ensemble::{All, Setup};
use libration::integrator::VelocityVerlet;
use libration::{Method, State};

use super::margin::{margin, plant};
use super::setting::Setting;
use super::{SEED, free, start};
use crate::Lab;
use crate::record::{Finding, Record, Relation, Series, Tolerance};
use crate::study::StudyError;
use crate::studies::sample::Sample;
use crate::studies::swarm::{Seen, follow};

/// The ends of the map: `ωΔt`, and the standard deviation of a step.
const Z: [f64; 2] = [0.2, 1.95];
const RMS: [f64; 2] = [0.01, 0.3];

/// Growth in a step below which a run of a million steps keeps its energy within a factor e.
pub(super) const BOUNDED: f64 = 0.5e-6;

/// Part of the cells that may lie on the other side of a boundary: those which it cuts.
const CUT: f64 = 0.06;

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
) -> Result<Vec<Seen>, StudyError> {
    let setup = Setup::new(All(lab.config.oscillator.system()), VelocityVerlet)
        .controller(StateFeedback::to_origin(damping(lab)))
        .clock(Jittered(Gaussian(rms)));
    follow(lab, setup, (dt, SEED), starts, at)
}

/// Measures both maps.
pub(super) fn measure(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    if !lab.config.integrators.contains(&Method::VelocityVerlet) {
        return Ok(());
    }
    let [columns, rows] = lab.effort.choose([14, 10], [36, 24], [72, 48]);
    let omega = lab.config.oscillator.omega();
    let dt: Vec<f64> = spread(Z, columns, false).iter().map(|z| z / omega).collect();
    let rms = spread(RMS, rows, true);
    let cells: Vec<(f64, f64)> =
        rms.iter().flat_map(|&rms| dt.iter().map(move |&dt| (dt, rms))).collect();
    let starts = vec![start(lab); 64];
    let steps = lab.effort.choose(500, 4000, 10_000);
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
    let lines = lines(lab, &rms)?;
    record.find(sides(&cells, &damped, &lines));
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
fn walk(seen: &[Seen], size: impl Fn(&State<f64, 1>) -> f64, steps: u64) -> f64 {
    let Some(last) = seen.last() else { return f64::NAN };
    let ends = Sample::of(&last.logarithms(size).iter().map(|x| x / 2.0).collect::<Vec<_>>());
    let by_variance = ends.deviation.powi(2) / steps as f64;
    if by_variance * steps as f64 > 4.0 { ends.mean / steps as f64 } else { by_variance }
}

/// The mean growth of `ln |y|` in a step over the second half.
fn rate(seen: &[Seen], size: impl Fn(&State<f64, 1>) -> f64, steps: u64) -> f64 {
    let [middle, end] = seen else { return f64::NAN };
    let [middle, end] = [middle, end].map(|s| Sample::of(&s.logarithms(&size)).mean);
    (end - middle) / steps as f64
}

/// Boundaries in theory, as the jitter at each time step: where a free run of a million steps is no longer bounded, where
/// the typical run of the damped loop begins to grow, and where its mean square does.
fn lines(lab: &Lab<'_>, rms: &[f64]) -> Result<[Series; 3], StudyError> {
    let omega = lab.config.oscillator.omega();
    let count = lab.effort.choose(12, 30, 60);
    let dt: Vec<f64> = spread(Z, count, false).iter().map(|z| z / omega).collect();
    let found = lab.sweep("boundaries", &dt, |&dt| {
        let unit = Setting::new(lab.config, Method::VelocityVerlet, dt, 1.0);
        let resonance = unit.plant().resonance(super::setting::FREE);
        let growth = resonance.map_or(f64::NAN, |r| r.weak_growth(StepNoise::white(1.0)));
        let few = (BOUNDED / growth).sqrt();
        Ok([few, typical(lab, dt, rms).unwrap_or(f64::NAN), margin(lab, dt).unwrap_or(f64::NAN)])
    })?;
    let names = ["boundary-free", "boundary-typical", "boundary-mean-square"];
    Ok([0, 1, 2].map(|i| {
        Series::new(names[i])
            .with("dt", "s", dt.clone())
            .with("rms", "1", found.iter().map(|f| f[i]).collect())
    }))
}

/// The jitter at which the typical run of the damped loop begins to grow, by bisection of the Lyapunov exponent.
fn typical(lab: &Lab<'_>, dt: f64, rms: &[f64]) -> Option<f64> {
    let plant = plant(lab, dt);
    let grows =
        |rms: f64| Some(plant.lyapunov_exponent(damping(lab), Jitter::Gaussian(rms))? > 0.0);
    let (mut low, mut high) = (*rms.first()?, *rms.last()?);
    if grows(low)? || !grows(high)? {
        return None;
    }
    // To a part of 2⁻⁷ of the map.
    for _ in 0..7 {
        let middle = (low * high).sqrt();
        if grows(middle)? { high = middle } else { low = middle }
    }
    Some((low * high).sqrt())
}

/// How many cells of the map of the damped loop lie on the wrong side of its boundary.
fn sides(cells: &[(f64, f64)], growth: &[f64], lines: &[Series; 3]) -> Finding {
    let line = lines[1].column("dt").ok().zip(lines[1].column("rms").ok());
    let boundary = |dt: f64| {
        let (x, y) = line?;
        let i = x.windows(2).position(|pair| pair[0] <= dt && dt <= pair[1])?;
        let share = (dt - x[i]) / (x[i + 1] - x[i]);
        let rms = y[i] + share * (y[i + 1] - y[i]);
        rms.is_finite().then_some(rms)
    };
    let sided = cells.iter().zip(growth).filter_map(|(&(dt, rms), growth)| {
        Some((rms > boundary(dt)?) != (*growth > 0.0))
    });
    let wrong: Vec<bool> = sided.collect();
    let part = wrong.iter().filter(|&&wrong| wrong).count() as f64 / wrong.len().max(1) as f64;
    Finding::related(
        "jitter.map.sides",
        "velocity Verlet with a damper: part of the cells of the map on the wrong side of the predicted boundary",
        "1",
        Relation::AtMost,
        0.0,
        part,
        Tolerance::absolute(CUT, "cells that the boundary cuts, where growth is smaller than it is known"),
    )
}
