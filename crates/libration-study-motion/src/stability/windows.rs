//! Windows of stability, exactly and by simulation.

use std::f64::consts::PI;

use libration::analysis::{Spectrum, SymbolicStep, UpdateMatrix};
use libration::integrator::{Composition, VelocityVerlet};
use libration::number::Wide;
use libration::simulation::{Sample, Simulator};
use libration::system::Oscillator;
use libration::{Integrator, Scalar, State, with_method};
use libration_report::Record;
use libration_report::notation::number;
use libration_report::record::{Cell, Finding, Series, Table, Tolerance};
use libration_study::{Lab, StudyError};

use crate::growth::grows;

/// Three Verlet steps of nearly equal size: a composition that loses stability near z = 3, in a gap
/// that a sweep easily steps over, and finds it again.
const UNEVEN_THIRDS: Composition<VelocityVerlet, 3> =
    Composition { base: VelocityVerlet, weights: [0.33, 0.34, 0.33] };
const UNEVEN: (&str, &str) = ("uneven-thirds", "Verlet in thirds of 33, 34 and 33 %");

/// Steps of a simulation that decides whether an orbit grows.
const STEPS: u64 = 20_000;

/// A coarse search: a grid of steps, short runs, and the largest stable step.
const HASTY_GRID: f64 = 0.05;
const HASTY_STEPS: u64 = 100;
const HASTY_AMPLITUDE: f64 = 10.0;

/// The windows of one method, and what simulations make of them.
struct Subject {
    name: &'static str,
    title: &'static str,
    windows: Vec<[f64; 2]>,
    edges: Vec<Edge>,
    hasty: f64,
    /// In the middle of the first gap: where, and `ln ρ` as predicted and measured.
    gap: Option<(f64, f64, f64)>,
}

/// An end of a window.
struct Edge {
    window: usize,
    end: &'static str,
    predicted: f64,
    measured: f64,
    tolerance: f64,
}

/// Examines all methods, and the composition with a gap.
pub(super) fn measure(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let methods: Vec<_> = lab.config.integrators.iter().copied().map(Some).chain([None]).collect();
    let subjects = lab.sweep("windows of stability", &methods, |method| match method {
        Some(m) => with_method!(*m, |i| examine(m.name(), m.title(), i)),
        None => examine(UNEVEN.0, UNEVEN.1, UNEVEN_THIRDS),
    })?;
    let columns = ["integrator", "stable for z = ωΔt", "stable up to, by a coarse sweep"];
    let mut table = Table::new("windows", &columns);
    let mut series = [const { Vec::new() }; 3];
    for (i, subject) in subjects.iter().enumerate() {
        for finding in subject.findings() {
            record.find(finding);
        }
        // All digits are in the findings; several windows leave no room for them.
        let digits = if subject.windows.len() > 1 { 5 } else { 15 };
        let cells: [Cell; 3] = [
            subject.title.into(),
            Cell::intervals(&subject.windows, digits),
            Cell::rounded(subject.hasty, 3),
        ];
        table.push(cells);
        for [from, to] in &subject.windows {
            let row = [i as f64, *from, *to];
            series.iter_mut().zip(row).for_each(|(column, x)| column.push(x));
        }
    }
    record.tables.push(table);
    let [subject, from, to] = series;
    record.series.push(
        Series::new("windows")
            .with("row", "1", subject)
            .with("from", "1", from)
            .with("to", "1", to),
    );
    Ok(())
}

fn examine(
    name: &'static str,
    title: &'static str,
    integrator: impl Integrator,
) -> Result<Subject, StudyError> {
    let step = SymbolicStep::new(integrator)
        .ok_or_else(|| StudyError::Exact(format!("deriving {title}")))?;
    let windows: Vec<[f64; 2]> = step
        .stability_windows()
        .iter()
        .map(|w| [w.from.to_f64(), w.to.map_or(f64::INFINITY, Wide::to_f64)])
        .collect();
    let mut edges = Vec::new();
    for (i, &[from, to]) in windows.iter().enumerate() {
        let inside = 0.5 * (from + to);
        let below = i.checked_sub(1).map(|i| windows[i][1]);
        let above = windows.get(i + 1).map(|w| w[0]);
        let mut edge = |end, predicted: f64, outside: f64| {
            let measured = boundary(integrator, inside, outside);
            let tolerance = resolution(&step, predicted, outside);
            edges.push(Edge { window: i + 1, end, predicted, measured, tolerance });
        };
        if let Some(below) = below {
            edge("from", from, 0.5 * (below + from));
        }
        edge("to", to, above.map_or(1.1 * to, |above| 0.5 * (to + above)));
    }
    let gap = match windows.as_slice() {
        [first, second, ..] => Some(in_the_gap(integrator, &step, 0.5 * (first[1] + second[0]))?),
        _ => None,
    };
    Ok(Subject { name, title, windows, edges, hasty: hasty(integrator), gap })
}

/// Returns the onset of growth between a stable and an unstable step, by bisection.
fn boundary(integrator: impl Integrator, mut stable: f64, mut unstable: f64) -> f64 {
    while (unstable - stable).abs() > 1e-12 * stable {
        let middle = 0.5 * (stable + unstable);
        if grows(integrator, middle, STEPS) { unstable = middle } else { stable = middle }
    }
    0.5 * (stable + unstable)
}

/// How far beyond the edge a run shows its growth: where it grows by e^π in a run. As far before it
/// an orbit takes the whole run for half a beat, and cannot be told from a growing one.
fn resolution(step: &SymbolicStep, edge: f64, outside: f64) -> f64 {
    let shows = |distance: f64| {
        let z = edge + distance * (outside - edge).signum();
        spectrum(step, z).radius_minus_one().to_f64() * (STEPS as f64) > PI
    };
    let farthest = (outside - edge).abs();
    let mut distance = 1e-12;
    while distance < farthest && !shows(distance) {
        distance *= 2.0;
    }
    distance
}

fn spectrum(step: &SymbolicStep, z: f64) -> Spectrum {
    let z = Wide::from_f64(z);
    let matrix: UpdateMatrix<Wide> = step.matrix.map(|p| p.eval_wide(z));
    Spectrum::new(&matrix)
}

/// `z` and the growth `ln ρ` of a step there, as predicted and by simulation.
fn in_the_gap(
    integrator: impl Integrator,
    step: &SymbolicStep,
    z: f64,
) -> Result<(f64, f64, f64), StudyError> {
    let predicted = spectrum(step, z).radius_minus_one().to_f64().ln_1p();
    // The trace of n steps is ρⁿ + ρ⁻ⁿ; e⁶⁰ lets the second vanish, and is far from overflow.
    let steps = (60.0 / predicted).ceil().clamp(1.0, 1e7) as u64;
    let unit = Oscillator { omega2: 1.0 };
    let end = |q: f64, v: f64| -> Result<State<f64, 1>, StudyError> {
        let mut simulator = Simulator::new(unit, integrator, State { q: [q], v: [v] }, z)?;
        simulator.run(steps, &mut ())?;
        Ok(simulator.sample().state)
    };
    let trace = end(1.0, 0.0)?.q[0] + end(0.0, 1.0)?.v[0];
    Ok((z, predicted, trace.abs().ln() / steps as f64))
}

/// The largest step of a coarse grid that a short run survives.
fn hasty(integrator: impl Integrator) -> f64 {
    let survives = |z: f64| {
        let mut largest = 0.0_f64;
        let mut watch = |sample: &Sample<f64, 1>| largest = largest.max(sample.state.q[0].abs());
        let start = State { q: [1.0], v: [0.0] };
        let unit = Oscillator { omega2: 1.0 };
        let outcome = Simulator::new(unit, integrator, start, z)
            .and_then(|mut simulator| simulator.run(HASTY_STEPS, &mut watch));
        outcome.is_ok() && largest <= HASTY_AMPLITUDE
    };
    let grid = (1..=160).rev().map(|i| f64::from(i) * HASTY_GRID);
    grid.into_iter().find(|&z| survives(z)).unwrap_or(0.0)
}

impl Subject {
    fn findings(&self) -> Vec<Finding> {
        let Subject { name, title, .. } = self;
        let mut findings: Vec<Finding> = self
            .edges
            .iter()
            .map(|edge| {
                let Edge { window, end, predicted, measured, tolerance } = *edge;
                let which = if end == "from" { "begins" } else { "ends" };
                Finding::predicted(
                    format!("stability.{name}.window-{window}-{end}"),
                    format!("{title}: z at which window {window} of stability {which}"),
                    "1",
                    predicted,
                    measured,
                    Tolerance::absolute(
                        tolerance,
                        format!(
                            "the distance at which {STEPS} steps grow by e^π, or last half a beat"
                        ),
                    ),
                )
            })
            .collect();
        let end = self.windows.first().map_or(0.0, |w| w[1]);
        findings.push(Finding::measured(
            format!("stability.{name}.hasty"),
            format!(
                "{title}: largest z that survives {HASTY_STEPS} steps, on a grid of {HASTY_GRID}; \
                 stability is lost at {}",
                number(end, 6)
            ),
            "1",
            self.hasty,
        ));
        if let Some((z, predicted, measured)) = self.gap {
            findings.push(Finding::predicted(
                format!("stability.{name}.gap-growth"),
                format!("{title}: ln ρ of a step in the gap, at z = {}", number(z, 6)),
                "1",
                predicted,
                measured,
                Tolerance::relative(
                    1e-9,
                    "the trace after n steps is ρⁿ to a part in e¹²⁰; rounded coefficients act \
                     where growth rises steeply with z",
                ),
            ));
        }
        findings
    }
}
