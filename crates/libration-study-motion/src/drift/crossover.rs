//! The number of steps after which the energy loss of RK4 exceeds the oscillation of velocity Verlet.

use libration::analysis::{EnergyBand, Spectrum, UpdateMatrix, forecast_drift};
use libration::simulation::{EnergyDrift, Sample, Simulator};
use libration::{Float, Method, Model, State, integrator};
use libration_report::Record;
use libration_report::notation::{count, seconds};
use libration_report::record::{Finding, Series, Tolerance};
use libration_study::{Lab, StudyError};

use super::setting::Setting;
use super::tag;
use crate::drift::DriftSettings;

/// Steps of Verlet's orbit that are seen before RK4's begin.
const STRETCH: u64 = 1 << 20;

/// Predictions for one time step.
struct Prediction {
    /// Steps until RK4's loss equals the depth of Verlet's band.
    to_the_band: f64,
    /// The number of steps to leading order in z.
    leading_order: f64,
    /// Steps until it equals what Verlet's discrete orbit makes of the band within the simulation,
    /// which is less where the orbit closes, or nearly so, after a few points.
    to_the_orbit: f64,
    /// Largest drift of the discrete orbit of Verlet, and its bound.
    depth: f64,
    band: (f64, f64),
}

/// Predicts the crossover at every time step, and measures it where the effort reaches it.
pub(super) fn measure(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let config = lab.config;
    let needed = [Method::VelocityVerlet, Method::Rk4];
    if !needed.iter().all(|m| config.integrators.contains(m)) {
        return Ok(());
    }
    let reach = lab.effort.choose(1_000_000, 50_000_000, 500_000_000_u64);
    let found =
        lab.sweep("the crossover of RK4 and Verlet", &config.get::<DriftSettings>().dt, |&dt| {
            let Some(predicted) = predict(lab, dt, reach) else { return Ok(None) };
            let measured = match predicted.to_the_orbit < reach as f64 {
                true => simulate(lab, dt, reach)?,
                false => None,
            };
            Ok(Some((dt, predicted, measured)))
        })?;
    let mut table = [const { Vec::new() }; 3];
    for (dt, predicted, measured) in found.into_iter().flatten() {
        let (z, shown) = (config.oscillator.omega() * dt, seconds(dt, 3));
        let row = [dt, predicted.to_the_band, predicted.leading_order];
        table.iter_mut().zip(row).for_each(|(column, x)| column.push(x));
        // An expansion in z says nothing about large z.
        let expansion = (z < 0.5).then(|| Finding::predicted(
            format!("drift.crossover.{}.leading-order", tag(dt)),
            format!(
                "Δt = {shown}: steps until RK4 has lost what Verlet’s energy swings by. Theory beside \
                 theory, nothing is simulated: the exact determinant and band, beside the leading \
                 order of their expansion (18/z⁴ from rest)"
            ),
            "steps",
            predicted.leading_order,
            predicted.to_the_band,
            // (z²/4 + z⁴/32 + …)/(z⁶/72 − z⁸/576 + …) = 18/z⁴·(1 + z²/4 + …)
            Tolerance::relative(
                z * z + 16.0 * f64::UNIT_ROUNDOFF,
                "the next term of the expansion is z²/4 of the first; z⁴ and the quotient take 16 \
                 roundings",
            ),
        ));
        expansion.into_iter().for_each(|finding| record.find(finding));
        if let Some(measured) = measured {
            let at_crossing = |m| Setting { steps: measured, ..Setting::new(config, m, dt) };
            let Prediction { to_the_orbit, depth, band: (low, high), .. } = predicted;
            let moved = at_crossing(Method::Rk4).rounding()
                + at_crossing(Method::VelocityVerlet).uncertainty(depth, Some((low, high)));
            let id = format!("drift.crossover.{}.measured", tag(dt));
            let text = format!(
                "Δt = {shown}: step at which RK4’s drift overtakes Verlet’s in simulation, within {} \
                 steps",
                count(reach)
            );
            // RK4 loses depth/n a step, so a change of a drift moves the crossing by n/depth of it.
            let tolerance = 1.0 + to_the_orbit * moved / depth;
            record.find(if tolerance < 0.5 * to_the_orbit + 2.0 {
                let tolerance = Tolerance::absolute(
                    tolerance,
                    "the crossing falls on a whole step, and rounding moves both drifts",
                );
                Finding::predicted(id, text, "steps", to_the_orbit, measured as f64, tolerance)
            } else {
                Finding::measured(id, text, "steps", measured as f64)
            });
        }
    }
    let [dt, steps, leading] = table;
    if !dt.is_empty() {
        record.series.push(
            Series::new("crossover").with("dt", "s", dt).with("steps", "1", steps).with(
                "leading_order",
                "1",
                leading,
            ),
        );
    }
    Ok(())
}

/// The crossover at one time step; none where it does not exist, because a method is unstable.
fn predict(lab: &Lab<'_>, dt: f64, reach: u64) -> Option<Prediction> {
    let config = lab.config;
    let oscillator = config.oscillator.system();
    let start = State { q: [config.start.q], v: [config.start.v] };
    let step = |m: Method| UpdateMatrix::of_step(m, oscillator, &start, dt);
    let (rk4, verlet) = (step(Method::Rk4), step(Method::VelocityVerlet));
    // E_n = det Mⁿ·E₀ for RK4.
    let loss = Spectrum::new(&rk4).determinant_minus_one().to_f64().ln_1p();
    let steps = |depth: f64| (-depth).ln_1p() / loss;
    let (low, high) = EnergyBand::new(oscillator, &verlet)?.drift_after(&start, 0);
    let band = low.abs().max(high.abs());
    // The simulation sees Verlet's orbit to the end of the stretch in which RK4 overtakes it.
    let mut seen = STRETCH.min(reach);
    let mut orbit = forecast_drift(oscillator, &verlet, &start, seen)?.drift.to_f64();
    if steps(orbit) > seen as f64 {
        let stretches = (steps(orbit) / STRETCH as f64).ceil() as u64;
        seen = stretches.saturating_mul(STRETCH).min(reach);
        orbit = forecast_drift(oscillator, &verlet, &start, seen)?.drift.to_f64();
    }
    let z = config.oscillator.omega() * dt;
    // The band reaches down by the potential and up by the kinetic share of the energy.
    let potential = oscillator.omega2 * start.q[0] * start.q[0];
    let share = potential / (potential + start.v[0] * start.v[0]);
    (loss < 0.0 && band < 1.0).then(|| Prediction {
        to_the_band: steps(band),
        leading_order: 18.0 / z.powi(4) * share.max(1.0 - share),
        to_the_orbit: steps(orbit),
        depth: orbit,
        band: (low, high),
    })
}

/// The first step at which RK4's largest drift exceeds Verlet's.
fn simulate(lab: &Lab<'_>, dt: f64, reach: u64) -> Result<Option<u64>, StudyError> {
    let system = Model::<1>::on::<f64>(&lab.config.oscillator.system());
    let start = State { q: [lab.config.start.q], v: [lab.config.start.v] };
    let mut verlet = Simulator::new(system, integrator::VelocityVerlet, start, dt)?;
    let mut rk4 = Simulator::new(system, integrator::Rk4, start, dt)?;
    let drift = EnergyDrift::new(system, &start);
    let (mut band, mut loss) = (0.0_f64, 0.0_f64);
    let mut taken = 0;
    while taken < reach {
        lab.check()?;
        let steps = STRETCH.min(reach - taken);
        // Verlet's band is full after one turn, so its maximum may run ahead of RK4's by a stretch.
        let mut widen = |s: &Sample<f64, 1>| band = band.max(drift.of(&s.state).abs());
        verlet.run(steps, &mut widen)?;
        let mut crossing = None;
        let mut lose = |s: &Sample<f64, 1>| {
            loss = loss.max(drift.of(&s.state).abs());
            if loss > band {
                crossing.get_or_insert(s.step);
            }
        };
        rk4.run(steps, &mut lose)?;
        if crossing.is_some() {
            return Ok(crossing);
        }
        taken += steps;
    }
    Ok(None)
}
