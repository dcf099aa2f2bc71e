//! Orbits in phase space.

use libration::analysis::{EnergyBand, UpdateMatrix};
use libration::simulation::{Every, Sample, Simulator};
use libration::{Model, State, with_method};
use libration_report::Record;
use libration_report::record::Series;
use libration_study::{Lab, StudyError};

use crate::drift::DriftSettings;

/// Traces orbits at the largest time step, in units in which the exact orbit is a circle.
pub(super) fn trace(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let config = lab.config;
    let Some(&dt) = config.get::<DriftSettings>().dt.last() else { return Ok(()) };
    let oscillator = config.oscillator.system();
    let system = Model::<1>::on::<f64>(&oscillator);
    let omega = config.oscillator.omega();
    let start = State { q: [config.start.q], v: [config.start.v] };
    let turn = std::f64::consts::TAU / (omega * dt);
    let orbits = lab.sweep("phase portraits", &config.integrators, |&method| {
        let steps = (6.0 * turn).ceil().clamp(12.0, 20_000.0) as u64;
        let (mut x, mut y) = (Vec::new(), Vec::new());
        let mut watch = Every {
            n: (steps / 400).max(1),
            observer: |s: &Sample<f64, 1>| {
                x.push(s.state.q[0]);
                y.push(s.state.v[0] / omega);
            },
        };
        with_method!(method, |m| {
            Simulator::new(system, m, start, dt)?.run(steps, &mut watch).ok();
        });
        let step = UpdateMatrix::of_step(method, oscillator, &start, dt);
        let curve = EnergyBand::new(oscillator, &step)
            .map(|band| band.curve(&start, 180))
            .unwrap_or_default();
        Ok((method, [x, y], curve))
    })?;
    for (method, [x, y], curve) in orbits {
        let name = method.name();
        record.series.push(Series::new(format!("portrait-{name}")).with("x", "m", x).with(
            "v_over_omega",
            "m",
            y,
        ));
        record.series.push(
            Series::new(format!("curve-{name}"))
                .with("x", "m", curve.iter().map(|s| s.q[0]).collect())
                .with("v_over_omega", "m", curve.iter().map(|s| s.v[0] / omega).collect()),
        );
    }
    Ok(())
}
