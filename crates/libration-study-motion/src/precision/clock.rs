//! Clocks that sum their steps.

use half::{bf16, f16};
use libration::Float;
use libration::analysis::float_clock;
use libration_report::Record;
use libration_report::notation::{count, seconds};
use libration_report::record::{Cell, Finding, Table, Tolerance};
use libration_study::{Lab, StudyError};

use super::tag;
use crate::precision::PrecisionSettings;

/// A clock's name, and what it shows after so many ticks of so many seconds: predicted, and by adding.
type Clock = (&'static str, fn(f64, u64) -> Option<[f64; 2]>);

const CLOCKS: [Clock; 4] =
    [("bf16", show::<bf16>), ("f16", show::<f16>), ("f32", show::<f32>), ("f64", show::<f64>)];

/// Measures the clocks after all steps, at every time step.
pub(super) fn measure(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let config = &lab.config.get::<PrecisionSettings>();
    let columns =
        ["Δt (s)", "float", "time (s)", "shown, predicted (s)", "shown (s)", "behind (s)"];
    let mut table = Table::new("clocks", &columns);
    for &dt in &config.dt {
        lab.check()?;
        let time = dt * config.steps as f64;
        for (name, show) in CLOCKS {
            let Some([predicted, measured]) = show(dt, config.steps) else { continue };
            record.find(Finding::predicted(
                format!("precision.clock.{name}.{}", tag(dt)),
                format!(
                    "a clock in {name} after {} ticks `t += dt` of {}",
                    count(config.steps),
                    seconds(dt, 3)
                ),
                "s",
                predicted,
                measured,
                Tolerance::exact(
                    "between two powers of two every addition is rounded alike, so both are sums of \
                     the same floats",
                ),
            ));
            table.push([
                dt.into(),
                name.into(),
                time.into(),
                Cell::rounded(predicted, 9),
                Cell::rounded(measured, 9),
                Cell::rounded(time - measured, 4),
            ]);
        }
    }
    record.tables.push(table);
    Ok(())
}

fn show<F: Float>(dt: f64, ticks: u64) -> Option<[f64; 2]> {
    let dt = F::from_f64(dt);
    let predicted = float_clock(dt, ticks)?;
    let added = (0..ticks).fold(F::zero(), |t, _| t + dt);
    Some([predicted.to_f64(), added.to_f64()]).filter(|shown| shown[1].is_finite())
}
