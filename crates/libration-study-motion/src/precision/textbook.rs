//! The textbook form of Verlet in single precision: biased rounding.

use libration::integrator::{TextbookVerlet, VelocityVerlet};
use libration::{Float, Integrator, State};
use libration_report::Record;
use libration_report::notation::{count, seconds};
use libration_report::record::{Finding, Series, Table, Tolerance};
use libration_study::{Lab, StudyError, log_spaced_steps};

use super::in_float::InFloat;
use super::orbits::follow;
use super::types::ERRORS;
use super::verlet_run::closes;
use super::{tag, types};
use crate::precision::PrecisionSettings;

/// Samples of the drift for each decade of steps.
const PER_DECADE: f64 = 8.0;

/// How much of a bias may change along an orbit, as its energy does: a coordinate that passes a power of two rounds on
/// another grid from there on. Measured over starts within a thousandth: less than a fifth.
const CHANGE: f64 = 0.25;

/// Both forms at every time step in `f32`, and the cycle of the textbook's at the largest.
pub(super) fn measure(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let config = lab.config;
    let columns = ["Δt (s)", "form", "bias of a step (u)", "drift, predicted", "drift, measured"];
    let mut table = Table::new("two forms", &columns);
    let found = lab.sweep("two forms of Verlet", &config.get::<PrecisionSettings>().dt, |&dt| {
        Ok([
            of(lab, "textbook-verlet", TextbookVerlet, dt),
            of(lab, "velocity-verlet", VelocityVerlet, dt),
        ])
    })?;
    let settings = config.get::<PrecisionSettings>();
    let all = settings.dt.iter().zip(found);
    for (&dt, found) in all.flat_map(|(dt, forms)| forms.map(|form| (dt, form))) {
        let Some(form) = found else { continue };
        let title = if form.name == "textbook-verlet" { "textbook" } else { "kick–drift–kick" };
        table.push([
            dt.into(),
            title.into(),
            (form.bias / f32::UNIT_ROUNDOFF).into(),
            form.predicted.into(),
            form.rms.into(),
        ]);
        form.finding.into_iter().for_each(|finding| record.find(finding));
        record.series.push(form.series);
    }
    record.tables.push(table);
    let largest = config.get::<PrecisionSettings>().dt.last().copied();
    let one = largest.and_then(|dt| InFloat::<_, f32>::new(TextbookVerlet, config, dt));
    let closed = one.and_then(|one| closes(&one, config.get::<PrecisionSettings>().steps));
    types::cycle("textbook-verlet.f32", config.get::<PrecisionSettings>().steps, closed, record);
    Ok(())
}

/// Result of one form at one time step.
struct Form {
    name: &'static str,
    bias: f64,
    predicted: f64,
    rms: f64,
    /// None where steps do not round at random.
    finding: Option<Finding>,
    series: Series,
}

fn of<I: Integrator>(lab: &Lab<'_>, name: &'static str, method: I, dt: f64) -> Option<Form> {
    let (config, steps) = (lab.config, lab.config.get::<PrecisionSettings>().steps);
    let one = InFloat::<_, f32>::new(method, config, dt)?;
    let local = one.rounding::<f64>(lab.effort.choose(1_000_000, 4_000_000, 16_000_000))?;
    let sampled = log_spaced_steps(steps, PER_DECADE);
    let orbits = lab.effort.choose(8, 16, 64);
    let change = |from: &State<f32, 1>, to: &State<f32, 1>| one.change(from, to);
    let followed = follow(&one.starts(orbits), &sampled, |s| one.step(s), change);
    let at = |i: usize| followed.iter().map(move |orbit| orbit.seen[i]);
    let rms = |i: usize| (at(i).map(|d| d * d).sum::<f64>() / orbits as f64).sqrt();
    let last = sampled.len() - 1;
    let mean = at(last).sum::<f64>() / orbits as f64;
    let n = steps as f64;
    let (predicted, walk) = (local.bias() * n, (local.spread * n / orbits as f64).sqrt());
    let allowed = ERRORS * walk.hypot(local.mean_error * n) + CHANGE * predicted.abs();
    let finding = Finding::predicted(
        format!("precision.{name}.{}.mean", tag(dt)),
        format!(
            "{name} in f32 at Δt = {}: mean drift of {orbits} orbits after {} steps, beside n times \
             the bias of a step",
            seconds(dt, 3),
            count(steps)
        ),
        "1",
        predicted,
        mean,
        Tolerance::absolute(
            allowed,
            "four standard errors, of the mean of the orbits and of n times the bias, and a quarter \
             of that: the bias changes along the orbit",
        ),
    );
    let series = Series::new(format!("form-{name}-{}", tag(dt)))
        .with("step", "1", sampled.iter().map(|&n| n as f64).collect())
        .with("drift", "1", (0..sampled.len()).map(rms).collect())
        .with(
            "drift_predicted",
            "1",
            sampled.iter().map(|&n| local.drift_after(n as f64)).collect(),
        );
    let predicted = local.drift_after(n);
    let finding = one.rounds_at_random(f32::UNIT_ROUNDOFF).then_some(finding);
    Some(Form { name, bias: local.bias(), predicted, rms: rms(last), finding, series })
}
