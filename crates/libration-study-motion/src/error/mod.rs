//! The error relative to the exact solution, and the numbers of the source.

mod claims;
mod mean;
mod render;
mod rk4_mistakes;
mod run;
mod settings;
mod source_claims;

use libration_study::SourceClaim;

pub use self::settings::ErrorSettings;
use self::source_claims::SOURCE_CLAIMS;
use libration::{Method, State};
use libration_report::Record;
use libration_report::notation::{count, seconds};
use libration_report::page::Page;
use libration_report::record::{Finding, RecordError, Relation, Series, Table, Tolerance};
use libration_study::{Lab, Section, Study, StudyError};

use self::run::{Run, Setting};

/// The study `error`.
#[derive(Clone, Copy, Debug)]
pub struct Error;

/// Explanation of the bound on rounding, for the page.
const ROUNDING: &str = "the rounding of a run, as for its energy drift, and 8 roundings of the angle ωt for the \
                        rounded coefficients";

impl Study for Error {
    fn name(&self) -> &'static str {
        "error"
    }

    fn question(&self) -> &'static str {
        "How far from the exact solution is each method after a long run, and why?"
    }

    fn source_claims(&self) -> &'static [SourceClaim] {
        SOURCE_CLAIMS
    }

    fn settings(&self) -> Option<Section> {
        Some(Section::of::<ErrorSettings>())
    }

    fn run(&self, lab: &Lab<'_>) -> Result<Record, StudyError> {
        let mut record = Record::new(self.name(), self.question());
        horizon(lab, &mut record)?;
        steps(lab, &mut record)?;
        claims::judge(lab.config, &mut record);
        Ok(record)
    }

    fn render(&self, record: &Record, page: &mut Page) -> Result<(), RecordError> {
        render::render(record, page)
    }
}

fn setting(lab: &Lab<'_>, method: Method, dt: f64, steps: u64) -> Setting {
    let config = lab.config;
    Setting {
        method,
        oscillator: config.oscillator.system(),
        start: State { q: [config.start.q], v: [config.start.v] },
        dt,
        steps,
    }
}

/// Every method over the whole horizon, at the configured step.
fn horizon(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let config = lab.config;
    let (dt, steps) = (config.get::<ErrorSettings>().dt, config.get::<ErrorSettings>().steps);
    let settings: Vec<Setting> =
        config.integrators.iter().map(|&m| setting(lab, m, dt, steps)).collect();
    let what = format!("errors over {} steps", count(steps));
    let runs = lab.sweep(&what, &settings, Setting::run)?;
    let columns = [
        "integrator",
        "aligned, predicted (m)",
        "aligned, measured (m)",
        "late, predicted (m)",
        "late, measured (m)",
        "last (m)",
    ];
    let mut table = Table::new("errors", &columns);
    for run in &runs {
        let Some(forecast) = run.forecast.filter(|_| run.finished) else { continue };
        let [aligned, late] = [0, 1].map(|late| forecast.rms(steps, late).to_f64());
        for (kind, predicted, measured) in
            [("aligned", aligned, run.rms.aligned), ("late", late, run.rms.late)]
        {
            record.find(finding(run, kind, predicted, measured));
        }
        record.find(finding(run, "last", forecast.after(steps, 0).to_f64(), run.last));
        table.push([
            run.setting.method.title().into(),
            aligned.into(),
            run.rms.aligned.into(),
            late.into(),
            run.rms.late.into(),
            run.last.into(),
        ]);
    }
    record.tables.push(table);
    record.series.extend(runs.iter().map(series));
    if let Some(run) = runs.iter().find(|run| run.setting.method == Method::Rk4) {
        record.tables.push(rk4_mistakes::table(&run.setting));
    }
    if let Some(run) = runs.iter().find(|run| run.setting.method == Method::ExplicitEuler) {
        record.series.extend(amplitude(run)?);
    }
    Ok(())
}

fn finding(run: &Run, kind: &str, predicted: f64, measured: f64) -> Finding {
    let Setting { method, dt, steps, .. } = run.setting;
    let what = match kind {
        "aligned" => "RMS error in position, each state beside the solution at its own time",
        "late" => "RMS error in position, each state beside the solution one step before",
        _ => "error in position after the last step",
    };
    Finding::predicted(
        format!("error.{}.{kind}", method.name()),
        format!("{}, Δt = {}, {} steps: {what}", method.title(), seconds(dt, 3), count(steps)),
        "m",
        predicted,
        measured,
        Tolerance::absolute(run.setting.rounding(run.amplitude), ROUNDING),
    )
}

/// The running errors of a run, with their predictions.
fn series(run: &Run) -> Series {
    let Run { setting, sampled, running, .. } = run;
    let n = running.len();
    let predicted = |late: u64| -> Vec<f64> {
        let rms = |&steps: &u64| {
            run.forecast.map_or(f64::NAN, |forecast| forecast.rms(steps, late).to_f64())
        };
        sampled[..n].iter().map(rms).collect()
    };
    Series::new(format!("running-{}", setting.method.name()))
        .with("t", "s", sampled[..n].iter().map(|&i| i as f64 * setting.dt).collect())
        .with("aligned", "m", running.iter().map(|e| e.aligned).collect())
        .with("aligned_predicted", "m", predicted(0))
        .with("late", "m", running.iter().map(|e| e.late).collect())
        .with("late_predicted", "m", predicted(1))
}

/// Lowest and highest `x` in stretches of the horizon, with the exponential that the determinant
/// makes of the start.
fn amplitude(run: &Run) -> Result<Option<Series>, StudyError> {
    use libration::simulation::{Sample, Simulator};
    const STRETCHES: u64 = 600;
    let Setting { oscillator, start, dt, steps, .. } = run.setting;
    let omega2 = oscillator.omega2;
    let radius = start.q[0].hypot(start.v[0] / omega2.sqrt());
    let growth = (omega2 * dt * dt).ln_1p() / 2.0;
    // A stretch of less than a turn would miss the extremes.
    let turn = std::f64::consts::TAU / (omega2.sqrt() * dt);
    let stride = steps.div_ceil(STRETCHES).max(turn.ceil() as u64).max(1);
    let mut columns = [const { Vec::new() }; 4];
    let mut range = (0.0_f64, 0.0_f64);
    let mut watch = |sample: &Sample<f64, 1>| {
        let [x] = sample.state.q;
        range = (range.0.min(x), range.1.max(x));
        if sample.step > 0 && sample.step.is_multiple_of(stride) {
            let row = [sample.time, range.0, range.1, radius * (growth * sample.step as f64).exp()];
            columns.iter_mut().zip(row).for_each(|(column, x)| column.push(x));
            range = (x, x);
        }
    };
    let method = libration::integrator::ExplicitEuler;
    Simulator::new(oscillator, method, start, dt)?.run(steps, &mut watch).ok();
    let [t, low, high, bound] = columns;
    let series = Series::new("growth").with("t", "s", t).with("low", "m", low);
    Ok(run.finished.then(|| series.with("high", "m", high).with("bound", "m", bound)))
}

/// The error over the same time at other steps.
fn steps(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let config = lab.config;
    let time = config.get::<ErrorSettings>().dt * config.get::<ErrorSettings>().steps as f64;
    let omega = config.oscillator.omega();
    let points = lab.effort.choose(7, 13, 25);
    let dts: Vec<f64> = (0..points)
        .map(|i| {
            config.get::<ErrorSettings>().dt
                * 2_f64.powf(8.0 * f64::from(i) / f64::from(points - 1))
        })
        .filter(|dt| omega * dt < 1.5)
        .collect();
    let settings: Vec<Setting> = config
        .integrators
        .iter()
        .flat_map(|&m| {
            let of = move |&dt: &f64| setting(lab, m, dt, ((time / dt).round() as u64).max(1));
            dts.iter().map(of).collect::<Vec<_>>()
        })
        .collect();
    let runs = lab.sweep("errors at larger steps", &settings, Setting::run)?;
    for runs in runs.chunks(dts.len().max(1)) {
        let Some(first) = runs.first() else { continue };
        let mut worst = 0.0_f64;
        let mut columns = [const { Vec::new() }; 3];
        for run in runs {
            let predicted = run
                .forecast
                .filter(|_| run.finished)
                .map_or(f64::NAN, |f| f.rms(run.setting.steps, 0).to_f64());
            let measured = if run.finished { run.rms.aligned } else { f64::NAN };
            let row = [run.setting.dt, predicted, measured];
            columns.iter_mut().zip(row).for_each(|(column, x)| column.push(x));
            if predicted.is_finite() && measured.is_finite() {
                let allowed = run.setting.rounding(run.amplitude);
                worst = worst.max((measured - predicted).abs() / allowed);
            }
        }
        let method = first.setting.method;
        let [dt, predicted, measured] = columns;
        record.series.push(
            Series::new(format!("step-{}", method.name()))
                .with("dt", "s", dt)
                .with("predicted", "m", predicted)
                .with("measured", "m", measured),
        );
        record.find(Finding::related(
            format!("error.{}.steps", method.name()),
            format!(
                "{}: largest distance of the RMS error from its prediction at {} time steps over \
                 the same time, in units of the rounding that it may carry",
                method.title(),
                runs.len()
            ),
            "1",
            Relation::AtMost,
            1.0,
            worst,
            Tolerance::exact("the bound on rounding is the unit"),
        ));
    }
    Ok(())
}
