//! Table 9.11 of the source and the same rollouts in this run.

use libration_report::record::{Cell, Record, Series, Table};
use libration_study::{Lab, StudyError};

use super::peers;
use crate::source_rollouts::TABLE;

/// Its name.
pub(super) const NAME: &str = "table 9.11";

/// Makes it from the rates of the record, and NumPy's where a file of peers is given.
pub(super) fn compare(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let peers = peers::read(lab)?;
    let mut columns = vec![
        "environments",
        "horizon",
        "transitions",
        "MiB",
        "the source (s)",
        "the source (10⁶/s)",
        "one core (10⁶/s)",
        "all (10⁶/s)",
    ];
    if peers.is_some() {
        columns.push("NumPy (10⁶/s)");
    }
    let mut table = Table::new(NAME, &columns);
    let mut rates: Vec<[f64; 4]> = Vec::new();
    for row in &TABLE {
        let name = row.of.name();
        let rate = |on: &str| record.finding(&format!("rollout.rate.{name}{on}")).ok();
        let [one, all] = ["", ".threads"].map(|on| rate(on).map(|finding| finding.measured));
        let numpy = peers.as_ref().and_then(|peers| {
            peers.best("numpy", row.of.environments as u64, row.of.horizon as u64)
        });
        let millions = |rate: Option<f64>| Cell::from(rate.map(|rate| rate / 1e6));
        let mut cells: Vec<Cell> = vec![
            (row.of.environments as u64).into(),
            (row.of.horizon as u64).into(),
            row.of.transitions.into(),
            row.of.megabytes.into(),
            row.seconds.into(),
            Cell::rounded(row.millions, 4),
            millions(one),
            millions(all),
        ];
        if peers.is_some() {
            cells.push(millions(numpy));
        }
        table.push(cells);
        rates.push([Some(1e6 * row.millions), numpy, one, all].map(|x| x.unwrap_or(f64::NAN)));
    }
    record.tables.push(table);
    let column = |i: usize| rates.iter().map(|rates| rates[i]).collect();
    let environments = TABLE.map(|row| row.of.environments as f64).to_vec();
    let horizons = TABLE.map(|row| row.of.horizon as f64).to_vec();
    record.series.push(
        Series::new("summary")
            .with("environments", "1", environments)
            .with("horizon", "1", horizons)
            .with("source", "1/s", column(0))
            .with("numpy", "1/s", column(1))
            .with("one", "1/s", column(2))
            .with("all", "1/s", column(3)),
    );
    Ok(())
}
