//! Tables of a system at its equilibrium.

use libration_analyze::linear_analysis::Mode;
use libration_report::notation::number;
use libration_report::record::{Cell, Table};
use libration_settings::equations::EquationSystem;

/// The states at the equilibrium.
pub(super) fn equilibrium(system: &EquationSystem, at: &[f64]) -> Table {
    let mut table = Table::new("equilibrium", &["state", "value", "unit"]);
    for state in &system.states {
        let cells: [Cell; 3] =
            [state.name.as_str().into(), at[state.place].into(), state.unit.as_str().into()];
        table.push(cells);
    }
    table
}

/// The modes.
pub(super) fn modes(modes: &[Mode]) -> Table {
    let columns = ["growth rate (1/s)", "frequency (Hz)", "damping ratio", "states that move most"];
    let mut table = Table::new("modes", &columns);
    for mode in modes {
        let states: Vec<String> =
            mode.states.iter().map(|(name, size)| format!("{name} {}", number(*size, 2))).collect();
        table.push([
            mode.growth_rate.into(),
            mode.frequency.into(),
            mode.damping_ratio.into(),
            Cell::from(states.join(", ")),
        ]);
    }
    table
}
