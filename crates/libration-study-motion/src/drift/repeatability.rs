//! Repeatability of a run.

use libration::simulation::Simulator;
use libration::{Method, Model, State, with_method};
use libration_report::Record;
use libration_report::notation::count;
use libration_report::record::{Finding, Tolerance};
use libration_study::{Lab, StudyError};

use crate::drift::DriftSettings;

/// Runs every method twice on as many threads as there are, and counts final coordinates that
/// differ in any bit.
pub(super) fn compare(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let config = lab.config;
    let Some(&dt) = config.get::<DriftSettings>().dt.first() else { return Ok(()) };
    let twice: Vec<Method> =
        config.integrators.iter().chain(&config.integrators).copied().collect();
    let ends = lab.sweep("the same run twice", &twice, |&method| end(lab, method, dt))?;
    let (first, second) = ends.split_at(config.integrators.len());
    let differing = first.iter().zip(second).flat_map(|(a, b)| a.iter().zip(b));
    record.find(Finding::predicted(
        "drift.repeat",
        format!(
            "coordinates whose bits differ between two runs of {} steps of each method",
            count(config.get::<DriftSettings>().steps)
        ),
        "1",
        0.0,
        differing.filter(|(a, b)| a != b).count() as f64,
        Tolerance::exact("the same operations on the same bits"),
    ));
    Ok(())
}

/// The bits of the last finite state.
fn end(lab: &Lab<'_>, method: Method, dt: f64) -> Result<[u64; 2], StudyError> {
    let system = Model::<1>::on::<f64>(&lab.config.oscillator.system());
    let start = State { q: [lab.config.start.q], v: [lab.config.start.v] };
    let state = with_method!(method, |m| {
        let mut simulator = Simulator::new(system, m, start, dt)?;
        simulator.run(lab.config.get::<DriftSettings>().steps, &mut ()).ok();
        simulator.sample().state
    });
    Ok([state.q[0].to_bits(), state.v[0].to_bits()])
}
