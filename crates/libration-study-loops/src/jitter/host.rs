//! The effect of a measured clock on an oscillator.

use libration::analysis::{JitterMargin, Plant};
use libration::control::clock::Recorded;
use libration::control::{Feedback, Jitter};
use libration::ensemble::{All, Loops, Setup};
use libration::number::Wide;
use libration::system::BaselineOnly;
use libration::{Method, State};
use libration_logs::{StampOptions, Statistics, read_time_stamps};
use libration_report::notation::{count, number, seconds};
use libration_report::page::Page;
use libration_report::record::{Cell, Finding, Record, RecordError, Table, Tolerance};
use libration_study::{Lab, StudyError};

use super::setting::{Setting, Theory};
use super::{METHODS, start};
use crate::jitter::JitterSettings;

/// Starts all around the orbit.
const STARTS: usize = 64;

/// The name of the table.
const TABLE: &str = "the clock of this host";

/// The loop whose margin is told.
const GAINS: Feedback = Feedback { position: 10.0, velocity: 2.0 };

/// Measures what the time stamps of the configuration do, if there are any.
pub(super) fn measure(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let Some(path) = &lab.config.get::<JitterSettings>().time_stamps else { return Ok(()) };
    let wrong = |why: String| StudyError::Exact(format!("reading `{}`: {why}", path.display()));
    let stamps = read_time_stamps(path, &StampOptions::default()).map_err(wrong)?;
    let statistics = Statistics::of(&stamps, None);
    let steps: Vec<f64> =
        stamps.windows(2).map(|pair| (pair[1] - pair[0]) / statistics.mean).collect();
    let mut table = Table::new(TABLE, &["what", "value"]);
    let mut line = |what: &str, value: Cell| table.push([what.into(), value]);
    line("intervals", Cell::from(statistics.intervals as u64));
    line("mean interval (s)", statistics.mean.into());
    line("jitter, relative rms", statistics.jitter_rms.into());
    line("gaps above 1.5 periods", Cell::from(statistics.gaps as u64));
    line("repeated time stamps", Cell::from(statistics.repeats as u64));
    if let Some(&first) = statistics.correlation.first() {
        line("correlation of neighbours", first.into());
    }
    let plant = Plant::exact(lab.config.oscillator.system(), State::origin(), statistics.mean);
    line(
        "of the margin of a loop with the gains (10, 2), part used",
        match plant.jitter_margin(GAINS, Jitter::Gaussian) {
            JitterMargin::Rms(rms) => Cell::from(statistics.jitter_rms / rms),
            JitterMargin::Beyond(rms) => {
                Cell::absent(format!("below {}", number(statistics.jitter_rms / rms, 2)))
            }
            JitterMargin::Unstable => Cell::absent("unstable without it"),
        },
    );
    record.tables.push(table);
    let dt = 0.1 / lab.config.oscillator.omega();
    for method in METHODS.into_iter().filter(|method| *method != Method::Rk4) {
        if !lab.config.integrators.contains(&method) {
            continue;
        }
        let setting = Setting::new(lab.config, method, dt, statistics.jitter_rms);
        let Some(theory) = setting.theory() else { continue };
        let foretold = foretold(&theory, &steps);
        let measured = replayed(lab, &setting, &theory, &steps)?;
        let id = format!("jitter.host.{}", method.name());
        let text = format!(
            "{}, Δt = {}: over {} recorded steps, rms of ln E/E₀ over starts all around the orbit",
            method.title(),
            seconds(dt, 3),
            count(steps.len() as u64)
        );
        let why = "the formula is of first order in the logarithm and in the deviation; the mean of the starts adds a hundredth";
        let share = 0.02 + foretold + 3.0 * statistics.jitter_rms;
        let size = share * foretold + theory.unturned(statistics.jitter_rms);
        let tolerance = Tolerance::absolute(size, why);
        record.find(Finding::predicted(id, text, "1", foretold, measured, tolerance));
    }
    Ok(())
}

/// The rms of the logarithm of the form that steady steps carry along, over starts all around the orbit: to first order all that
/// counts of the steps is their Fourier component at twice the angle of a step.
fn foretold(theory: &Theory, steps: &[f64]) -> f64 {
    let [coupling, angle] = [theory.resonance.coupling, theory.resonance.angle].map(Wide::to_f64);
    let (mut re, mut im) = (0.0, 0.0);
    for (n, step) in steps.iter().enumerate() {
        let (sine, cosine) = (2.0 * angle * n as f64).sin_cos();
        re += (step - 1.0) * cosine;
        im += (step - 1.0) * sine;
    }
    // ln |y| changes by a·ε·sin 2(θn + φ), its square by twice that, and the mean of sin² is a half.
    2.0_f64.sqrt() * coupling.abs() * re.hypot(im)
}

/// The same of trajectories that take these steps.
fn replayed(
    lab: &Lab<'_>,
    setting: &Setting,
    theory: &Theory,
    steps: &[f64],
) -> Result<f64, StudyError> {
    let omega = setting.model.omega2.sqrt();
    let size = {
        let State { q: [q], v: [v] } = start(lab);
        q.hypot(v / omega)
    };
    let starts: Vec<State<f64, 1>> = (0..STARTS)
        .map(|i| {
            let (sine, cosine) = (std::f64::consts::TAU * i as f64 / STARTS as f64).sin_cos();
            State { q: [size * cosine], v: [size * omega * sine] }
        })
        .collect();
    let setup =
        Setup::new(All(BaselineOnly(setting.model)), setting.method).clock(Recorded::once(steps));
    let mut all = Loops::new(setup, setting.dt, 0, [0.0], &starts, lab.alone()?)?;
    let mut left = steps.len() as u64;
    while left > 0 {
        lab.check()?;
        let leg = left.min(1 << 16);
        all.advance(leg)?;
        left -= leg;
    }
    let square = |(n, start): (usize, &State<f64, 1>)| {
        let end = all.state(n).map_or(f64::NAN, |state| theory.form.at(&state));
        (end / theory.form.at(start)).ln().powi(2)
    };
    let squares: f64 = starts.iter().enumerate().map(square).sum();
    Ok((squares / STARTS as f64).sqrt())
}

/// Writes what was found, if there was a clock.
pub(super) fn render(record: &Record, page: &mut Page) -> Result<(), RecordError> {
    let Ok(table) = record.table(TABLE) else { return Ok(()) };
    page.heading("The clock of this host");
    page.paragraph(
        "Time stamps of a loop that ran, as `libration measure-jitter` writes them, replayed as the clock of an oscillator: to \
         first order the energy changes by what the recorded steps have at twice the angle of a step, and by nothing else.",
    );
    page.table(table, 4);
    Ok(())
}
