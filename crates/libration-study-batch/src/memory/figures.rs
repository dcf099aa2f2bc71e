//! The figure of the chapter on memory.

use libration_report::figure::{Axis, Figure, Mark, Panel, Role};
use libration_report::record::{Record, RecordError};

use super::MIB;
use super::growth::{HORIZONS, column};
use crate::source_rollouts::{EXAMPLES, TABLE};

/// Memory against environments, a line for each horizon, with what the source prints.
pub(super) fn growth(record: &Record) -> Result<Figure, RecordError> {
    let series = record.series("growth")?;
    let environments = series.column("environments")?;
    let mut panel = Panel::new(Axis::log("environments"), Axis::log("memory").unit("MiB"));
    for (i, horizon) in HORIZONS.into_iter().enumerate() {
        let line = Mark::line(environments, series.column(&column(horizon))?);
        let label = format!("{horizon} steps");
        panel = panel.mark(line.role(Role::Accent(i as u8)).label(label));
    }
    let printed = TABLE.iter().map(|row| row.of).chain([EXAMPLES[1]]);
    let (x, y): (Vec<f64>, Vec<f64>) =
        printed.map(|case| (case.environments as f64, case.megabytes)).unzip();
    panel = panel.mark(Mark::points(x, y).role(Role::Neutral).label("the source"));
    if let Ok(memory) = record.finding("memory.installed") {
        let level = Mark::horizontal(memory.measured / MIB).role(Role::Bad);
        panel = panel.mark(level.label("memory of this machine"));
    }
    Ok(Figure::new("fig-9-10", "Memory of a rollout against environments")
        .caption(
            "Lines: 17 bytes per transition. Points: values of the source in table 9.11 and in §6.5, \
             taken for MiB.",
        )
        .description("Log-log: memory against environments, parallel lines of slope one.")
        .panel(panel))
}

#[cfg(test)]
mod tests {
    use libration::rl::Plan;

    use super::super::bytes;
    use super::*;

    #[test]
    fn what_the_source_prints_lies_on_the_lines() {
        // Printed with two decimals, or with none.
        for case in TABLE.iter().map(|row| row.of).chain([EXAMPLES[1]]) {
            let planned = bytes(Plan::new(case.horizon, case.environments)) / MIB;
            assert!((planned - case.megabytes).abs() <= 0.005, "{case:?}: {planned}");
        }
    }
}
