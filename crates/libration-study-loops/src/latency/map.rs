//! Maps of stability.

use libration::Method;
use libration::analysis::LatencyWindows;
use libration::control::Feedback;
use libration_report::Record;
use libration_report::notation::{count, number};
use libration_report::record::{Finding, Series, Tolerance};
use libration_study::{Lab, StudyError};

use super::critical_latency::GAINS;
use super::loop_simulation::Loop;
use super::stability_edge::{is_stable, lines};

/// The integrators that are mapped.
pub(super) const METHODS: [Method; 2] = [Method::VelocityVerlet, Method::SymplecticEuler];

/// The variable of the rows of a map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    /// The feedback of the velocity, at a time step of 40 ms.
    Gain,
    /// The time step in s, under the gains of the study.
    Step,
}

impl Kind {
    pub(super) const ALL: [Kind; 2] = [Kind::Gain, Kind::Step];

    pub(super) fn name(self) -> &'static str {
        match self {
            Kind::Gain => "gain",
            Kind::Step => "step",
        }
    }

    /// The longest latency, in steps.
    pub(super) fn longest(self) -> u32 {
        match self {
            Kind::Gain => 110,
            Kind::Step => 30,
        }
    }

    /// Rows at a resolution.
    fn rows(self, count: u32) -> Vec<f64> {
        let place = |i: u32| (f64::from(i) + 0.5) / f64::from(count);
        (0..count)
            .map(|i| match self {
                Kind::Gain => 3.0 * place(i),
                Kind::Step => 0.005 * 60_f64.powf(place(i)),
            })
            .collect()
    }

    fn case(self, method: Method, y: f64) -> Loop {
        match self {
            Kind::Gain => Loop { method, dt: 0.04, gains: Feedback { position: 0.0, velocity: y } },
            Kind::Step => Loop { method, dt: y, gains: GAINS },
        }
    }
}

/// A run counts as decided if the loop grows, or decays, by e³ in it.
const DECIDED: f64 = 3.0;

/// Maps each kind for each method.
pub(super) fn measure(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    for kind in Kind::ALL {
        for method in METHODS {
            draw(lab, record, kind, method)?;
        }
    }
    Ok(())
}

fn draw(lab: &Lab<'_>, record: &mut Record, kind: Kind, method: Method) -> Result<(), StudyError> {
    let (rows, steps) = lab.effort.choose((12, 1400), (40, 3500), (96, 12_000));
    let ys = kind.rows(rows);
    let what = format!("map of {} and latency, {}", kind.name(), method.title());
    let map = lab.sweep(&what, &ys, |&y| {
        let case = kind.case(method, y);
        let rate = |late: u32| case.measured(lab, late.into(), steps);
        (0..=kind.longest()).map(rate).collect::<Result<Vec<f64>, _>>()
    })?;
    // Cells on the wrong side of the edge, and those of them that a run of this length should have told.
    let (mut wrong, mut far) = (0, 0);
    for (&y, rates) in ys.iter().zip(&map) {
        let case = kind.case(method, y);
        let windows = case.windows();
        for (late, &rate) in rates.iter().enumerate() {
            if is_stable(&windows, late as f64) != (rate < 0.0) {
                wrong += 1;
                let decided = case.predicted(late as f64).abs() * steps as f64 > DECIDED;
                far += u64::from(decided);
            }
        }
    }
    let cells = u64::from(rows) * u64::from(kind.longest() + 1);
    let id = format!("latency.map-{}.{}", kind.name(), method.name());
    record.find(Finding::predicted(
        id.clone(),
        format!(
            "{}: of {} cells, those that disagree with theory though a run changes by more than e³",
            what,
            count(cells)
        ),
        "1",
        0.0,
        far as f64,
        Tolerance::exact(format!(
            "nearer to the edge {} steps do not tell growth from decay",
            count(steps)
        )),
    ));
    record.find(Finding::measured(
        format!("{id}.near"),
        format!("{what}: cells that disagree with theory at any distance from the edge"),
        "1",
        f64::from(wrong),
    ));
    let across: Vec<f64> = (0..=kind.longest()).map(f64::from).collect();
    let column = |of: &dyn Fn(usize, usize) -> f64| -> Vec<f64> {
        (0..ys.len()).flat_map(|r| (0..across.len()).map(move |c| of(r, c))).collect()
    };
    let unit = if kind == Kind::Gain { "s⁻¹" } else { "s" };
    record.series.push(
        Series::new(format!("map-{}-{}", kind.name(), method.name()))
            .with("latency", "steps", column(&|_, c| across[c]))
            .with(kind.name(), unit, column(&|r, _| ys[r]))
            .with("growth", "1", column(&|r, c| map[r][c])),
    );
    boundary(record, kind, method);
    Ok(())
}

/// The edges by theory, at more rows than the map has.
fn boundary(record: &mut Record, kind: Kind, method: Method) {
    let fine = kind.rows(400);
    let rows: Vec<(f64, LatencyWindows)> =
        fine.iter().map(|&y| (y, kind.case(method, y).windows())).collect();
    let lines = lines(&rows, f64::from(kind.longest()) + 0.5);
    let (mut line, mut x, mut y) = (Vec::new(), Vec::new(), Vec::new());
    for (i, (xs, ys)) in lines.into_iter().enumerate() {
        line.extend(xs.iter().map(|_| i as f64));
        x.extend(xs);
        y.extend(ys);
    }
    record.series.push(
        Series::new(format!("edge-{}-{}", kind.name(), method.name()))
            .with("line", "1", line)
            .with("latency", "steps", x)
            .with(kind.name(), if kind == Kind::Gain { "s⁻¹" } else { "s" }, y),
    );
}

/// The gains of the map of time steps, in words.
pub(super) fn gains() -> String {
    format!("K = ({}, {})", number(GAINS.position, 3), number(GAINS.velocity, 3))
}
