//! The machine on which all this was measured.

use super::desk::Desk;
use crate::machine::Machine;
use crate::record::{Cell, Record, Table};

/// Describes it; what was measured of it stands in other tables.
pub(super) fn describe(desk: &Desk<'_>, record: &mut Record) {
    let machine = Machine::detect();
    let mut table = Table::new("machine", &["property", "value"]);
    let mut row = |property: &str, value: Cell| table.push([property.into(), value]);
    row("processor", machine.cpu.into());
    row("cores for this process", (machine.cores as u64).into());
    row("instruction sets", machine.instruction_sets.join(", ").into());
    row("instruction set in use", desk.set().name().into());
    for cache in machine.caches {
        row(&format!("data cache {} (KiB)", cache.level), (cache.bytes >> 10).into());
    }
    if let Some(memory) = machine.memory {
        row("memory (GiB)", Cell::rounded(memory as f64 / (1u64 << 30) as f64, 3));
    }
    row("system", machine.platform.into());
    row("compiler", machine.compiler.into());
    row("program", format!("libration {}", machine.version).into());
    record.tables.push(table);
}
