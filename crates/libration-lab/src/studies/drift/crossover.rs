//! The step at which RK4's steady loss overtakes the bounded oscillation of velocity Verlet.

use libration::analysis::{EnergyBand, Linearisation, Spectrum};
use libration::simulation::{EnergyDrift, Sample, Simulator};
use libration::{Method, Model, State, integrator, with_method};

use super::tag;
use crate::notation::{count, seconds};
use crate::record::{Finding, Series, Tolerance};
use crate::study::StudyError;
use crate::{Lab, Record};

/// Predicts the crossover at every time step, and measures it where the effort reaches it.
pub(super) fn measure(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let config = lab.config;
    let needed = [Method::VelocityVerlet, Method::Rk4];
    if !needed.iter().all(|m| config.integrators.contains(m)) {
        return Ok(());
    }
    let reach = lab.effort.choose(1_000_000, 50_000_000, 500_000_000_u64);
    let found = lab.sweep("the crossover of RK4 and Verlet", &config.drift.dt, |&dt| {
        let predicted = predicted(lab, dt)?;
        let measured = match predicted < reach as f64 {
            true => measured(lab, dt, reach)?,
            false => None,
        };
        Ok((dt, predicted, measured))
    })?;
    let omega = config.oscillator.omega();
    let mut table = [const { Vec::new() }; 3];
    for (dt, predicted, measured) in found {
        let z = omega * dt;
        let (leading, shown) = (18.0 / z.powi(4), seconds(dt, 3));
        table.iter_mut().zip([dt, predicted, leading]).for_each(|(c, x)| c.push(x));
        record.find(Finding::predicted(
            format!("drift.crossover.{}.leading-order", tag(dt)),
            format!(
                "Δt = {shown}: step at which RK4 has lost what Verlet's energy swings by, from the \
                 exact determinant, beside 18/z⁴"
            ),
            "steps",
            leading,
            predicted,
            // (z²/4 + z⁴/32 + …)/(z⁶/72 − z⁸/576 + …) = 18/z⁴·(1 + z²/4 + …)
            Tolerance::relative(z * z, "the next term of the expansion is z²/4 of the first"),
        ));
        if let Some(measured) = measured {
            record.find(Finding::predicted(
                format!("drift.crossover.{}.measured", tag(dt)),
                format!(
                    "Δt = {shown}: step at which RK4's drift overtakes Verlet's in simulation, \
                     within {} steps",
                    count(reach)
                ),
                "steps",
                predicted,
                measured as f64,
                Tolerance::absolute(
                    1.0 + predicted * super::rounding(dt, measured) / (z * z / 4.0),
                    "the crossing falls on a whole step, and rounding moves both drifts",
                ),
            ));
        }
    }
    let [dt, steps, leading] = table;
    record.series.push(
        Series::new("crossover").with("dt", "s", dt).with("steps", "1", steps).with(
            "leading_order",
            "1",
            leading,
        ),
    );
    Ok(())
}

/// `n` with `1 − det Mⁿ` of RK4 equal to the depth of Verlet's band.
fn predicted(lab: &Lab<'_>, dt: f64) -> Result<f64, StudyError> {
    let oscillator = lab.config.oscillator.system();
    let start = State { q: [lab.config.start.q], v: [lab.config.start.v] };
    let step = |m: Method| with_method!(m, |m| Linearisation::new(m, oscillator, &start, dt)).step;
    let loss = Spectrum::new(&step(Method::Rk4)).determinant_minus_one().to_f64().ln_1p();
    let band = EnergyBand::new(oscillator, &step(Method::VelocityVerlet))
        .map(|band| band.drift_after(&start, 0))
        .map_or(f64::INFINITY, |(low, high)| low.abs().max(high.abs()));
    Ok(if loss < 0.0 && band < 1.0 { (-band).ln_1p() / loss } else { f64::INFINITY })
}

/// The first step at which RK4's largest drift exceeds Verlet's over the same steps.
fn measured(lab: &Lab<'_>, dt: f64, reach: u64) -> Result<Option<u64>, StudyError> {
    const STRETCH: u64 = 1 << 20;
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
