//! A force with latency: the experiment of the source.

use libration::analysis::Plant;
use libration::control::clock::Fixed;
use libration::control::controller::Force;
use libration::control::{Feedback, Latency, Schedule};
use libration::ensemble::{All, Loops, Setup};
use libration::integrator::ExplicitEuler;
use libration::simulation::{Sample, Simulator};
use libration::system::{BaselineOnly, Oscillator};
use libration::{Float, Method, State};
use libration_report::Record;
use libration_report::notation::{count, plural, seconds};
use libration_report::record::{Finding, Series, Table, Tolerance};
use libration_study::source_report::{DT, STEPS};
use libration_study::{Lab, StudyError, log_spaced_steps};

use super::loop_simulation::{ORIGIN, SPRING, area, logarithm};

/// Latencies of the force, in steps.
const LATE: [u32; 5] = [0, 1, 2, 5, 10];

/// The spring without its force.
const FREE: Oscillator<f64> = Oscillator { omega2: 0.0 };

/// Initial state of the source.
pub(super) const START: State<f64, 1> = State { q: [1.0], v: [0.0] };

/// The end of a short horizon, in steps.
pub(super) const SHORT: u64 = 1000;

/// From here on the amplitude is compared: eigenvalues other than the largest two have died out.
const SETTLED: u64 = 100;

/// An orbit whose force is `late` steps late.
struct Orbit {
    late: u32,
    /// `ln ρ`, by theory.
    rate: f64,
    steps: Vec<u64>,
    amplitude: Vec<f64>,
}

/// Orbits of the source's oscillator with late forces, and explicit Euler, which is one of them.
pub(super) fn measure(lab: &Lab<'_>, record: &mut Record) -> Result<(), StudyError> {
    let orbits = lab.sweep("forces that are late", &LATE, |&late| orbit(lab, late))?;
    let columns = [
        "force late by (steps)",
        "growth a step, predicted",
        "after 1000 steps",
        "after 10⁶ steps",
    ];
    let mut table = Table::new("late forces", &columns);
    for orbit in &orbits {
        findings(orbit, record);
        let at = |n| orbit.at(n);
        table.push([
            u64::from(orbit.late).into(),
            orbit.rate.into(),
            at(SHORT).into(),
            at(STEPS).into(),
        ]);
        let forecast = orbit.steps.iter().map(|&n| orbit.forecast(n)).collect();
        record.series.push(
            Series::new(format!("force-{}", orbit.late))
                .with("step", "1", orbit.steps.iter().map(|&n| n as f64).collect())
                .with("amplitude", "m", orbit.amplitude.clone())
                .with("predicted", "m", forecast),
        );
    }
    record.tables.push(table);
    record.find(explicit_euler(lab)?);
    Ok(())
}

fn orbit(lab: &Lab<'_>, late: u32) -> Result<Orbit, StudyError> {
    let Some(latency) = Latency::of_steps(late.into()) else {
        return Ok(Orbit { late, rate: f64::NAN, steps: Vec::new(), amplitude: Vec::new() });
    };
    let plant = Plant::new(Method::SymplecticEuler, FREE, ORIGIN, DT);
    let gains = Feedback { position: SPRING.omega2, velocity: 0.0 };
    let rate = logarithm(plant.spectral_radius(gains, latency));
    let mut all = late_force(lab, latency)?;
    // Of the orbit whose force is in time: v₁ = −ω²Δt, q₁ = 1 − z².
    let own = -SPRING.omega2 * DT;
    let mut steps = log_spaced_steps(STEPS, lab.effort.choose(6.0, 12.0, 24.0));
    steps.extend([SETTLED, SHORT]);
    steps.sort_unstable();
    steps.dedup();
    let mut at = |step: u64| -> Result<State<f64, 1>, StudyError> {
        all.advance(step - all.step())?;
        Ok(all.state(0).unwrap_or(ORIGIN))
    };
    let mut amplitude = Vec::with_capacity(steps.len());
    for &step in &steps {
        let (first, second) = (at(step)?, at(step + 1)?);
        amplitude.push((area(&first, &second) / own).sqrt());
    }
    Ok(Orbit { late, rate, steps, amplitude })
}

impl Orbit {
    /// The amplitude after `step` steps, as measured.
    fn at(&self, step: u64) -> f64 {
        let place = self.steps.binary_search(&step);
        place.map_or(f64::NAN, |i| self.amplitude[i])
    }

    /// Returns the predicted amplitude after the transient.
    fn forecast(&self, step: u64) -> f64 {
        let since = step as f64 - SETTLED as f64;
        if since < 0.0 { f64::NAN } else { self.at(SETTLED) * (self.rate * since).exp() }
    }
}

fn findings(orbit: &Orbit, record: &mut Record) {
    let late = orbit.late;
    let z = SPRING.omega2.sqrt() * DT;
    let title = match late {
        0 => "force in time".to_owned(),
        n => format!("force {} late", plural(n as usize, "step")),
    };
    for (name, end) in [("short", SHORT), ("long", STEPS)] {
        let n = (end - SETTLED) as f64;
        // The areas between neighbours are z of a square, and are rounded as the square is.
        let rounding = 8.0 * f64::UNIT_ROUNDOFF * (n + 1.0 / z);
        record.find(Finding::predicted(
            format!("latency.force-{late}.{name}"),
            format!(
                "Symplectic Euler, Δt = {}, {title}: factor of the amplitude from step {SETTLED} to step {}",
                seconds(DT, 3),
                count(end)
            ),
            "1",
            (orbit.rate * n).exp(),
            orbit.at(end) / orbit.at(SETTLED),
            Tolerance::relative(rounding, "8 roundings a step, all to one side, and those of the comparison"),
        ));
    }
    if late > 0 {
        let angle = z * f64::from(late + 1);
        let measured = (orbit.at(STEPS) / orbit.at(SETTLED)).ln() / (STEPS - SETTLED) as f64;
        record.find(Finding::predicted(
            format!("latency.force-{late}.law"),
            format!("{title}: growth of the amplitude a step beside the law ½z²d"),
            "1",
            z * z * f64::from(late) / 2.0,
            measured,
            Tolerance::relative(
                2.0 * angle * angle,
                "the law is the first term of a series; of relative size (ωτ)² is the next",
            ),
        ));
    }
}

/// A spring whose force is a command.
type Late = Loops<
    f64,
    BaselineOnly<Oscillator<f64>>,
    All<BaselineOnly<Oscillator<f64>>>,
    Method,
    Force<Oscillator<f64>>,
    Fixed,
    Schedule,
    1,
>;

/// Symplectic Euler without a force of its own, under one that is late.
fn late_force(lab: &Lab<'_>, latency: Latency) -> Result<Late, StudyError> {
    let setup = Setup::new(All(BaselineOnly(FREE)), Method::SymplecticEuler)
        .controller(Force(SPRING))
        .delay(Schedule::late(latency));
    Ok(Loops::new(setup, DT, 0, [0.0], &[START], lab.alone()?)?)
}

/// In how many steps explicit Euler differs from symplectic Euler with a force one step late.
fn explicit_euler(lab: &Lab<'_>) -> Result<Finding, StudyError> {
    let steps = lab.effort.choose(10_000, 100_000, 1_000_000);
    let mut differ = u64::MAX;
    if let Some(one) = Latency::of_steps(1.0) {
        let mut late = late_force(lab, one)?;
        differ = 0;
        let mut outcome = Ok(());
        let mut before = START.v;
        let mut watch = |sample: &Sample<f64, 1>| {
            if sample.step > 0 && outcome.is_ok() {
                outcome = late.advance(1);
            }
            // Of the late one the velocity is that of the step before.
            let same = late.state(0).is_some_and(|y| y.q == sample.state.q && y.v == before);
            differ += u64::from(!same);
            before = sample.state.v;
        };
        Simulator::new(SPRING, ExplicitEuler, START, DT)?.run(steps, &mut watch)?;
        outcome?;
    }
    Ok(Finding::predicted(
        "latency.force-1.explicit-euler",
        format!(
            "of {} steps, those in which a bit of the position or of the velocity one step before tells \
             symplectic Euler with a force one step late from explicit Euler",
            count(steps)
        ),
        "1",
        0.0,
        differ as f64,
        Tolerance::exact("the same operations on the same numbers"),
    ))
}
