//! Every float type over the whole horizon.

use libration_report::Record;
use libration_report::notation::count;
use libration_report::record::{Cell, Finding, Series, Table, Tolerance};
use libration_study::{Lab, StudyError};

use super::float_type::FLOAT_TYPES;
use super::verlet_run::{Closed, VerletRun};
use crate::precision::PrecisionSettings;

/// Standard errors that a measurement may be off by: by chance one in 16 000 is.
pub(super) const ERRORS: f64 = 4.0;

/// Follows orbits in every type, and sets what rounding left beside what it must.
pub(super) fn measure(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let steps = lab.config.get::<PrecisionSettings>().steps;
    let what = format!("float types over {} steps", count(steps));
    let found = lab.sweep(&what, FLOAT_TYPES, |kind| Ok((kind.run)(lab, kind)))?;
    let columns = [
        "float",
        "bits",
        "rounding of a step (u)",
        "drift, predicted",
        "drift, measured",
        "orbits that repeat",
        "pre-period",
        "period",
        "largest drift of an endless run",
    ];
    let mut table = Table::new("float types", &columns);
    for (kind, trial) in FLOAT_TYPES.iter().zip(&found) {
        let Some(trial) = trial else {
            let missing = || Cell::absent("—");
            let row = [Cell::from(kind.name), u64::from(kind.bits).into()];
            table.push(row.into_iter().chain((0..7).map(|_| missing())));
            continue;
        };
        brouwer(trial, record);
        cycle(trial.name, steps, trial.closed, record);
        table.push(row(trial, steps));
    }
    record.tables.push(table);
    let trials: Vec<&VerletRun> = found.iter().flatten().collect();
    for trial in &trials {
        record.series.push(series(trial));
    }
    record.series.push(by_bits(&trials, steps));
    Ok(())
}

/// The drift after `n` steps that roundings leave if they are independent.
fn independent(trial: &VerletRun, n: u64) -> f64 {
    trial.local.map_or(f64::NAN, |local| (local.spread * n as f64).sqrt())
}

/// Mean and scatter of the drifts, as far as roundings are independent.
fn brouwer(trial: &VerletRun, record: &mut Record) {
    let (Some(n), Some(local)) = (trial.comparable, trial.local) else { return };
    let Some(i) = trial.sampled.iter().position(|&sampled| sampled == n) else { return };
    let (mean, scatter) = trial.moments(i);
    let (walk, orbits) = (independent(trial, n), trial.count() as f64);
    let relative = ERRORS / (2.0 * (orbits - 1.0)).sqrt();
    let after = format!("after {} steps over {} orbits", count(n), trial.count());
    record.find(Finding::predicted(
        format!("precision.{}.scatter", trial.name),
        format!(
            "{}: scatter of what velocity Verlet conserves, {after}, beside √n of the rounding of \
             single steps",
            trial.name
        ),
        "1",
        walk,
        scatter,
        Tolerance::relative(
            relative + 0.1,
            "4/√(2(m − 1)) is four standard errors of the scatter of m orbits; a tenth for what is \
             left in common of roundings, and for the prediction, which is an average, too",
        ),
    ));
    record.find(Finding::predicted(
        format!("precision.{}.mean", trial.name),
        format!("{}: mean of the same, {after}, beside n times the bias of a step", trial.name),
        "1",
        local.bias() * n as f64,
        mean,
        Tolerance::absolute(
            ERRORS * (walk / orbits.sqrt()).hypot(local.mean_error * n as f64),
            "four standard errors, of the mean of the orbits and of n times the bias",
        ),
    ));
}

/// The orbit that was closed is where its cycle says.
pub(super) fn cycle(name: &str, steps: u64, closed: Option<Closed>, record: &mut Record) {
    let Some(Closed { cycle, last: [predicted, measured], .. }) = closed else { return };
    record.find(Finding::predicted(
        format!("precision.{name}.closed"),
        format!(
            "{name}: drift from the configured start after {} steps, by the cycle of {} steps that \
             begins at step {}, and by taking every step",
            count(steps),
            count(cycle.period),
            count(cycle.pre_period)
        ),
        "1",
        predicted,
        measured,
        Tolerance::exact("a state that comes back to the bit goes the same way again"),
    ));
    for (what, size) in [("pre-period", cycle.pre_period), ("period", cycle.period)] {
        record.find(Finding::measured(
            format!("precision.{name}.{what}"),
            format!("{name}: {what} of the configured orbit, found to the bit"),
            "steps",
            size as f64,
        ));
    }
}

fn row(trial: &VerletRun, steps: u64) -> Vec<Cell> {
    let roundings = trial.local.map(|local| local.spread.sqrt() / trial.unit_roundoff);
    let closed =
        |f: fn(&Closed) -> Cell| trial.closed.as_ref().map_or_else(|| Cell::absent("—"), f);
    let predicted = trial.local.map(|_| independent(trial, steps));
    vec![
        trial.name.into(),
        u64::from(trial.bits).into(),
        roundings.into(),
        match trial.comparable {
            Some(n) if n == steps => predicted.into(),
            _ => Cell::absent("closes"),
        },
        trial.last_rms().into(),
        Cell::from(format!("{} of {}", trial.repeating(), trial.count())),
        closed(|c| c.cycle.pre_period.into()),
        closed(|c| c.cycle.period.into()),
        closed(|c| c.largest.into()),
    ]
}

/// The drift against the number of steps.
fn series(trial: &VerletRun) -> Series {
    let steps = &trial.sampled;
    Series::new(format!("type-{}", trial.name))
        .with("step", "1", steps.iter().map(|&n| n as f64).collect())
        .with("drift", "1", (0..steps.len()).map(|i| trial.rms(i)).collect())
        .with("drift_predicted", "1", steps.iter().map(|&n| independent(trial, n)).collect())
        .with("comparable", "1", {
            let last = trial.comparable.unwrap_or(0);
            steps.iter().map(|&n| f64::from(u8::from(n <= last))).collect()
        })
}

/// The drift after all steps against the bits of the significand.
fn by_bits(trials: &[&VerletRun], steps: u64) -> Series {
    let of = |f: &dyn Fn(&VerletRun) -> f64| trials.iter().map(|trial| f(trial)).collect();
    Series::new("bits")
        .with("bits", "1", of(&|t| f64::from(t.bits)))
        .with("compensated", "1", of(&|t| f64::from(u8::from(t.name == "f32-compensated"))))
        .with("drift", "1", of(&|t| t.last_rms()))
        .with("drift_predicted", "1", of(&|t| independent(t, steps)))
}
