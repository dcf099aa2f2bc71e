//! The study `adaptive`: steps that follow the motion, with and without reversibility.

mod orbit_run;
mod render;
mod settings;

use libration_analyze::adaptive::StepControl;
use libration_report::Record;
use libration_report::notation::count;
use libration_report::page::Page;
use libration_report::record::{Finding, RecordError, Relation, Series, Table, Tolerance};
use libration_study::{Fit, Lab, Section, Study, StudyError};

use self::orbit_run::{
    Ellipse, EnergyErrors, Steps, energy_errors, return_error, return_error_on_grid,
};
pub use self::settings::AdaptiveSettings;

/// The study `adaptive`.
#[derive(Clone, Copy, Debug)]
pub struct Adaptive;

impl Study for Adaptive {
    fn name(&self) -> &'static str {
        "adaptive"
    }

    fn question(&self) -> &'static str {
        "Which adaptive steps keep the energy on an eccentric orbit?"
    }

    fn settings(&self) -> Option<Section> {
        Some(Section::of::<AdaptiveSettings>())
    }

    fn run(&self, lab: &Lab<'_>) -> Result<Record, StudyError> {
        let mut record = Record::new(self.name(), self.question());
        let settings = lab.config.get::<AdaptiveSettings>();
        let cases: Vec<Case> = settings
            .eccentricities
            .iter()
            .flat_map(|&eccentricity| {
                Steps::ALL.map(|steps| Case { ellipse: Ellipse { eccentricity }, steps })
            })
            .collect();
        long_runs(lab, &settings, &cases, &mut record)?;
        orders(lab, &settings, &cases, &mut record)?;
        returns(lab, &settings, &cases, &mut record)?;
        Ok(record)
    }

    fn render(&self, record: &Record, page: &mut Page) -> Result<(), RecordError> {
        render::render(record, page)
    }
}

/// Steps of one kind on an orbit.
#[derive(Clone, Copy, Debug)]
struct Case {
    ellipse: Ellipse,
    steps: Steps,
}

impl Case {
    fn id(&self, quantity: &str) -> String {
        format!("adaptive.{}.{}.{quantity}", self.ellipse.eccentricity, self.steps.name())
    }

    fn text(&self, what: &str) -> String {
        format!("e = {}, {} steps: {what}", self.ellipse.eccentricity, self.steps.name())
    }

    fn series(&self, what: &str) -> String {
        format!("{what}-{}-{}", self.ellipse.eccentricity, self.steps.name())
    }
}

/// The energy over many periods.
fn long_runs(
    lab: &Lab<'_>,
    settings: &AdaptiveSettings,
    cases: &[Case],
    record: &mut Record,
) -> Result<(), StudyError> {
    let per_period = settings.steps as f64;
    let periods = (settings.periods / lab.effort.choose(10, 1, 1)).max(100);
    let what = format!("energy over {} periods", count(periods));
    let runs = lab.sweep(&what, cases, |case| {
        Ok(energy_errors(case.ellipse, case.steps, per_period, periods))
    })?;
    let columns =
        ["eccentricity", "steps", "steps a period", "largest in the first tenth", "largest in all"];
    let mut table = Table::new("energies", &columns);
    for (case, run) in cases.iter().zip(&runs) {
        let done = run.means.len();
        let largest = |part: &[f64]| part.iter().copied().fold(0.0, f64::max);
        let (tenth, all) = (largest(&run.largest[..done.div_ceil(10)]), largest(&run.largest));
        let measured = run.steps as f64 / done.max(1) as f64;
        table.push([
            case.ellipse.eccentricity.into(),
            case.steps.name().into(),
            measured.into(),
            tenth.into(),
            all.into(),
        ]);
        if case.steps.is_reversible_and_adaptive() {
            record.find(steps_of_a_period(case, run, per_period, all));
            record.find(bounded(case, run, tenth, all));
        } else {
            let what = format!("largest relative error of the energy over {}", count(periods));
            let text = case.text(&(what + " periods"));
            record.find(Finding::measured(case.id("largest"), text, "1", all));
        }
        record.series.push(shown(case, run));
    }
    record.tables.push(table);
    Ok(())
}

/// The steps of a period against the integral of the local frequency.
fn steps_of_a_period(case: &Case, run: &EnergyErrors, per_period: f64, error: f64) -> Finding {
    let measured = run.steps as f64 / run.means.len().max(1) as f64;
    // Steps at the pericentre over those of a mean time.
    let peak = std::f64::consts::TAU / case.ellipse.steps_for_a_first_step_of_one();
    Finding::predicted(
        case.id("steps"),
        case.text(
            "steps a period, predicted by the integral of the local frequency over the orbit",
        ),
        "1",
        per_period,
        measured,
        Tolerance::relative(
            2.0 * error
                + (1.5 * error * peak).min(1.0 / run.means.len().max(1) as f64)
                + 2.0 / per_period,
            "by Kepler's third law a relative error of the energy changes the period by 3/2 of it, and the local frequency with the size of the orbit: at most twice the energy error; what this shifts over all periods may be steps at the pericentre, at most those of a period; and a step at either end",
        ),
    )
}

/// The largest error of the energy in the first tenth of the run against that in the rest.
fn bounded(case: &Case, run: &EnergyErrors, tenth: f64, all: f64) -> Finding {
    let all = if run.is_complete { all } else { f64::NAN };
    Finding::related(
        case.id("bounded"),
        case.text("largest relative error of the energy in the whole run; the bound is that of its first tenth"),
        "1",
        Relation::AtMost,
        tenth,
        all,
        Tolerance::relative(
            0.1,
            "a reversible step has no drift; the largest error depends on where near the pericentre a step falls",
        ),
    )
}

/// The largest errors of periods, at periods that are evenly spread on a logarithmic axis.
fn shown(case: &Case, run: &EnergyErrors) -> Series {
    let mut periods: Vec<usize> = (0..120)
        .map(|i| ((run.largest.len() as f64).powf(f64::from(i) / 119.0).round() as usize).max(1))
        .collect();
    periods.dedup();
    periods.retain(|&period| period <= run.largest.len());
    let largest = |&period: &usize| run.largest[period - 1];
    Series::new(case.series("energy"))
        .with("period", "", periods.iter().map(|&period| period as f64).collect())
        .with("largest", "", periods.iter().map(largest).collect())
}

/// How the energy error depends on the step.
fn orders(
    lab: &Lab<'_>,
    settings: &AdaptiveSettings,
    cases: &[Case],
    record: &mut Record,
) -> Result<(), StudyError> {
    let halvings = lab.effort.choose(6, 7, 8);
    let found = lab.sweep("energy at ever smaller steps", cases, |case| {
        Ok((0..halvings)
            .map(|i| {
                let per_period = settings.steps as f64 * f64::from(1 << i);
                let run = energy_errors(case.ellipse, case.steps, per_period, 3);
                let [_, second, third] = run.means[..] else { return [f64::NAN; 3] };
                let largest = run.largest.iter().copied().fold(0.0, f64::max);
                [1.0 / per_period, largest, (third - second).abs()]
            })
            .collect::<Vec<_>>())
    })?;
    for (case, points) in cases.iter().zip(found) {
        let column = |i: usize| points.iter().map(|point| point[i]).collect::<Vec<f64>>();
        let (dt, largest, drift) = (column(0), column(1), column(2));
        let mut exponent = |quantity: &str, what: &str, order: f64, sizes: &[f64]| {
            if let Some(fit) = Fit::new(&dt, sizes) {
                record.find(Finding::predicted(
                    case.id(quantity),
                    case.text(what),
                    "1",
                    order,
                    fit.exponent,
                    fit.tolerance(),
                ));
            }
        };
        if case.steps.is_reversible_and_adaptive() {
            let what = "exponent of the step in the largest energy error of a period";
            exponent("order", what, 2.0, &largest);
        }
        if case.steps == Steps::Adaptive(StepControl::Naive) {
            // An error of the length of a step that is not symmetric is of order 2, that of the energy in a step of order 3: their product
            // does not cancel over an orbit. Summed over 1/Δt steps it leaves an even power less.
            let what =
                "exponent of the step in the change of the mean energy from period to period";
            exponent("drift-order", what, 3.0, &drift);
        }
    }
    Ok(())
}

/// Motions there and back.
fn returns(
    lab: &Lab<'_>,
    settings: &AdaptiveSettings,
    cases: &[Case],
    record: &mut Record,
) -> Result<(), StudyError> {
    let per_period = settings.steps as f64;
    let steps = settings.steps * lab.effort.choose(10, 100, 100);
    let adaptive: Vec<Case> =
        cases.iter().copied().filter(|case| case.steps != Steps::Fixed).collect();
    let found = lab.sweep("there and back", &adaptive, |case| {
        let plain = return_error(case.ellipse, case.steps, per_period, steps);
        let is_integrating = case.steps == Steps::Adaptive(StepControl::Integrating);
        let on_grid = is_integrating.then(|| return_error_on_grid(case.ellipse, per_period, steps));
        Ok((plain, on_grid))
    })?;
    let mut table = Table::new("returns", &["eccentricity", "steps", "distance from the start"]);
    for (case, (plain, on_grid)) in adaptive.iter().zip(found) {
        let what = format!("distance from the start after {} steps there and back", count(steps));
        record.find(Finding::measured(case.id("return"), case.text(&what), "1", plain));
        let mut row = |name: String, distance: f64| {
            table.push([case.ellipse.eccentricity.into(), name.into(), distance.into()]);
        };
        row(case.steps.name().to_owned(), plain);
        if let Some(distance) = on_grid {
            row(format!("{} on a grid", case.steps.name()), distance);
            record.find(Finding::predicted(
                case.id("return-on-grid"),
                case.text(&format!("{what}, on a grid of 2^{}", orbit_run::GRID)),
                "1",
                0.0,
                distance,
                Tolerance::exact(
                    "sums on the grid have no rounding, so that a step back undoes a step",
                ),
            ));
        }
    }
    record.tables.push(table);
    Ok(())
}
