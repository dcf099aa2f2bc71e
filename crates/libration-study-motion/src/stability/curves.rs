//! The largest step against the horizon, and the crossovers of Verlet and RK4.

use libration::analysis::{LargestStep, Spectrum, UpdateMatrix};
use libration::simulation::{EnergyDrift, Sample, Simulator};
use libration::system::Oscillator;
use libration::{Method, Model, State, integrator};
use libration_report::Record;
use libration_report::notation::number;
use libration_report::record::{Finding, Series, Tolerance};
use libration_study::{Lab, StudyError};

use super::largest::{Case, Limit, limits, root, start};
use crate::rounding::rounding_of_run;
use crate::stability::StabilitySettings;

/// Horizons of the curves, in decades of steps.
const DECADES: std::ops::RangeInclusive<u32> = 1..=8;

/// The largest step of every method against the horizon, for every criterion.
pub(super) fn draw(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let config = lab.config;
    let omega = config.oscillator.omega();
    let steps: Vec<u64> = DECADES.map(|d| 10_u64.pow(d)).collect();
    let found = lab.sweep("largest steps against the horizon", &limits(config), |&limit| {
        let mut series = Series::new(format!("limit-{}", limit.tag())).with(
            "steps",
            "1",
            steps.iter().map(|&n| n as f64).collect(),
        );
        for &method in &config.integrators {
            let dt = |&steps: &u64| {
                root(config, &Case { method, limit, steps })
                    .map_or(f64::NAN, |z| z.to_f64() / omega)
            };
            series = series.with(method.name(), "s", steps.iter().map(dt).collect());
        }
        Ok(series)
    })?;
    record.series.extend(found);
    Ok(())
}

/// The number of steps over which Verlet and RK4 allow the same step, for each tolerance.
pub(super) fn crossovers(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let config = lab.config;
    let both = [Method::VelocityVerlet, Method::Rk4];
    if !both.iter().all(|m| config.integrators.contains(m)) {
        return Ok(());
    }
    let reach = lab.effort.choose(200_000, 5_000_000, 500_000_000_u64);
    let tolerances = &config.get::<StabilitySettings>().tolerances;
    let found = lab.sweep("where Verlet and RK4 tie", tolerances, |&tolerance| {
        let limit = Limit::Drift(tolerance);
        // Verlet’s step does not depend on the horizon.
        let case = Case { method: Method::VelocityVerlet, limit, steps: 1 };
        let Some(z) = root(config, &case).map(LargestStep::to_f64) else { return Ok(None) };
        let unit = Oscillator { omega2: 1.0 };
        let rk4 = UpdateMatrix::of_step(integrator::Rk4, unit, &start(config), z);
        let loss = Spectrum::new(&rk4).determinant_minus_one().to_f64().ln_1p();
        // Beyond 2√2 RK4 gains energy, and at a tolerance of one it can never lose it all.
        if !(loss < 0.0 && tolerance < 1.0) {
            return Ok(None);
        }
        let predicted = (-tolerance).ln_1p() / loss;
        let measured = match predicted < reach as f64 {
            true => Some(steps_until(lab, z, tolerance, 2 * reach)?),
            false => None,
        };
        // What rounding makes of the drift, at the pace at which RK4 loses energy.
        let rounding = rounding_of_run(Method::Rk4, 1.0, z, predicted as u64);
        let allowed = 1.0 + predicted * rounding / tolerance;
        Ok(Some((tolerance, predicted, measured.map(|steps| (steps, allowed)))))
    })?;
    let mut columns = [const { Vec::new() }; 2];
    for (tolerance, predicted, measured) in found.into_iter().flatten() {
        columns[0].push(tolerance);
        columns[1].push(predicted);
        let id = format!("stability.crossover.drift-{tolerance}");
        let text = format!(
            "Steps at which RK4 and Verlet allow the same Δt, for an energy drift of {}",
            number(tolerance, 3)
        );
        if let Some((measured, allowed)) = measured {
            record.find(Finding::predicted(
                id,
                format!("{text}: the step at which RK4 has lost as much, at Verlet’s largest Δt"),
                "steps",
                predicted,
                measured as f64,
                Tolerance::absolute(
                    allowed,
                    "a crossing falls on a whole step, and rounding moves it",
                ),
            ));
        }
    }
    let [tolerance, steps] = columns;
    record.series.push(
        Series::new("crossovers").with("tolerance", "1", tolerance).with("steps", "1", steps),
    );
    Ok(())
}

/// The first step at which RK4 has drifted by more than `tolerance` at `z = ωΔt`.
fn steps_until(lab: &Lab<'_>, z: f64, tolerance: f64, reach: u64) -> Result<u64, StudyError> {
    const STRETCH: u64 = 1 << 16;
    let system = Model::<1>::on::<f64>(&Oscillator { omega2: 1.0 });
    let start: State<f64, 1> = start(lab.config);
    let drift = EnergyDrift::new(system, &start);
    let mut simulator = Simulator::new(system, integrator::Rk4, start, z)?;
    let mut taken = 0;
    while taken < reach {
        lab.check()?;
        let mut crossed = None;
        let mut watch = |sample: &Sample<f64, 1>| {
            if drift.of(&sample.state).abs() > tolerance {
                crossed.get_or_insert(sample.step);
            }
        };
        simulator.run(STRETCH, &mut watch)?;
        if let Some(step) = crossed {
            return Ok(step);
        }
        taken += STRETCH;
    }
    Ok(reach)
}
