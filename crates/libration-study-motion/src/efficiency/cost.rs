//! The cost of a step: force evaluations and time.

use std::hint::black_box;
use std::time::Instant;

use libration::analysis::Tableau;
use libration::simulation::Simulator;
use libration::{Integrator, Method, Model, State, with_method};
use libration_report::Record;
use libration_report::record::{Finding, Table, Tolerance};
use libration_study::{Lab, StudyError};

/// Runs of which the median is taken.
const REPEATS: usize = 9;

/// The cost of one step of a method.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cost {
    pub(super) method: Method,
    pub(super) evaluations: u64,
    pub(super) nanoseconds: f64,
}

/// Measures all methods, one after another on an otherwise idle laboratory.
pub(super) fn measure(lab: &Lab<'_>, record: &mut Record) -> Result<Vec<Cost>, StudyError> {
    let steps = lab.effort.choose(20_000, 100_000, 1_000_000);
    let mut costs = Vec::new();
    let mut table = Table::new(
        "cost of a step",
        &["integrator", "force evaluations", "time (ns)", "spread (ns)"],
    );
    for method in super::methods(lab.config) {
        lab.check()?;
        let (evaluations, times) = with_method!(method, |m| time(lab, m, steps))?;
        let nanoseconds = times[REPEATS / 2];
        let (name, title) = (method.name(), method.title());
        if let Some(tableau) = Tableau::new(method) {
            record.find(Finding::predicted(
                format!("efficiency.{name}.evaluations"),
                format!("{title}: force evaluations a step, counted, beside its tableau"),
                "1",
                tableau.c.len() as f64,
                evaluations as f64,
                Tolerance::exact("both are counts"),
            ));
        }
        record.find(Finding::measured(
            format!("efficiency.{name}.time"),
            format!("{title}: time of a step, median of {REPEATS} runs of {steps} steps"),
            "ns",
            nanoseconds,
        ));
        table.push([
            title.into(),
            evaluations.into(),
            nanoseconds.into(),
            (times[REPEATS - 1] - times[0]).into(),
        ]);
        costs.push(Cost { method, evaluations, nanoseconds });
    }
    record.tables.push(table);
    Ok(costs)
}

/// Force evaluations of a step, and times of a step in ns, rising.
fn time(
    lab: &Lab<'_>,
    integrator: impl Integrator,
    steps: u64,
) -> Result<(u64, Vec<f64>), StudyError> {
    let system = Model::<1>::on::<f64>(&lab.config.oscillator.system());
    let start = State { q: [lab.config.start.q], v: [lab.config.start.v] };
    // Small enough for every method to stay finite.
    let dt = 1e-3 / lab.config.oscillator.omega();
    let mut one = Simulator::new(system, integrator, start, dt)?;
    one.run(1, &mut ())?;
    let mut times = Vec::with_capacity(REPEATS);
    for _ in 0..REPEATS {
        let begun = Instant::now();
        let mut simulator = Simulator::new(system, integrator, black_box(start), dt)?;
        simulator.run(steps, &mut ())?;
        black_box(simulator.sample());
        times.push(begun.elapsed().as_secs_f64() * 1e9 / steps as f64);
    }
    times.sort_by(f64::total_cmp);
    Ok((one.evaluations(), times))
}
