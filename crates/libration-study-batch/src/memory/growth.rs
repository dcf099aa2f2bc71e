//! Growth of memory with the environments and the horizon.

use libration::rl::Plan;
use libration_report::record::{Finding, Record, Series, Tolerance};
use libration_study::{Fit, StudyError};

use super::{MIB, bytes};

/// Horizons of the figure.
pub(super) const HORIZONS: [usize; 4] = [64, 512, 1024, 2048];

/// Returns the numbers of the fit: powers of two from 64.
fn numbers() -> Vec<usize> {
    (6..=16).map(|power| 1 << power).collect()
}

/// Reason for the tolerance of an exponent.
const ROUNDING: &str = "a few roundings of logarithms of 9 to 25, over a span of 2.8";

/// Fits the growth, and leaves the curves.
pub(super) fn measure(record: &mut Record) -> Result<(), StudyError> {
    let numbers = numbers();
    let as_floats = |all: &[usize]| all.iter().map(|&n| n as f64).collect::<Vec<_>>();
    type Taken = fn(usize) -> f64;
    let grown: [(&str, &str, Taken); 2] = [
        ("environments", "environments, 1024 steps each", |n| bytes(Plan::new(1024, n))),
        ("horizon", "steps of 1024 environments", |n| bytes(Plan::new(n, 1024))),
    ];
    for (id, what, taken) in grown {
        let memory: Vec<f64> = numbers.iter().map(|&n| taken(n)).collect();
        let fit = Fit::new(&as_floats(&numbers), &memory);
        let fit = fit.ok_or_else(|| StudyError::Exact("fitting a power of memory".into()))?;
        record.find(Finding::predicted(
            format!("memory.growth.{id}"),
            format!("the power with which memory grows with the number of {what}"),
            "1",
            1.0,
            fit.exponent,
            Tolerance::absolute(1e-12, ROUNDING),
        ));
    }
    let [one, both] = [1, 2].map(|times| bytes(Plan::new(times * 1024, times * 4096)));
    record.find(Finding::predicted(
        "memory.growth.both",
        "how many times as much memory twice as many environments take over twice the horizon",
        "1",
        4.0,
        both / one,
        Tolerance::exact("a product of two whole numbers"),
    ));
    let mut series = Series::new("growth").with("environments", "1", as_floats(&numbers));
    for horizon in HORIZONS {
        let memory = numbers.iter().map(|&n| bytes(Plan::new(horizon, n)) / MIB).collect();
        series = series.with(column(horizon), "MiB", memory);
    }
    record.series.push(series);
    Ok(())
}

/// The name of the column of a horizon.
pub(super) fn column(horizon: usize) -> String {
    format!("horizon_{horizon}")
}
