//! The largest time step that meets a criterion, as a root and by search.

use libration::analysis::{Criterion, LargestStep, OrbitStart, SymbolicStep};
use libration::simulation::{EnergyDrift, Sample, Simulator};
use libration::system::Oscillator;
use libration::{Integrator, Method, Model, State, with_method};
use libration_report::Record;
use libration_report::notation::{count, number};
use libration_report::record::{Cell, Finding, Relation, Table, Tolerance};
use libration_study::{Config, Lab, StudyError};

use crate::coverage::{exponent, slack};
use crate::rounding::rounding_of_run;
use crate::stability::StabilitySettings;

/// The amplitude that counts as an explosion, in multiples of the start.
const AMPLITUDE: f64 = 10.0;

/// Steps of the search upwards, before it bisects.
const STRIDE: f64 = 1.25;

/// Relative precision of the search.
const PRECISION: f64 = 1e-8;

/// A criterion that a step must meet for a number of steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Limit {
    Amplitude(f64),
    Drift(f64),
}

/// One method under one criterion.
#[derive(Clone, Copy, Debug)]
pub(super) struct Case {
    pub(super) method: Method,
    pub(super) limit: Limit,
    pub(super) steps: u64,
}

/// Results, in s.
struct Outcome {
    predicted: f64,
    measured: f64,
    tolerance: Tolerance,
    relation: Relation,
}

impl Limit {
    pub(super) fn tag(self) -> String {
        match self {
            Limit::Amplitude(_) => "amplitude".into(),
            Limit::Drift(tolerance) => format!("drift-{tolerance}"),
        }
    }

    pub(super) fn label(self) -> String {
        match self {
            Limit::Amplitude(_) => format!("|x| below {} times the start", number(AMPLITUDE, 3)),
            Limit::Drift(tolerance) => format!("energy drift below {}", number(tolerance, 3)),
        }
    }
}

impl Case {
    pub(super) fn id(&self) -> String {
        format!("stability.{}.{}.steps-{}", self.method.name(), self.limit.tag(), self.steps)
    }
}

/// The criteria of a configuration.
pub(super) fn limits(config: &Config) -> Vec<Limit> {
    let radius = start(config).q[0].hypot(start(config).v[0]);
    let settings = config.get::<StabilitySettings>();
    let drifts = settings.tolerances.iter().map(|&tolerance| Limit::Drift(tolerance));
    drifts.chain([Limit::Amplitude(AMPLITUDE * radius)]).collect()
}

/// The start in units in which `ω = 1`.
pub(super) fn start(config: &Config) -> State<f64, 1> {
    State { q: [config.start.q], v: [config.start.v / config.oscillator.omega()] }
}

/// The largest step for a case as a root, in units in which `ω = 1`; none where it has no such form.
pub(super) fn root(config: &Config, case: &Case) -> Option<LargestStep> {
    let step = SymbolicStep::new(case.method)?;
    let State { q, v } = start(config);
    let (steps, start) = (case.steps, OrbitStart::new(&q, &v));
    step.largest_step(&match case.limit {
        Limit::Amplitude(limit) => Criterion::Amplitude { limit, steps, start },
        Limit::Drift(tolerance) => Criterion::EnergyDrift { tolerance, steps, start: Some(start) },
    })
}

/// Every method under every criterion over every horizon.
pub(super) fn measure(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let config = lab.config;
    let reach = lab.effort.choose(10_000, 100_000, 10_000_000);
    let steps: Vec<u64> =
        config.get::<StabilitySettings>().steps.iter().copied().filter(|&n| n <= reach).collect();
    let rows: Vec<(Limit, u64)> =
        limits(config).into_iter().flat_map(|l| steps.iter().map(move |&n| (l, n))).collect();
    let cases: Vec<Case> = rows
        .iter()
        .flat_map(|&(limit, steps)| {
            config.integrators.iter().map(move |&method| Case { method, limit, steps })
        })
        .collect();
    let found = lab.sweep("largest time steps", &cases, |case| {
        with_method!(case.method, |m| search(lab, m, case))
    })?;
    let titles = config.integrators.iter().map(|m| m.title());
    let columns: Vec<&str> = ["criterion", "steps"].into_iter().chain(titles).collect();
    let mut table = Table::new("largest steps", &columns);
    for (row, outcomes) in rows.iter().zip(found.chunks(config.integrators.len().max(1))) {
        let head: [Cell; 2] = [row.0.label().into(), row.1.into()];
        let cells = outcomes.iter().map(|outcome| match outcome {
            Some(outcome) => Cell::from(outcome.measured),
            None => Cell::absent("—"),
        });
        table.push(head.into_iter().chain(cells));
    }
    record.tables.push(table);
    for (case, outcome) in cases.iter().zip(found) {
        let Some(outcome) = outcome else { continue };
        record.find(Finding::related(
            case.id(),
            format!(
                "{}: largest Δt with {} over {} steps, by search",
                case.method.title(),
                case.limit.label(),
                count(case.steps)
            ),
            "s",
            outcome.relation,
            outcome.predicted,
            outcome.measured,
            outcome.tolerance,
        ));
    }
    Ok(())
}

/// Searches by simulation, upwards from a small step to the first that fails, then by bisection.
fn search(
    lab: &Lab<'_>,
    integrator: impl Integrator,
    case: &Case,
) -> Result<Option<Outcome>, StudyError> {
    let (config, oscillator) = (lab.config, lab.config.oscillator.system());
    let omega = config.oscillator.omega();
    let Some(predicted) = root(config, case).map(LargestStep::to_f64) else { return Ok(None) };
    if !(predicted.is_finite() && predicted > 0.0) {
        return Ok(None);
    }
    let start = State { q: [config.start.q], v: [config.start.v] };
    let meets = |dt: f64| -> Result<bool, StudyError> {
        lab.check()?;
        Ok(stays_within(oscillator, integrator, start, dt, case.steps, case.limit))
    };
    // Two decades below the prediction are enough to see a gap below it, were there one.
    let mut low = 1e-2 * predicted / omega;
    if !meets(low)? {
        let tolerance = Tolerance::exact("no step was found to meet the criterion");
        return Ok(Some(Outcome {
            predicted,
            measured: 0.0,
            tolerance,
            relation: Relation::Equal,
        }));
    }
    while meets(low * STRIDE)? && low < 10.0 / omega {
        low *= STRIDE;
    }
    let mut high = low * STRIDE;
    while high - low > PRECISION * high {
        let middle = 0.5 * (low + high);
        if meets(middle)? { low = middle } else { high = middle }
    }
    let measured = 0.5 * (low + high);
    let (tolerance, relation) = allowed(config, case, predicted, measured * omega);
    Ok(Some(Outcome { predicted: predicted / omega, measured, tolerance, relation }))
}

/// How far the root `z` and the search, which `ended` there, may lie apart, and why.
fn allowed(config: &Config, case: &Case, z: f64, ended: f64) -> (Tolerance, Relation) {
    let n = case.steps as f64;
    let rounding = 4.0 * rounding_of_run(case.method, 1.0, z, case.steps);
    // Just beyond a limit an orbit grows as exp(n√(2δ)): it takes so much for e¹⁰ or so to show.
    let late = (20.0 / n).powi(2);
    // In the criterion, and from there in z.
    let (slack, rounding) = match case.limit {
        Limit::Drift(tolerance) => {
            let start = start(config);
            let steepness = exponent(case.method, &start, case.steps, z).clamp(1e-6, 1.0);
            let slack = slack(case.method, &start, case.steps, (z, ended), tolerance);
            (slack.unwrap_or(f64::INFINITY), rounding / tolerance / steepness)
        }
        Limit::Amplitude(limit) => (2.0 * short_of(config, case, z, limit), rounding / limit),
    };
    let relative = slack + late + rounding + 2.0 * PRECISION;
    let reason = "how far beyond its curve’s limit the discrete orbit may keep to the criterion, \
                  (20/n)² for growth to show beyond a limit, rounding relative to the criterion, and \
                  the search";
    // A run of less than a turn may never see the extreme: then the root is a bound.
    if relative < 0.2 {
        (Tolerance::relative(relative, reason), Relation::Equal)
    } else {
        let relative = late + rounding + 2.0 * PRECISION;
        (Tolerance::relative(relative, reason), Relation::AtLeast)
    }
}

/// By which part of `z` a search may come out larger because the discrete orbit does not visit the
/// largest `|x|` of its curve: of a growing one, which is largest in its last half turn, `π/(zn)`;
/// of another, what it lacks.
fn short_of(config: &Config, case: &Case, z: f64, limit: f64) -> f64 {
    let Some(step) = SymbolicStep::new(case.method) else { return 0.0 };
    if !step.is_symplectic() {
        return 0.5 * std::f64::consts::PI / (z * case.steps as f64);
    }
    let matrix = step.matrix.map(|p| p.eval_f64(z));
    let orbit = std::iter::successors(Some(start(config)), |state| Some(matrix.apply(state)));
    let largest = orbit.take(case.steps as usize).fold(0.0_f64, |a, s| a.max(s.q[0].abs()));
    (1.0 - largest / limit).clamp(0.0, 1.0)
}

/// Whether a run keeps to its limit.
fn stays_within(
    oscillator: Oscillator<f64>,
    integrator: impl Integrator,
    start: State<f64, 1>,
    dt: f64,
    steps: u64,
    limit: Limit,
) -> bool {
    /// Steps between two looks at whether the run has already failed.
    const STRETCH: u64 = 256;
    let system = Model::<1>::on::<f64>(&oscillator);
    let drift = EnergyDrift::new(system, &start);
    let Ok(mut simulator) = Simulator::new(system, integrator, start, dt) else { return false };
    let mut taken = 0;
    while taken < steps {
        let next = STRETCH.min(steps - taken);
        let mut within = true;
        let mut watch = |sample: &Sample<f64, 1>| {
            within &= match limit {
                Limit::Amplitude(limit) => sample.state.q[0].abs() <= limit,
                Limit::Drift(tolerance) => drift.of(&sample.state).abs() <= tolerance,
            };
        };
        if simulator.run(next, &mut watch).is_err() {
            return false;
        }
        taken += next;
        if !within {
            return false;
        }
    }
    true
}
