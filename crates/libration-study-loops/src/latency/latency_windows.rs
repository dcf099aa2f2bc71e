//! Windows of stability above the critical latency.

use libration::Method;
use libration::control::Feedback;
use libration_report::Record;
use libration_report::notation::{count, seconds};
use libration_report::record::{Cell, Finding, Series, Table, Tolerance};
use libration_study::{Lab, StudyError};

use super::loop_simulation::Loop;
use super::stability_edge::is_stable;

/// Feedback of the velocity alone, a little of it: the loop that finds its stability again.
const CASE: Loop = Loop {
    method: Method::VelocityVerlet,
    dt: 0.01,
    gains: Feedback { position: 0.0, velocity: 1.0 },
};

/// Theory is asked for the rate of growth at every so manieth latency: its polynomial has as many roots.
const PREDICTED: usize = 10;

/// Tries every whole latency.
pub(super) fn measure(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let windows = CASE.windows();
    let (last, steps) = lab.effort.choose((220, 6000), (450, 12_000), (600, 60_000));
    let latencies: Vec<u32> = (0..=last).collect();
    let rates =
        lab.sweep("stable latencies", &latencies, |&late| CASE.measured(lab, late.into(), steps))?;
    let asked: Vec<u32> = latencies.iter().copied().step_by(PREDICTED).collect();
    let asked: Vec<u32> = asked.into_iter().filter(|&late| late <= 220).collect();
    let forecast =
        lab.sweep("growth by theory", &asked, |&late| Ok(CASE.predicted(late.into())))?;
    let wrong = latencies
        .iter()
        .zip(&rates)
        .filter(|(late, rate)| is_stable(&windows, f64::from(**late)) != (**rate < 0.0));
    let title = format!("velocity Verlet, Δt = {}, K = (0, 1)", seconds(CASE.dt, 3));
    record.find(Finding::predicted(
        "latency.windows.verdicts",
        format!("{title}: of the latencies from 0 to {last} steps, those whose verdict is not that of theory"),
        "1",
        0.0,
        wrong.count() as f64,
        Tolerance::exact("every whole latency is tried, and none lies on an edge"),
    ));
    let mut table = Table::new(
        "latency windows",
        &[
            "window",
            "stable from, predicted (steps)",
            "to, predicted (steps)",
            "from, measured (steps)",
            "to, measured (steps)",
        ],
    );
    // Runs of stable latencies, as simulated.
    let mut runs: Vec<[u32; 2]> = Vec::new();
    for (&late, _) in latencies.iter().zip(&rates).filter(|(_, rate)| **rate < 0.0) {
        match runs.last_mut() {
            Some([_, to]) if *to + 1 == late => *to = late,
            _ => runs.push([late, late]),
        }
    }
    for (i, &(from, to)) in windows.stable.iter().enumerate() {
        let to = to.unwrap_or(f64::INFINITY);
        if to > f64::from(last) {
            break;
        }
        let found = runs.get(i).map(|run| run.map(f64::from));
        let [begins, ends] = found.unwrap_or([f64::NAN; 2]);
        for (name, predicted, measured) in [("from", from.ceil(), begins), ("to", to.floor(), ends)]
        {
            record.find(Finding::predicted(
                format!("latency.windows.{}-{name}", i + 1),
                format!(
                    "{title}: {} latency of window {} of stability",
                    if name == "from" { "first" } else { "last" },
                    i + 1
                ),
                "steps",
                predicted,
                measured,
                Tolerance::exact("every whole latency is tried"),
            ));
        }
        let cells: [Cell; 5] =
            [(i as u64 + 1).into(), from.into(), to.into(), begins.into(), ends.into()];
        table.push(cells);
    }
    record.tables.push(table);
    let largest =
        asked.iter().zip(&forecast).map(|(&late, rate)| (rates[late as usize] - rate).abs());
    record.find(Finding::predicted(
        "latency.windows.rates",
        format!(
            "{title}: largest error of a simulated growth a step, over {} latencies up to {}",
            asked.len(),
            count(220)
        ),
        "1",
        0.0,
        largest.fold(0.0, f64::max),
        Tolerance::absolute(
            1e-5,
            "where two pairs of eigenvalues are nearly as large, the orbit beats slowly",
        ),
    ));
    let at =
        |late: u32| asked.iter().position(|&asked| asked == late).map_or(f64::NAN, |i| forecast[i]);
    record.series.push(
        Series::new("windows")
            .with("latency", "steps", latencies.iter().map(|&late| late.into()).collect())
            .with("measured", "1", rates)
            .with("predicted", "1", latencies.iter().map(|&late| at(late)).collect()),
    );
    Ok(())
}
