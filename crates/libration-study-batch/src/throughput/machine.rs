//! The machine of the measurements.

use libration_report::record::{Cell, Record, RecordError, Table};
use libration_study::Machine;

use crate::measurement::Measurement;

/// Describes it, with the ends of its powers that `record` holds.
pub(super) fn describe(
    measurement: &Measurement<'_>,
    record: &mut Record,
) -> Result<(), RecordError> {
    let measured = |id: &str| record.finding(id).map(|f| Cell::rounded(f.measured, 3));
    let powers = [
        ("arithmetic of one core, f32 (10⁹ operations/s)", measured("throughput.roof.peak")?),
        ("bandwidth of one core (GB/s)", measured("throughput.bandwidth.update.one-core")?),
        ("bandwidth of all cores (GB/s)", measured("throughput.bandwidth.update")?),
    ];
    let mut noises = noises(record)?;
    noises.sort_by(f64::total_cmp);
    let middle = noises.get(noises.len() / 2).copied();
    let machine = Machine::detect();
    let mut table = Table::new("machine", &["property", "value"]);
    let mut row = |property: &str, value: Cell| table.push([property.into(), value]);
    row("processor", machine.cpu.into());
    row("cores for this process", (machine.cores as u64).into());
    row("instruction sets", machine.instruction_sets.join(", ").into());
    row("instruction set in use", measurement.set().name().into());
    for cache in machine.caches {
        row(&format!("data cache {} (KiB)", cache.level), (cache.bytes >> 10).into());
    }
    if let Some(memory) = machine.memory {
        row("memory (GiB)", Cell::rounded(memory as f64 / (1u64 << 30) as f64, 3));
    }
    for (property, value) in powers {
        row(property, value);
    }
    if let Some((middle, most)) = middle.zip(noises.last()) {
        row("noise of a rate, in the middle (%)", Cell::rounded(100.0 * middle, 2));
        row("noise of a rate, at most (%)", Cell::rounded(100.0 * most, 2));
    }
    row("system", machine.platform.into());
    row("compiler", machine.compiler.into());
    row("program", format!("libration {}", machine.version).into());
    record.tables.push(table);
    Ok(())
}

/// Returns the relative distance of the quartiles of each rate.
fn noises(record: &Record) -> Result<Vec<f64>, RecordError> {
    let mut noises = Vec::new();
    for series in record.series.iter().filter(|series| series.name.starts_with("scaling-")) {
        let (spreads, rates) = (series.column("spread")?, series.column("steps_per_second")?);
        noises.extend(spreads.iter().zip(rates).map(|(spread, rate)| spread / rate));
    }
    Ok(noises)
}
