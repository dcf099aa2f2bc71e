//! Random walk of the phase, relative to nominal and to elapsed time.

use std::f64::consts::{PI, SQRT_2, TAU};

use libration::control::Jitter;
use libration::system::Oscillator;
use libration::{Method, State};
use libration_report::notation::count;
use libration_report::record::{Finding, Record, Series, Table, Tolerance};
use libration_study::{Lab, StudyError, log_spaced_steps};

use super::setting::{Setting, Theory};
use super::{free, start};
use crate::sample::{ERRORS, Sample};

/// Time steps and jitter of the phase runs.
const SETTINGS: [(Method, f64, f64); 4] = [
    (Method::VelocityVerlet, 0.001, 0.1),
    (Method::VelocityVerlet, 0.01, 0.01),
    (Method::SymplecticEuler, 0.1, 0.01),
    (Method::VelocityVerlet, 0.1, 0.01),
];

/// A deviation in rad at which hardly a phase is half a turn off: beyond it they cannot be told from others.
const WIDE_ENOUGH: f64 = 0.6;

/// Follows the phases.
pub(super) fn measure(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let known = SETTINGS.iter().filter(|(m, ..)| lab.config.integrators.contains(m));
    let settings: Vec<Setting> =
        known.map(|&(m, dt, rms)| Setting::new(lab.config, m, dt, rms)).collect();
    let runs = lab.sweep("phases", &settings, |setting| run(lab, setting))?;
    let columns = [
        "integrator",
        "Δt (s)",
        "σ",
        "steps",
        "against nominal time (rad)",
        "predicted (rad)",
        "against elapsed time (rad)",
        "predicted (rad)",
    ];
    let mut table = Table::new("phases under jitter", &columns);
    for run in runs.into_iter().flatten() {
        run.find(record, &mut table);
    }
    record.tables.push(table);
    Ok(())
}

/// Deviations of phases at some steps.
struct Run {
    setting: Setting,
    steps: Vec<f64>,
    nominal: Vec<Sample>,
    elapsed: Vec<Sample>,
    /// After one step, in theory: each grows with the root of the number of steps.
    predicted: [f64; 2],
    /// The contribution of the second derivative of the angle to that, as a deviation.
    bend: f64,
}

/// The part of a step over which differences of angles are taken; what is left out is the square of it.
const OFF: f64 = 1.0 / 1024.0;

/// How fast the angle follows the length of a step that is `ratio` times as long: a Gaussian ensemble falls to 1/e where its
/// phases are √2 rad wide.
fn speed(setting: &Setting, ratio: f64) -> Option<f64> {
    let setting = Setting { dt: setting.dt * ratio, ..*setting };
    let steps = setting.plant().dephasing_steps(Jitter::Gaussian(1.0))?;
    Some(SQRT_2 / steps.to_f64())
}

fn run(lab: &Lab<'_>, setting: &Setting) -> Result<Option<Run>, StudyError> {
    let Some(theory) = setting.theory() else { return Ok(None) };
    let speeds = [0.0, -OFF, OFF].map(|part| speed(setting, 1.0 + part));
    let [Some(speed), Some(below), Some(above)] = speeds else { return Ok(None) };
    let bend = ((above - below) / (2.0 * OFF) - speed).abs();
    let walk = speed * setting.rms;
    let most = (WIDE_ENOUGH / walk).powi(2) as u64;
    let last = most.min(lab.effort.choose(10_000, 1_000_000, 1_000_000)).max(1);
    let at = log_spaced_steps(last, 4.0);
    let count = lab.effort.choose(64, 64, 512);
    let seen = free(lab, setting, setting.model, &vec![start(lab); count], &at)?;
    // What moves freely goes as far as time does; the seed is the same, and so are its steps.
    let still = vec![State { q: [0.0], v: [1.0] }; count];
    let clocks = free(lab, setting, Oscillator { omega2: 0.0 }, &still, &at)?;
    let angle = theory.resonance.angle.to_f64();
    let first = theory.angle(&start(lab));
    let mut run = Run {
        setting: *setting,
        steps: at.iter().map(|&n| n as f64).collect(),
        nominal: Vec::new(),
        elapsed: Vec::new(),
        predicted: [walk, blur(&theory, setting.rms)],
        // The deviation of a square is √2 times its mean.
        bend: bend * setting.rms * setting.rms / SQRT_2,
    };
    for (seen, clocks) in seen.iter().zip(&clocks) {
        let steps = seen.step as f64;
        let ahead = |y: &State<f64, 1>| wrapped(theory.angle(y) - first - steps * angle);
        let nominal: Vec<f64> = seen.directions().iter().map(ahead).collect();
        let late = |clock: &State<f64, 1>| speed * (clock.q[0] / setting.dt - steps);
        let all = nominal.iter().zip(clocks.directions());
        let elapsed: Vec<f64> = all.map(|(ahead, clock)| ahead - late(clock)).collect();
        run.nominal.push(Sample::of(&nominal));
        run.elapsed.push(Sample::of(&elapsed));
    }
    Ok(Some(run))
}

/// What a step of another length does to the phase beside turning it further: as much as it does to the size, with the
/// cosine of twice the angle for the sine.
fn blur(theory: &Theory, rms: f64) -> f64 {
    theory.resonance.coupling.to_f64() * rms / SQRT_2
}

/// An angle between half a turn back and half a turn ahead.
fn wrapped(angle: f64) -> f64 {
    (angle + PI).rem_euclid(TAU) - PI
}

impl Run {
    fn find(self, record: &mut Record, table: &mut Table) {
        let Run { setting, steps, nominal, elapsed, predicted, bend } = self;
        let (Some(&n), Some(ahead), Some(left)) = (steps.last(), nominal.last(), elapsed.last())
        else {
            return;
        };
        let [walk, blur] = predicted.map(|one| one * n.sqrt());
        let after = format!("after {} steps", count(n as u64));
        let part = ERRORS * ahead.error_of_deviation();
        let why = "four standard errors of a deviation; theory is off by the square of the jitter";
        let tolerance = Tolerance::relative(part + setting.rms * setting.rms, why);
        let text = format!("standard deviation of the phase against nominal time {after}, zσ√n");
        let text = setting.text(&text);
        let (id, found) = (setting.id("phase-nominal"), ahead.deviation);
        record.find(Finding::predicted(id, text, "rad", walk, found, tolerance));
        // Turns must come round for the cosines to be independent.
        let turns = n * setting.model.omega2.sqrt() * setting.dt / PI;
        let text =
            format!("standard deviation of the phase against the time that has passed {after}");
        let text = setting.text(&text);
        let why = "four standard errors of a deviation, the part of a turn that is left over, the \
                   square of the jitter, and what the bend of the angle over the step adds";
        let part = part + 1.0 / turns + 2.0 * setting.rms;
        let tolerance = Tolerance::absolute(blur * part + bend * n.sqrt(), why);
        let (id, found) = (setting.id("phase-elapsed"), left.deviation);
        record.find(Finding::predicted(id, text, "rad", blur, found, tolerance));
        table.push([
            setting.method.title().into(),
            setting.dt.into(),
            setting.rms.into(),
            (n as u64).into(),
            ahead.deviation.into(),
            walk.into(),
            left.deviation.into(),
            blur.into(),
        ]);
        let deviations = |samples: &[Sample]| samples.iter().map(|s| s.deviation).collect();
        let rooted = |one: f64| steps.iter().map(|n| one * n.sqrt()).collect();
        record.series.push(
            Series::new(format!("phase-{}-{}", setting.method.name(), setting.dt))
                .with("nominal", "rad", deviations(&nominal))
                .with("nominal-predicted", "rad", rooted(predicted[0]))
                .with("elapsed", "rad", deviations(&elapsed))
                .with("elapsed-predicted", "rad", rooted(predicted[1]))
                .with("rms", "1", vec![setting.rms; steps.len()])
                .with("steps", "1", steps),
        );
    }
}
